"""The stage: which run is shown, and playback commands."""

import asyncio
import json
from typing import Any

import pytest

from app.runs.lane import LaneConfig
from app.runs.race_config import RaceConfig
from app.stage.stage import REPLAY_AFTER_S
from app.storage.errors import NotFound
from app.storage.run import Page
from tests.stage.stage_parts import GAIT, StageParts


def test_idle_stage_shows_the_three_agents_of_the_paper(parts: StageParts) -> None:
    frame = parts.next_frame()

    assert [lane_spec.name for lane_spec in frame.spec.lane_specs] == [
        "Q-learning",
        "Greedy",
        "Two-step",
    ]
    assert [lane_spec.color for lane_spec in frame.spec.lane_specs] == [
        "#E69F00",
        "#56B4E9",
        "#009E73",
    ]
    assert (frame.phase, frame.run_id) == ("start-line", None)
    assert all(lane.qpos[1] == 0 and lane.qpos[2] > 0.05 for lane in frame.lanes)


def test_offered_run_takes_an_idle_stage(parts: StageParts) -> None:
    run, _ = parts.running_race()

    assert parts.stage.offer(run.id)
    assert parts.stage.state()["run_id"] == run.id
    assert parts.stage.state()["live"]


def test_offer_is_rejected_only_while_a_live_run_is_on_stage(parts: StageParts) -> None:
    first, _ = parts.running_race()
    parts.stage.offer(first.id)
    second, _ = parts.running_race()

    assert not parts.stage.offer(second.id)
    assert parts.stage.state()["run_id"] == first.id

    parts.set_state(first, "finished")
    assert parts.stage.offer(second.id)
    assert parts.stage.state()["run_id"] == second.id


def test_set_replaces_a_live_run(parts: StageParts) -> None:
    first, _ = parts.running_race()
    parts.stage.offer(first.id)
    second = parts.finished_race()

    parts.stage.set(run_id=second.id)

    assert parts.next_frame().run_id == second.id


def test_race_is_shown_after_its_own_training(parts: StageParts) -> None:
    training, advance = parts.running_training(60)
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=lanes, steps=5)
    race = parts.create(config, waiting_for=(training.id,))

    assert parts.stage.offer(race.id)
    assert parts.next_frame().spec.kind == "training"
    assert parts.stage.state()["next_run_id"] == race.id
    assert parts.stage.offer(race.id), "it is on the bill already"
    while advance():
        pass
    assert parts.watch(0.5)[-1].spec.kind == "training"

    parts.set_state(training, "finished")
    frames = parts.watch(12.0)

    assert frames[-1].run_id == race.id
    assert max(frame.time_s for frame in frames if frame.run_id == training.id) > 18


def test_newest_finished_race_is_replayed_after_twenty_idle_seconds(
    parts: StageParts,
) -> None:
    parts.finished_race()
    newest = parts.finished_race()
    parts.stage.set(run_id=parts.finished_training(5).id)
    frames = parts.watch_to_end()

    assert not any(frame.replay for frame in frames)
    assert parts.watch(REPLAY_AFTER_S - 1)[-1].spec.kind == "training"
    frame = parts.watch(2.0)[-1]
    assert (frame.run_id, frame.replay) == (newest.id, True)

    started, _ = parts.running_race()
    assert parts.stage.offer(started.id), "a replay gives way"
    assert not parts.next_frame().replay


def test_race_that_is_deleted_as_its_replay_begins_gives_way_to_another(
    parts: StageParts, monkeypatch: pytest.MonkeyPatch
) -> None:
    other, newest = parts.finished_race(), parts.finished_race()
    list_runs = parts.store.list

    def list_then_delete(*args: Any, **kwargs: Any) -> Page:
        page = list_runs(*args, **kwargs)
        if newest.id in [run.id for run in page.runs]:
            parts.store.delete(newest.id)
        return page

    monkeypatch.setattr(parts.store, "list", list_then_delete)
    assert parts.watch(REPLAY_AFTER_S + 1)[-1].run_id == other.id


def test_idle_stage_without_a_finished_race_does_not_change(parts: StageParts) -> None:
    assert parts.watch(REPLAY_AFTER_S + 5)[-1].phase == "start-line"


def test_deleted_run_is_removed_from_the_stage(parts: StageParts) -> None:
    run = parts.finished_race()
    parts.stage.set(run_id=run.id)
    parts.next_frame()
    parts.delete(run)

    frame = parts.next_frame()

    assert (frame.run_id, frame.phase) == (None, "start-line")


def test_playback_can_be_paused_and_continued(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id)
    parts.watch(1.0)
    parts.stage.set(playing=False)
    frames = parts.watch(1.0)

    assert frames[0].time_s == frames[-1].time_s
    assert not frames[-1].playing

    parts.stage.set(playing=True)
    assert parts.watch(1.0)[-1].time_s > frames[-1].time_s


def test_play_after_the_end_restarts_the_show(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id)
    parts.watch_to_end()

    parts.stage.set(playing=True)

    assert parts.next_frame().time_s < 1


def test_stall_of_the_process_skips_no_motion(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id)
    parts.next_frame()
    parts.now += 60

    assert parts.next_frame().time_s < 2


def test_unknown_run_is_refused_and_changes_nothing(parts: StageParts) -> None:
    parts.stage.set(run_id=parts.finished_race().id)
    before = parts.stage.state()

    with pytest.raises(NotFound):
        parts.stage.set(run_id="nobody", playing=False)

    assert parts.stage.state() == before


def test_changes_are_published_on_the_bus(parts: StageParts) -> None:
    run = parts.finished_race()

    async def next_stage_event() -> dict[str, object]:
        events = parts.bus.subscribe()
        parts.stage.set(run_id=run.id)
        async for event in events:
            if event.event == "stage":
                state: dict[str, object] = json.loads(event.data)
                return state
        raise AssertionError("nothing was told")

    assert asyncio.run(next_stage_event()) == parts.stage.state()


def test_scene_is_plain_json(parts: StageParts) -> None:
    for run in (parts.finished_race(("q-learning", "greedy")), parts.finished_training(30)):
        parts.stage.set(run_id=run.id)
        parts.watch(1.0)
        scene = json.loads(json.dumps(parts.stage.scene(), allow_nan=False))

        assert scene["run_id"] == run.id
        assert scene["lanes"][0]["color"] == "#E69F00"
        view = scene["action_values"]
        assert len(view["values_m"]) == len(view["pairs"]) == 3
        for pair, current in enumerate(view["current"]):
            assert view["values_m"][pair][current] is None
        assert view["cell_names"][0] == "home"
        assert view["next"]["cell"] != view["current"][view["next"]["pair"]]
