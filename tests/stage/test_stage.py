"""Who has the stage, and what may be commanded."""

import asyncio
import json

import pytest

from app.domain.errors import InvalidInput
from app.runs.config import LaneConfig, RaceConfig
from app.stage.stage import REPLAY_AFTER_S
from app.storage.errors import NotFound
from tests.stage.stage_parts import GAIT, StageParts


@pytest.fixture
def parts() -> StageParts:
    return StageParts()


def test_at_first_the_papers_three_stand_on_the_start_line(parts: StageParts) -> None:
    frame = parts.look()

    assert [role.name for role in frame.cast.roles] == ["Q-learning", "Greedy", "Two-step"]
    assert [role.color for role in frame.cast.roles] == ["#E69F00", "#56B4E9", "#009E73"]
    assert (frame.phase, frame.run_id) == ("start-line", None)
    assert all(lane.qpos[1] == 0 and lane.qpos[2] > 0.05 for lane in frame.lanes)


def test_a_started_run_gets_the_idle_stage(parts: StageParts) -> None:
    run, _ = parts.racing()

    assert parts.stage.offer(run.id)
    assert parts.stage.state()["run_id"] == run.id
    assert parts.stage.state()["live"]


def test_a_live_run_keeps_the_stage_and_a_finished_one_does_not(parts: StageParts) -> None:
    first, _ = parts.racing()
    parts.stage.offer(first.id)
    second, _ = parts.racing()

    assert not parts.stage.offer(second.id)
    assert parts.stage.state()["run_id"] == first.id

    parts.set_state(first, "finished")
    assert parts.stage.offer(second.id)
    assert parts.stage.state()["run_id"] == second.id


def test_whoever_asks_for_it_takes_the_stage_from_a_live_run(parts: StageParts) -> None:
    first, _ = parts.racing()
    parts.stage.offer(first.id)
    second = parts.race()

    parts.stage.set(run_id=second.id)

    assert parts.look().run_id == second.id


def test_a_race_is_shown_after_its_own_training(parts: StageParts) -> None:
    training, practise = parts.practising(60)
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=lanes, steps=5)
    race = parts.create(config, waiting_for=(training.id,))

    assert parts.stage.offer(race.id)
    assert parts.look().cast.kind == "training"
    assert parts.stage.state()["next_run_id"] == race.id
    assert parts.stage.offer(race.id), "it is on the bill already"
    while practise():
        pass
    assert parts.watch(0.5)[-1].cast.kind == "training"

    parts.set_state(training, "finished")
    frames = parts.watch(12.0)

    assert frames[-1].run_id == race.id
    assert max(frame.time_s for frame in frames if frame.run_id == training.id) > 18


def test_after_twenty_seconds_of_nothing_the_newest_finished_race_is_replayed(
    parts: StageParts,
) -> None:
    parts.race()
    newest = parts.race()
    parts.stage.show(parts.training(5).id)
    shown = parts.watch_to_end()

    assert not any(frame.replay for frame in shown)
    assert parts.watch(REPLAY_AFTER_S - 1)[-1].cast.kind == "training"
    frame = parts.watch(2.0)[-1]
    assert (frame.run_id, frame.replay) == (newest.id, True)

    started, _ = parts.racing()
    assert parts.stage.offer(started.id), "a replay gives way"
    assert not parts.look().replay


def test_an_idle_stage_without_a_finished_race_stays_as_it_is(parts: StageParts) -> None:
    assert parts.watch(REPLAY_AFTER_S + 5)[-1].phase == "start-line"


def test_a_run_that_is_deleted_leaves_the_stage(parts: StageParts) -> None:
    run = parts.race()
    parts.stage.show(run.id)
    parts.look()
    parts.store.delete(run.id)
    parts.recordings.discard(run.id)

    frame = parts.look()

    assert (frame.run_id, frame.phase) == (None, "start-line")


def test_it_can_be_paused_and_played_again(parts: StageParts) -> None:
    parts.stage.show(parts.race().id)
    parts.watch(1.0)
    parts.stage.set(playing=False)
    frames = parts.watch(1.0)

    assert frames[0].time_s == frames[-1].time_s
    assert not frames[-1].playing

    parts.stage.set(playing=True)
    assert parts.watch(1.0)[-1].time_s > frames[-1].time_s


def test_to_play_what_has_ended_begins_again(parts: StageParts) -> None:
    parts.stage.show(parts.race().id)
    parts.watch_to_end()

    parts.stage.set(playing=True)

    assert parts.look().time_s < 1


def test_a_stall_of_the_process_skips_nothing(parts: StageParts) -> None:
    parts.stage.show(parts.race().id)
    parts.look()
    parts.now += 60

    assert parts.look().time_s < 2


@pytest.mark.parametrize("speed", [0, 0.2, 65, -1, float("nan"), "fast", True])
def test_a_speed_that_is_none_is_refused(parts: StageParts, speed: float | str) -> None:
    with pytest.raises(InvalidInput, match=r"0\.25 to 64, or time-lapse"):
        parts.stage.set(speed=speed)


def test_other_bad_commands_are_refused_and_change_nothing(parts: StageParts) -> None:
    run = parts.race()
    parts.stage.show(run.id)
    before = parts.stage.state()

    with pytest.raises(InvalidInput, match="paper, wall, free"):
        parts.stage.set(clock="sun", playing=False)
    with pytest.raises(InvalidInput, match="time_s"):
        parts.stage.set(time_s=float("inf"), playing=False)
    with pytest.raises(NotFound):
        parts.stage.set(run_id="nobody", playing=False)

    assert parts.stage.state() == before


def test_changes_are_told_to_everyone(parts: StageParts) -> None:
    run = parts.race()

    async def hear() -> dict[str, object]:
        heard = parts.bus.subscribe()
        parts.stage.show(run.id)
        async for event in heard:
            if event.event == "stage":
                told: dict[str, object] = json.loads(event.data)
                return told
        raise AssertionError("nothing was told")

    assert asyncio.run(hear()) == parts.stage.state()


def test_a_scene_is_plain_json(parts: StageParts) -> None:
    for run in (parts.race(("q-learning", "greedy")), parts.training(30)):
        parts.stage.show(run.id)
        parts.watch(1.0)
        scene = json.loads(json.dumps(parts.stage.scene(), allow_nan=False))

        assert scene["run_id"] == run.id
        assert scene["lanes"][0]["color"] == "#E69F00"
        known = scene["knowledge"]
        assert len(known["values_m"]) == len(known["pairs"]) == 3
        for pair, current in enumerate(known["current"]):
            assert known["values_m"][pair][current] is None
        assert known["cell_names"][0] == "home"
        assert known["next"]["cell"] != known["current"][known["next"]["pair"]]
