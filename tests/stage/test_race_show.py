"""A race as it is shown."""

from itertools import pairwise

import numpy as np
import pytest

from app.domain.robot import Robot
from app.runs.config import LaneConfig, RaceConfig
from app.runs.results import finish_s, race_result
from app.stage.race_show import LAST_LANE_SPEED, PHOTO_FINISH_S, SPEED
from app.stage.stage_frame import StageFrame
from tests.stage.stage_parts import FRAME_S, Theatre

LANES = ("q-learning", "greedy", "two-step")


@pytest.fixture
def theatre() -> Theatre:
    return Theatre()


def shown(theatre: Theatre) -> list[StageFrame]:
    theatre.stage.show(theatre.race(LANES).id)
    return theatre.watch_to_end()


def test_it_is_shown_at_twice_its_speed_and_the_last_lane_at_eight(theatre: Theatre) -> None:
    frames = shown(theatre)
    speeds = [b.time_s - a.time_s for a, b in pairwise(frames)]

    assert frames[5].shown_speed == SPEED
    assert speeds[5] == pytest.approx(SPEED * FRAME_S)
    assert frames[-10].shown_speed == LAST_LANE_SPEED
    assert speeds[-10] == pytest.approx(LAST_LANE_SPEED * FRAME_S)


def test_the_first_finish_is_frozen_for_three_seconds(theatre: Theatre) -> None:
    frames = shown(theatre)
    frozen = [frame for frame in frames if frame.phase == "photo-finish"]
    lanes = theatre.recordings.race(frozen[0].run_id or "") or []
    result = race_result(lanes, 12)["lanes"]

    assert len(frozen) * FRAME_S == pytest.approx(PHOTO_FINISH_S, abs=2 * FRAME_S)
    assert {frame.time_s for frame in frozen} == {finish_s(lanes, 12, "paper")}
    under = [lane["clocks"]["paper"] for lane in result]
    assert [lane.distance_m for lane in frozen[0].lanes] == pytest.approx(
        [lane["finished_distance_m"] for lane in under]
    )
    assert [lane.rank for lane in frames[-1].lanes] == [lane["rank"] for lane in under]


def test_poses_go_from_rest_to_the_recordings_end_without_a_jump(theatre: Theatre) -> None:
    frames = shown(theatre)
    lanes = theatre.recordings.race(frames[0].run_id or "") or []

    for number, lane in enumerate(lanes):
        places = np.array([frame.lanes[number].qpos[:3] for frame in frames])
        assert np.abs(places[0] - lane.rest_qpos[:3]).max() < 0.005
        assert places[-1] == pytest.approx(lane.steps[-1].motion.qpos[-1, :3], abs=1e-6)
        assert np.abs(np.diff(places, axis=0)).max() < 0.05
    assert [lane.done for lane in frames[-1].lanes] == [True, True, True]
    assert frames[-1].phase == "finished"


def test_a_lane_that_thinks_counts_its_futures(theatre: Theatre) -> None:
    frames = shown(theatre)
    thinking = [frame.lanes[2] for frame in frames if frame.lanes[2].thinking]

    assert {lane.futures_total for lane in thinking} == {156}
    first = [lane.futures for lane in thinking if lane.step == 1]
    assert first == sorted(first)
    assert first[0] < 20
    assert first[-1] > 140
    assert not any(frame.lanes[0].thinking for frame in frames), "a table needs no thought"


def test_another_clock_retimes_the_same_race_at_the_same_place(theatre: Theatre) -> None:
    theatre.stage.show(theatre.race(LANES).id)
    before = theatre.watch(1.5)[-1]
    theatre.stage.set(playing=False, clock="free")
    after = theatre.look()

    assert after.clock == "free"
    assert after.time_s == before.time_s, "the leader does not think"
    assert after.lanes[2].step == after.lanes[0].step > before.lanes[2].step
    assert not any(lane.thinking for lane in after.lanes)

    theatre.stage.set(clock="paper")
    assert theatre.look().time_s == pytest.approx(before.time_s)


def test_the_clock_at_the_end_and_at_the_photo_finish(theatre: Theatre) -> None:
    run = theatre.race(LANES)
    lanes = theatre.recordings.race(run.id) or []
    theatre.stage.show(run.id)
    while theatre.look().phase != "photo-finish":
        pass
    theatre.stage.set(clock="free")
    assert theatre.look().phase == "photo-finish"
    assert theatre.look().time_s == finish_s(lanes, 12, "free")

    theatre.watch_to_end()
    theatre.stage.set(clock="wall")
    assert theatre.stage.state()["ended"]


def test_skip_goes_to_the_end(theatre: Theatre) -> None:
    theatre.stage.show(theatre.race(LANES).id)
    duration = theatre.look().duration_s
    assert duration is not None
    theatre.stage.set(time_s=duration)

    assert theatre.look().phase == "finished"


def test_a_chosen_speed_holds_throughout(theatre: Theatre) -> None:
    theatre.stage.show(theatre.race(LANES).id)
    theatre.stage.set(speed=16)
    frames = theatre.watch_to_end()

    assert {frame.shown_speed for frame in frames} == {16.0, 0.0}

    theatre.stage.set(time_s=0, speed="time-lapse")
    assert theatre.look().shown_speed == SPEED


def test_it_waits_for_a_lane_that_still_computes(theatre: Theatre) -> None:
    run, walk = theatre.racing(("greedy", "two-step"))
    theatre.stage.show(run.id)
    assert theatre.look().phase == "waiting"
    for _ in range(3):  # greedy has two steps, two-step one
        walk()
    frame = theatre.watch(10.0)[-1]
    lanes = theatre.recordings.race(run.id) or []

    assert frame.phase == "waiting"
    assert frame.duration_s is None
    assert frame.lanes[0].qpos == pytest.approx(lanes[0].steps[-1].motion.qpos[-1])
    assert frame.lanes[0].thinking
    assert not theatre.stage.state()["ended"]

    while walk():
        pass
    theatre.set_state(run, "finished")
    assert theatre.watch_to_end()[-1].lanes[1].step == 12


def test_before_anything_is_recorded_they_stand_on_the_start_line(theatre: Theatre) -> None:
    config = theatre.race().config
    assert isinstance(config, RaceConfig)
    theatre.stage.show(theatre.create(config).id)

    frame = theatre.look()

    assert frame.phase == "start-line"
    assert [lane.step for lane in frame.lanes] == [0, 0]
    assert not theatre.stage.state()["ended"]


def test_a_race_that_failed_shows_what_it_has_and_ends(theatre: Theatre) -> None:
    run, walk = theatre.racing()
    theatre.stage.show(run.id)
    for _ in range(4):
        walk()
    theatre.set_state(run, "failed")

    frame = theatre.watch_to_end()[-1]

    assert [lane.step for lane in frame.lanes] == [2, 2]
    assert [lane.done for lane in frame.lanes] == [True, True]


def test_who_gains_nothing_marches_on_the_spot(theatre: Theatre) -> None:
    """An untrained table with every value equal wanders without getting anywhere fast."""
    theatre.stage.show(theatre.race(LANES, steps=40).id)
    frames = theatre.watch_to_end(400)
    greedy = [frame.lanes[1] for frame in frames]
    idle = [frame.lanes[0] for frame in frames]

    assert not any(lane.marching for lane in greedy)
    assert any(lane.marching for lane in idle)
    assert not any(lane.marching for lane in idle if lane.step <= 10)


def test_a_race_that_computes_slowly_is_shown_without_stopping_at_each_step(
    theatre: Theatre,
) -> None:
    run, walk = theatre.racing(("greedy",), steps=40)
    theatre.stage.show(run.id)
    frames = []
    for _ in range(30):
        walk()
        frames += theatre.watch(0.4)
    gone = np.diff([frame.time_s for frame in frames])[100:]

    assert gone.min() > 0
    assert gone.max() < 4 * gone.mean()


def test_a_robot_that_cannot_stand_is_shown_all_the_same(theatre: Theatre) -> None:
    config = RaceConfig(
        gait="left-right-origin", robot=Robot(tibia_m=0.001), lanes=(LaneConfig(agent="greedy"),)
    )
    run = theatre.create(config, state="failed")
    theatre.stage.show(run.id)

    assert theatre.look().lanes[0].qpos.shape == (25,)
    assert theatre.stage.state()["ended"]
