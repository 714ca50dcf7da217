"""Recordings: stored steps, interpolation of poses, and encoding as a file."""

import io
from collections.abc import Sequence
from itertools import count

import numpy as np
import pytest

from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.runs.clocks import Timetable
from hexapods.runs.config import training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.race_file import race_arrays, race_recording
from hexapods.runs.racing import record_race
from hexapods.runs.recording import (
    FIRST_STEPS,
    NEWEST_STEPS,
    LaneRecording,
    PracticeRecording,
    pose_at,
)
from hexapods.runs.records import Evaluated, LaneStep, StepTaken
from hexapods.runs.tables import snapshot
from hexapods.runs.training import train
from tests.runs.sample_lanes import lane, qpos, step

START = np.array(qpos(0), np.float32)


AGENTS = ("q-learning", "greedy", "two-step")
"""Those of the paper."""


def a_race(steps: int, agents: Sequence[str] = AGENTS) -> list[LaneRecording]:
    """Record a race on MuJoCo, of a briefly trained learner and two that learn nothing."""
    practice = training_config(gait="left-right-origin", simulator="kinematic", steps=200)
    learner = build_learner(practice)
    for _ in train(learner, practice):
        pass
    config = RaceConfig(
        gait="left-right-origin", steps=steps, lanes=tuple(LaneConfig(agent=a) for a in agents)
    )
    walkers = build_walkers(config, [snapshot(learner, practice), None, None])
    ticks = count()
    *_, lanes = record_race(walkers, config, lambda: float(next(ticks)))
    return lanes


@pytest.fixture(scope="module")
def race() -> list[LaneRecording]:
    return a_race(steps=6)


def test_what_a_search_found_is_recorded(race: list[LaneRecording]) -> None:
    learner, greedy, two_step = race
    assert not any(taken.futures for taken in learner.steps)
    for taken in (*greedy.steps, *two_step.steps):
        assert taken.action in [future.action for future in taken.futures]
        assert len(taken.futures) == 12
    for taken in greedy.steps:
        assert max(future.reward_m for future in taken.futures) == taken.reward_m


def as_file(lanes: list[LaneRecording]) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **race_arrays(lanes))  # type: ignore[arg-type]
    return buffer.getvalue()


def assert_same(before: LaneStep, after: LaneStep) -> None:
    for name in ("step", "observation", "action", "reward_m", "distance_m", "transitions"):
        assert getattr(before, name) == getattr(after, name)
    assert before.decision_s == after.decision_s
    for array, again in zip(before.motion, after.motion, strict=True):
        assert (array is None) == (again is None)
        if array is not None and again is not None:
            assert array.dtype == again.dtype
            assert np.array_equal(array, again)
    assert before.futures == after.futures
    assert (before.action_values is None) == (after.action_values is None)
    if before.action_values and after.action_values:
        assert np.allclose(before.action_values.values, after.action_values.values, equal_nan=True)
        assert np.array_equal(
            before.action_values.visits, after.action_values.visits, equal_nan=True
        )


def test_race_round_trips_through_a_file_without_pickle(
    race: list[LaneRecording],
) -> None:
    with np.load(io.BytesIO(as_file(race)), allow_pickle=False) as file:
        back = race_recording(dict(file))

    assert [lane.agent for lane in back] == list(AGENTS)
    for lane_before, lane_after in zip(race, back, strict=True):
        assert np.array_equal(lane_before.rest_qpos, lane_after.rest_qpos)
        assert lane_after.failure is None
        assert len(lane_after.steps) == 6
        for before, after in zip(lane_before.steps, lane_after.steps, strict=True):
            assert_same(before, after)
    assert [s.lane for s in back[2].steps] == [2] * 6
    assert [s.action_values is not None for s in (lane.steps[0] for lane in back)] == [1, 0, 0]


def test_a_race_records_what_its_servos_did(race: list[LaneRecording]) -> None:
    for recorded in race:
        for taken in recorded.steps:
            torque, work = taken.motion.torque_nm, taken.motion.work_j
            assert torque is not None
            assert torque.shape == (len(taken.motion.time_s), 18)
            assert work is not None
            assert 0.1 < work.sum() < 2  # joules in a step


def test_a_recording_of_an_earlier_version_has_no_torques(race: list[LaneRecording]) -> None:
    arrays = race_arrays(race)
    for name in list(arrays):
        if name.endswith((".torque_nm", ".work_j")):
            del arrays[name]
    back = race_recording(arrays)

    assert back[0].steps[0].motion.torque_nm is None
    assert back[0].steps[0].motion.work_j is None
    assert set(race_arrays(back)) == set(arrays)


def test_failed_and_empty_lanes_round_trip() -> None:
    before = [lane(step(1, [0.1, 0.2]), failure="it fell"), lane(failure="its agent failed")]
    back = race_recording(race_arrays(before))

    assert [lane.failure for lane in back] == ["it fell", "its agent failed"]
    assert [len(lane.steps) for lane in back] == [1, 0]
    assert_same(back[0].steps[0], before[0].steps[0])


def test_one_minute_of_a_race_of_three_takes_under_two_megabytes(race: list[LaneRecording]) -> None:
    """By the clock that puts most motion into a minute."""
    seconds = max(Timetable.of(lane.steps, "free").total_s for lane in race)

    assert seconds == pytest.approx(6 * 0.32)
    assert len(as_file(race)) * 60 / seconds < 2_000_000


def test_a_recording_has_fifty_poses_a_second(race: list[LaneRecording]) -> None:
    for recorded in race:
        for taken in recorded.steps:
            assert taken.motion.time_s == pytest.approx(np.arange(1, 17) * 0.02)


def test_each_step_starts_at_the_pose_where_the_last_ended(race: list[LaneRecording]) -> None:
    recorded = race[1]

    assert recorded.start_qpos(0) is recorded.rest_qpos
    for number in range(1, 6):
        last = recorded.steps[number - 1].motion.qpos[-1]
        assert np.array_equal(recorded.start_qpos(number), last)
        assert np.abs(recorded.steps[number].motion.qpos[0] - last).max() < 0.2
    assert recorded.distance_m == recorded.steps[-1].distance_m
    assert lane().distance_m == 0


@pytest.mark.parametrize(
    ("time_s", "y"), [(0, 0), (0.25, 0.1), (0.5, 0.2), (0.75, 0.25), (1, 0.3), (1.2, 0.3), (-1, 0)]
)
def test_pose_between_two_frames_is_interpolated(time_s: float, y: float) -> None:
    motion = step(1, [0.2, 0.3]).motion

    assert pose_at(START, motion, time_s) == pytest.approx(qpos(y), abs=1e-6)


def test_interpolated_quaternion_has_unit_length() -> None:
    turned = np.array([0, 0, 0.1, np.sqrt(0.5), 0, 0, np.sqrt(0.5), 0], np.float32)
    motion = Motion(np.array([1], np.float32), turned[None])
    pose = pose_at(START, motion, 0.5)

    assert np.linalg.norm(pose[3:7]) == pytest.approx(1)
    assert pose[3:7] == pytest.approx((np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)), abs=1e-6)


def test_interpolation_does_not_modify_the_recording() -> None:
    motion = step(1, [0.2, 0.3]).motion
    before = motion.qpos.copy()
    for time_s in (0.0, 0.3, 2.0):
        pose_at(START, motion, time_s)[:] = 9

    assert np.array_equal(motion.qpos, before)
    assert START.tolist() == pytest.approx(qpos(0))


def taken(number: int) -> StepTaken:
    return StepTaken(number, 0, 0.0, (0, 0, 0), Action(0, 1), 0.0, 0.0, None, None)


def test_practice_recording_stores_the_first_20_and_newest_500_steps() -> None:
    recording = PracticeRecording(START)
    for number in range(1, 701):
        recording.add(taken(number))
        if number % 100 == 0:
            recording.add(Evaluated(number, 0.0, 0.1, None))
    stored = [s.step for s in recording.steps]

    assert (FIRST_STEPS, NEWEST_STEPS) == (20, 500)
    assert stored == [*range(1, 21), *range(201, 701)]
    assert [e.step for e in recording.evaluations] == [100, 200, 300, 400, 500, 600, 700]


def test_short_practice_is_stored_completely() -> None:
    recording = PracticeRecording(START)
    for number in range(1, 101):
        recording.add(taken(number))

    assert [s.step for s in recording.steps] == list(range(1, 101))
