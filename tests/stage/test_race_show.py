"""A race as it is shown."""

from itertools import pairwise

import numpy as np
import pytest

from app.domain.robot import Robot
from app.runs.config import LaneConfig, RaceConfig
from app.runs.results import finish_s, race_result
from app.stage.race_show import LAST_LANE_SPEED, PHOTO_FINISH_S, SPEED
from app.stage.stage_frame import StageFrame
from tests.stage.stage_parts import FRAME_S, StageParts

LANES = ("q-learning", "greedy", "two-step")


@pytest.fixture
def parts() -> StageParts:
    return StageParts()


def shown(parts: StageParts) -> list[StageFrame]:
    parts.stage.show(parts.race(LANES).id)
    return parts.watch_to_end()


def test_it_is_shown_at_twice_its_speed_and_the_last_lane_at_eight(parts: StageParts) -> None:
    frames = shown(parts)
    speeds = [b.time_s - a.time_s for a, b in pairwise(frames)]

    assert frames[5].shown_speed == SPEED
    assert speeds[5] == pytest.approx(SPEED * FRAME_S)
    assert frames[-10].shown_speed == LAST_LANE_SPEED
    assert speeds[-10] == pytest.approx(LAST_LANE_SPEED * FRAME_S)


def test_the_first_finish_is_frozen_for_three_seconds(parts: StageParts) -> None:
    frames = shown(parts)
    frozen = [frame for frame in frames if frame.phase == "photo-finish"]
    lanes = parts.recordings.race(frozen[0].run_id or "") or []
    result = race_result(lanes, 12)["lanes"]

    assert len(frozen) * FRAME_S == pytest.approx(PHOTO_FINISH_S, abs=2 * FRAME_S)
    assert {frame.time_s for frame in frozen} == {finish_s(lanes, 12, "paper")}
    under = [lane["clocks"]["paper"] for lane in result]
    assert [lane.distance_m for lane in frozen[0].lanes] == pytest.approx(
        [lane["finished_distance_m"] for lane in under]
    )
    assert [lane.rank for lane in frames[-1].lanes] == [lane["rank"] for lane in under]


def test_poses_go_from_rest_to_the_recordings_end_without_a_jump(parts: StageParts) -> None:
    frames = shown(parts)
    lanes = parts.recordings.race(frames[0].run_id or "") or []

    for number, lane in enumerate(lanes):
        places = np.array([frame.lanes[number].qpos[:3] for frame in frames])
        assert np.abs(places[0] - lane.rest_qpos[:3]).max() < 0.005
        assert places[-1] == pytest.approx(lane.steps[-1].motion.qpos[-1, :3], abs=1e-6)
        assert np.abs(np.diff(places, axis=0)).max() < 0.05
    assert [lane.done for lane in frames[-1].lanes] == [True, True, True]
    assert frames[-1].phase == "finished"


def test_a_lane_that_thinks_counts_its_futures(parts: StageParts) -> None:
    frames = shown(parts)
    thinking = [frame.lanes[2] for frame in frames if frame.lanes[2].thinking]

    assert {lane.futures_total for lane in thinking} == {156}
    first = [lane.futures for lane in thinking if lane.step == 1]
    assert first == sorted(first)
    assert first[0] < 20
    assert first[-1] > 140
    assert not any(frame.lanes[0].thinking for frame in frames), "a table needs no thought"


def test_another_clock_retimes_the_same_race_at_the_same_place(parts: StageParts) -> None:
    parts.stage.show(parts.race(LANES).id)
    before = parts.watch(1.5)[-1]
    parts.stage.set(playing=False, clock="free")
    after = parts.look()

    assert after.clock == "free"
    assert after.time_s == before.time_s, "the leader does not think"
    assert after.lanes[2].step == after.lanes[0].step > before.lanes[2].step
    assert not any(lane.thinking for lane in after.lanes)

    parts.stage.set(clock="paper")
    assert parts.look().time_s == pytest.approx(before.time_s)


def test_the_clock_at_the_end_and_at_the_photo_finish(parts: StageParts) -> None:
    run = parts.race(LANES)
    lanes = parts.recordings.race(run.id) or []
    parts.stage.show(run.id)
    while parts.look().phase != "photo-finish":
        pass
    parts.stage.set(clock="free")
    assert parts.look().phase == "photo-finish"
    assert parts.look().time_s == finish_s(lanes, 12, "free")

    parts.watch_to_end()
    parts.stage.set(clock="wall")
    assert parts.stage.state()["ended"]


def test_skip_goes_to_the_end(parts: StageParts) -> None:
    parts.stage.show(parts.race(LANES).id)
    duration = parts.look().duration_s
    assert duration is not None
    parts.stage.set(time_s=duration)

    assert parts.look().phase == "finished"


def test_a_chosen_speed_holds_throughout(parts: StageParts) -> None:
    parts.stage.show(parts.race(LANES).id)
    parts.stage.set(speed=16)
    frames = parts.watch_to_end()

    assert {frame.shown_speed for frame in frames} == {16.0, 0.0}

    parts.stage.set(time_s=0, speed="time-lapse")
    assert parts.look().shown_speed == SPEED


def test_it_waits_for_a_lane_that_still_computes(parts: StageParts) -> None:
    run, walk = parts.racing(("greedy", "two-step"))
    parts.stage.show(run.id)
    assert parts.look().phase == "waiting"
    for _ in range(3):  # greedy has two steps, two-step one
        walk()
    frame = parts.watch(10.0)[-1]
    lanes = parts.recordings.race(run.id) or []

    assert frame.phase == "waiting"
    assert frame.duration_s is None
    assert frame.lanes[0].qpos == pytest.approx(lanes[0].steps[-1].motion.qpos[-1])
    assert frame.lanes[0].thinking
    assert not parts.stage.state()["ended"]

    while walk():
        pass
    parts.set_state(run, "finished")
    assert parts.watch_to_end()[-1].lanes[1].step == 12


def test_before_anything_is_recorded_they_stand_on_the_start_line(parts: StageParts) -> None:
    config = parts.race().config
    assert isinstance(config, RaceConfig)
    parts.stage.show(parts.create(config).id)

    frame = parts.look()

    assert frame.phase == "start-line"
    assert [lane.step for lane in frame.lanes] == [0, 0]
    assert not parts.stage.state()["ended"]


def test_a_race_that_failed_shows_what_it_has_and_ends(parts: StageParts) -> None:
    run, walk = parts.racing()
    parts.stage.show(run.id)
    for _ in range(4):
        walk()
    parts.set_state(run, "failed")

    frame = parts.watch_to_end()[-1]

    assert [lane.step for lane in frame.lanes] == [2, 2]
    assert [lane.done for lane in frame.lanes] == [True, True]


def test_who_gains_nothing_marches_on_the_spot(parts: StageParts) -> None:
    """An untrained table with every value equal wanders without getting anywhere fast."""
    parts.stage.show(parts.race(LANES, steps=40).id)
    frames = parts.watch_to_end(400)
    greedy = [frame.lanes[1] for frame in frames]
    idle = [frame.lanes[0] for frame in frames]

    assert not any(lane.marching for lane in greedy)
    assert any(lane.marching for lane in idle)
    assert not any(lane.marching for lane in idle if lane.step <= 10)


def test_a_race_that_computes_slowly_is_shown_without_stopping_at_each_step(
    parts: StageParts,
) -> None:
    run, walk = parts.racing(("greedy",), steps=40)
    parts.stage.show(run.id)
    frames = []
    for _ in range(30):
        walk()
        frames += parts.watch(0.4)
    gone = np.diff([frame.time_s for frame in frames])[100:]

    assert gone.min() > 0
    assert gone.max() < 4 * gone.mean()


def test_a_robot_that_cannot_stand_is_shown_all_the_same(parts: StageParts) -> None:
    config = RaceConfig(
        gait="left-right-origin", robot=Robot(tibia_m=0.001), lanes=(LaneConfig(agent="greedy"),)
    )
    run = parts.create(config, state="failed")
    parts.stage.show(run.id)

    assert parts.look().lanes[0].qpos.shape == (25,)
    assert parts.stage.state()["ended"]
