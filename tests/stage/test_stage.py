"""Who has the stage, and what may be commanded."""

import asyncio
import json

import pytest

from app.domain.errors import InvalidInput
from app.runs.config import LaneConfig, RaceConfig
from app.stage.stage import REPLAY_AFTER_S
from app.storage.errors import NotFound
from tests.stage.stage_parts import GAIT, Theatre


@pytest.fixture
def theatre() -> Theatre:
    return Theatre()


def test_at_first_the_papers_three_stand_on_the_start_line(theatre: Theatre) -> None:
    frame = theatre.look()

    assert [role.name for role in frame.cast.roles] == ["Q-learning", "Greedy", "Two-step"]
    assert [role.color for role in frame.cast.roles] == ["#E69F00", "#56B4E9", "#009E73"]
    assert (frame.phase, frame.run_id) == ("start-line", None)
    assert all(lane.qpos[1] == 0 and lane.qpos[2] > 0.05 for lane in frame.lanes)


def test_a_started_run_gets_the_idle_stage(theatre: Theatre) -> None:
    run, _ = theatre.racing()

    assert theatre.stage.offer(run.id)
    assert theatre.stage.state()["run_id"] == run.id
    assert theatre.stage.state()["live"]


def test_a_live_run_keeps_the_stage_and_a_finished_one_does_not(theatre: Theatre) -> None:
    first, _ = theatre.racing()
    theatre.stage.offer(first.id)
    second, _ = theatre.racing()

    assert not theatre.stage.offer(second.id)
    assert theatre.stage.state()["run_id"] == first.id

    theatre.set_state(first, "finished")
    assert theatre.stage.offer(second.id)
    assert theatre.stage.state()["run_id"] == second.id


def test_whoever_asks_for_it_takes_the_stage_from_a_live_run(theatre: Theatre) -> None:
    first, _ = theatre.racing()
    theatre.stage.offer(first.id)
    second = theatre.race()

    theatre.stage.set(run_id=second.id)

    assert theatre.look().run_id == second.id


def test_a_race_is_shown_after_its_own_training(theatre: Theatre) -> None:
    training, practise = theatre.practising(60)
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    config = RaceConfig(gait=GAIT, simulator="kinematic", lanes=lanes, steps=5)
    race = theatre.create(config, waiting_for=(training.id,))

    assert theatre.stage.offer(race.id)
    assert theatre.look().cast.kind == "training"
    assert theatre.stage.state()["next_run_id"] == race.id
    assert theatre.stage.offer(race.id), "it is on the bill already"
    while practise():
        pass
    assert theatre.watch(0.5)[-1].cast.kind == "training"

    theatre.set_state(training, "finished")
    frames = theatre.watch(12.0)

    assert frames[-1].run_id == race.id
    assert max(frame.time_s for frame in frames if frame.run_id == training.id) > 18


def test_after_twenty_seconds_of_nothing_the_newest_finished_race_is_replayed(
    theatre: Theatre,
) -> None:
    theatre.race()
    newest = theatre.race()
    theatre.stage.show(theatre.training(5).id)
    shown = theatre.watch_to_end()

    assert not any(frame.replay for frame in shown)
    assert theatre.watch(REPLAY_AFTER_S - 1)[-1].cast.kind == "training"
    frame = theatre.watch(2.0)[-1]
    assert (frame.run_id, frame.replay) == (newest.id, True)

    started, _ = theatre.racing()
    assert theatre.stage.offer(started.id), "a replay gives way"
    assert not theatre.look().replay


def test_an_idle_stage_without_a_finished_race_stays_as_it_is(theatre: Theatre) -> None:
    assert theatre.watch(REPLAY_AFTER_S + 5)[-1].phase == "start-line"


def test_a_run_that_is_deleted_leaves_the_stage(theatre: Theatre) -> None:
    run = theatre.race()
    theatre.stage.show(run.id)
    theatre.look()
    theatre.store.delete(run.id)
    theatre.recordings.discard(run.id)

    frame = theatre.look()

    assert (frame.run_id, frame.phase) == (None, "start-line")


def test_it_can_be_paused_and_played_again(theatre: Theatre) -> None:
    theatre.stage.show(theatre.race().id)
    theatre.watch(1.0)
    theatre.stage.set(playing=False)
    frames = theatre.watch(1.0)

    assert frames[0].time_s == frames[-1].time_s
    assert not frames[-1].playing

    theatre.stage.set(playing=True)
    assert theatre.watch(1.0)[-1].time_s > frames[-1].time_s


def test_to_play_what_has_ended_begins_again(theatre: Theatre) -> None:
    theatre.stage.show(theatre.race().id)
    theatre.watch_to_end()

    theatre.stage.set(playing=True)

    assert theatre.look().time_s < 1


def test_a_stall_of_the_process_skips_nothing(theatre: Theatre) -> None:
    theatre.stage.show(theatre.race().id)
    theatre.look()
    theatre.now += 60

    assert theatre.look().time_s < 2


@pytest.mark.parametrize("speed", [0, 0.2, 65, -1, float("nan"), "fast", True])
def test_a_speed_that_is_none_is_refused(theatre: Theatre, speed: float | str) -> None:
    with pytest.raises(InvalidInput, match=r"0\.25 to 64, or time-lapse"):
        theatre.stage.set(speed=speed)


def test_other_bad_commands_are_refused_and_change_nothing(theatre: Theatre) -> None:
    run = theatre.race()
    theatre.stage.show(run.id)
    before = theatre.stage.state()

    with pytest.raises(InvalidInput, match="paper, wall, free"):
        theatre.stage.set(clock="sun", playing=False)
    with pytest.raises(InvalidInput, match="time_s"):
        theatre.stage.set(time_s=float("inf"), playing=False)
    with pytest.raises(NotFound):
        theatre.stage.set(run_id="nobody", playing=False)

    assert theatre.stage.state() == before


def test_changes_are_told_to_everyone(theatre: Theatre) -> None:
    run = theatre.race()

    async def hear() -> dict[str, object]:
        heard = theatre.bus.subscribe()
        theatre.stage.show(run.id)
        async for event in heard:
            if event.event == "stage":
                told: dict[str, object] = json.loads(event.data)
                return told
        raise AssertionError("nothing was told")

    assert asyncio.run(hear()) == theatre.stage.state()


def test_a_scene_is_plain_json(theatre: Theatre) -> None:
    for run in (theatre.race(("q-learning", "greedy")), theatre.training(30)):
        theatre.stage.show(run.id)
        theatre.watch(1.0)
        scene = json.loads(json.dumps(theatre.stage.scene(), allow_nan=False))

        assert scene["run_id"] == run.id
        assert scene["lanes"][0]["color"] == "#E69F00"
        known = scene["knowledge"]
        assert len(known["values_m"]) == len(known["pairs"]) == 3
        for pair, current in enumerate(known["current"]):
            assert known["values_m"][pair][current] is None
        assert known["cell_names"][0] == "home"
        assert known["next"]["cell"] != known["current"][known["next"]["pair"]]
