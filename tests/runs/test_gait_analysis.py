"""Gait analysis: figures of recorded walks, of hand-made ones and of the kinematic law."""

import time
from dataclasses import replace

import numpy as np
import pytest

from hexapods.assembly import build_learner, build_walkers
from hexapods.domain.disturbances import Lost, Payload
from hexapods.domain.errors import InvalidInput
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.config import WalkingProblem, training_config
from hexapods.runs.gait_analysis import MAX_SAMPLES, MAX_WINDOW_S, gait_figures, window_of
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.runs.recorded_walk import (
    EvaluatedStep,
    RecordedWalk,
    walk_of_evaluation,
    walk_of_lane,
    walk_of_practice,
)
from hexapods.runs.recording import PracticeRecording
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.training import train

STEP_S = 0.32


def walk(agent: str = "greedy", **problem: object) -> RecordedWalk:
    """Return a race's only lane, as it was recorded."""
    config = RaceConfig(
        **{"gait": "left-right-origin", "simulator": "kinematic", **problem},  # type: ignore[arg-type]
        lanes=(LaneConfig(agent=agent),),
    )
    *_, lanes = record_race(build_walkers(config, [None]), config, time.perf_counter)
    return walk_of_lane(lanes[0], config, config.world)


@pytest.fixture(scope="module")
def greedy() -> RecordedWalk:
    return walk()


@pytest.fixture(scope="module")
def with_physics() -> RecordedWalk:
    return walk(simulator="mujoco", steps=15)


def test_speed_is_distance_by_robot_time(greedy: RecordedWalk) -> None:
    figures = gait_figures(greedy, 0, 50 * STEP_S)

    assert figures is not None
    assert [greedy.from_s, greedy.to_s] == pytest.approx([0, 16.0])
    assert figures.distance_m == pytest.approx(24.833 * 0.02, abs=1e-4)
    assert figures.speed_m_s == pytest.approx(figures.distance_m / 16)
    assert figures.speed_body_lengths_s == pytest.approx(figures.speed_m_s / 0.2)


def test_each_pair_swings_a_third_of_the_steps_for_the_share_of_the_swing(
    greedy: RecordedWalk,
) -> None:
    """Without slip a foot is in the air for 0.2 s of three steps of 0.32 s."""
    figures = gait_figures(greedy, 24 * STEP_S, 48 * STEP_S)

    assert figures is not None
    expected = 1 - 0.2 / (3 * STEP_S)
    assert figures.duty_factor == pytest.approx(expected, abs=0.005)
    for leg in figures.legs:
        assert leg.duty_factor == pytest.approx(expected, abs=0.005)
        assert leg.stance[0][0] >= figures.from_s
        assert leg.stance[-1][1] <= figures.to_s
    first, opposite = figures.legs[0], figures.legs[3]  # of one pair
    assert np.array(first.stance) == pytest.approx(np.array(opposite.stance), abs=0.003)


def test_a_window_may_begin_and_end_within_a_step(greedy: RecordedWalk) -> None:
    whole = gait_figures(greedy, 0, 3.0)
    figures = [gait_figures(greedy, *window) for window in ((0, 1.13), (1.13, 3.0))]

    assert whole is not None
    assert sum(partial.distance_m for partial in figures if partial) == pytest.approx(
        whole.distance_m
    )
    assert [(partial.from_s, partial.to_s) for partial in figures if partial] == [
        (0, 1.13),
        (1.13, 3.0),
    ]


@pytest.mark.parametrize("window", [(0.005, 0.015), (0.0, 0.01), (0.0, 0.004), (3.201, 3.219)])
def test_a_window_between_two_frames_has_no_figures(
    greedy: RecordedWalk, with_physics: RecordedWalk, window: tuple[float, float]
) -> None:
    """Frames are 0.02 s apart."""
    assert gait_figures(greedy, *window) is None
    assert gait_figures(with_physics, *window) is None


def test_a_window_with_one_frame_has_figures(with_physics: RecordedWalk) -> None:
    for window in ((0.015, 0.025), (0.0, 0.02), (0.999, 1.001)):
        figures = gait_figures(with_physics, *window)
        assert figures is not None
        assert figures.effort is not None
        assert len(figures.posture.time_s) <= 2


def test_the_cycle_is_the_sequence_that_ends_the_walk(greedy: RecordedWalk) -> None:
    figures = gait_figures(greedy, 0, 1)  # of the whole walk, whatever the window is

    assert figures is not None
    cycle = figures.cycle
    assert cycle is not None
    assert cycle.steps == 3
    assert cycle.period_s == pytest.approx(0.96)
    assert {pair for pair, _ in cycle.actions} == {0, 1, 2}
    assert cycle.repeats >= 3
    assert cycle.first_step + 3 * cycle.repeats <= 50
    assert cycle.advance_m == pytest.approx(3 * 0.01, abs=1e-5)  # h/2 a step


def test_steps_that_do_not_repeat_three_times_are_no_cycle(greedy: RecordedWalk) -> None:
    figures = gait_figures(replace(greedy, steps=greedy.steps[:8]), 0, 2)
    assert figures is not None
    assert figures.cycle is None


def test_the_torso_of_the_ideal_robot_stays_level(greedy: RecordedWalk) -> None:
    figures = gait_figures(greedy, 0, 16)

    assert figures is not None
    posture = figures.posture
    assert [*posture.height_range_m] == [0.102, 0.102]
    assert [*posture.pitch_range_deg, *posture.roll_range_deg] == [0, 0, 0, 0]
    assert len(posture.time_s) == len(posture.height_m) <= MAX_SAMPLES
    assert figures.effort is None  # without servos


@pytest.mark.parametrize("gait", ["left-right-origin", "front-back-vertical"])
@pytest.mark.parametrize(("axis", "signs"), [("pitch", (1, 0)), ("roll", (0, 1))])
def test_pitch_is_positive_with_the_front_up_and_roll_with_the_left_side_up(
    greedy: RecordedWalk, gait: str, axis: str, signs: tuple[int, int]
) -> None:
    problem = WalkingProblem(gait=gait, simulator="kinematic")
    ahead = np.deg2rad(problem.resolved_gait.forward_deg)
    # A turn about the axis to the right lifts the front, one about that to the back the left side.
    about = ahead - np.pi / 2 if axis == "pitch" else ahead
    half = np.deg2rad(10) / 2
    turned = np.array([np.cos(half), np.cos(about) * np.sin(half), np.sin(about) * np.sin(half), 0])
    motion = greedy.motion(0)
    poses = motion.qpos.copy()
    poses[:, 3:7] = turned
    step = EvaluatedStep(1, motion._replace(qpos=poses))
    walk = RecordedWalk(poses[0], [step], problem, UNDISTURBED)
    figures = gait_figures(walk, 0, STEP_S)

    assert figures is not None
    assert figures.posture.pitch_range_deg[1] == pytest.approx(10 * signs[0], abs=1e-3)
    assert figures.posture.roll_range_deg[1] == pytest.approx(10 * signs[1], abs=1e-3)


def test_the_cost_of_transport_is_energy_by_weight_and_distance(with_physics: RecordedWalk) -> None:
    figures = gait_figures(with_physics, 0, 15 * STEP_S)

    assert figures is not None
    effort = figures.effort
    assert effort is not None
    recorded = [with_physics.motion(index).work_j for index in range(15)]
    energy = sum(float(work.sum()) for work in recorded if work is not None)
    assert effort.energy_j == pytest.approx(energy)
    assert effort.mean_power_w == pytest.approx(energy / (15 * STEP_S))
    assert figures.mass_kg == pytest.approx(1.2 + 6 * 0.16)
    weight = figures.mass_kg * 9.81
    assert effort.cost_of_transport == pytest.approx(energy / (weight * figures.distance_m))
    assert 1 < energy / (weight * figures.distance_m) < 4
    assert max(effort.torque_nm) == pytest.approx(effort.largest_torque_nm)
    assert 0.3 < effort.largest_torque_nm < effort.torque_limit_nm == 1.5
    assert np.mean(effort.power_w) == pytest.approx(effort.mean_power_w, rel=0.01)


def test_the_limit_of_torque_is_that_of_the_servo_with_the_largest(
    with_physics: RecordedWalk,
) -> None:
    torques = [with_physics.motion(index).torque_nm for index in range(15)]
    largest = np.max(
        [np.abs(torque).max(axis=0) for torque in torques if torque is not None], axis=0
    )
    leg = 1 + int(largest.argmax()) // 3
    robot = with_physics.problem.robot
    legs = list(robot.legs)
    legs[leg - 1] = replace(legs[leg - 1], servo_torque_nm=2.5)
    stronger = replace(with_physics.problem, robot=replace(robot, legs=tuple(legs)))

    figures = gait_figures(replace(with_physics, problem=stronger), 0, 15 * STEP_S)

    assert figures is not None
    assert figures.effort is not None
    assert figures.effort.torque_limit_nm == 2.5


def test_without_distance_there_is_no_cost_of_transport(with_physics: RecordedWalk) -> None:
    figures = gait_figures(with_physics, 0, 0.02)

    assert figures is not None
    assert figures.effort is not None
    assert figures.effort.energy_j > 0
    assert figures.effort.cost_of_transport is None


def test_the_mass_counts_a_payload_and_legs_that_are_gone(with_physics: RecordedWalk) -> None:
    world = World((Payload(kg=1.0), Lost(legs=(2,), at_step=1)))
    figures = gait_figures(replace(with_physics, world=world), STEP_S, 15 * STEP_S)

    assert figures is not None
    assert figures.mass_kg == pytest.approx(1.2 + 5 * 0.16 + 1.0, abs=0.01)
    assert figures.legs[1].duty_factor < 0.01
    assert figures.duty_factor > 0.7  # of the legs that are there


def test_long_windows_have_fewer_samples_and_the_same_energy(with_physics: RecordedWalk) -> None:
    steps = [EvaluatedStep(n + 1, with_physics.motion(n % 15)) for n in range(300)]
    figures = gait_figures(replace(with_physics, steps=steps), 0, 300 * STEP_S)

    assert figures is not None
    assert figures.effort is not None
    assert len(figures.posture.time_s) <= MAX_SAMPLES
    assert len(figures.effort.time_s) <= MAX_SAMPLES
    once = gait_figures(with_physics, 0, 15 * STEP_S)
    assert once is not None
    assert once.effort is not None
    assert figures.effort.energy_j == pytest.approx(20 * once.effort.energy_j)
    assert figures.effort.largest_torque_nm == once.effort.largest_torque_nm


@pytest.mark.parametrize(
    ("bounds", "window"),
    [
        ((None, None), (0, 16.0)),
        ((2.0, None), (2.0, 16.0)),
        ((None, 4.0), (0, 4.0)),
        ((3.0, 99.0), (3.0, 16.0)),
        ((None, 130.0), (10.0, 16.0)),
    ],
)
def test_the_window_is_all_that_is_recorded_unless_a_part_is_asked_for(
    greedy: RecordedWalk, bounds: tuple[float | None, float | None], window: tuple[float, float]
) -> None:
    assert window_of([greedy], *bounds) == pytest.approx(window)


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ((16.0, None), r"choose a from_s under 16\.00"),
        ((5.0, 5.0), "choose a to_s over 5"),
        ((0.0, 1 + MAX_WINDOW_S), "choose a to_s at most 120 s after from_s"),
    ],
)
def test_a_window_that_is_none_is_refused(
    greedy: RecordedWalk, bounds: tuple[float, float | None], message: str
) -> None:
    with pytest.raises(InvalidInput, match=message):
        window_of([greedy], *bounds)


def test_the_newest_steps_of_a_practice_and_its_newest_evaluation() -> None:
    config = training_config(
        gait="left-right-origin", simulator="kinematic", steps=540, evaluate_every=540
    )
    learner = build_learner(config)
    rest = learner.walker.simulator.pose(learner.walker.state).astype(np.float32)
    recording = PracticeRecording(rest)
    for record in train(learner, config, record=True):
        if isinstance(record, StepTaken | Evaluated):
            recording.add(record)
    practice = walk_of_practice(recording, config, UNDISTURBED)

    assert len(practice.steps) == 500  # of the first twenty and the newest, which a gap separates
    assert window_of([practice], None, None, newest=True) == pytest.approx(
        (540 * STEP_S - 120, 540 * STEP_S)
    )
    figures = gait_figures(practice, 40 * STEP_S, 60 * STEP_S)
    assert figures is not None
    assert figures.duty_factor == pytest.approx(0.8, abs=0.05)

    first = walk_of_practice(recording, config, UNDISTURBED, from_s=1.0)
    assert (first.from_s, first.to_s) == pytest.approx((0, 20 * STEP_S))
    after = walk_of_practice(recording, config, UNDISTURBED, from_s=30 * STEP_S)
    assert after.from_s == pytest.approx(40 * STEP_S)

    evaluation = recording.evaluations[-1]
    tested = walk_of_evaluation(evaluation, recording, config, UNDISTURBED)
    figures = gait_figures(tested, 0, 16)
    assert figures is not None
    assert figures.distance_m == pytest.approx(evaluation.distance_m, abs=1e-4)
    assert figures.cycle is None  # its actions are not recorded
    assert figures.effort is None
