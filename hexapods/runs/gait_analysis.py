"""Gait analysis of a recorded walk: footfalls, speed, limit cycle, posture, torque and energy.

Times are robot time: motion only, without the time in which an agent decides. Nothing is simulated:
all follows from the recorded poses and, of races, from the torques and work recorded with them.

The cost of transport is energy by weight and distance (Tucker 1975, "The energetic cost of moving
about", American Scientist 63; Alexander 2003, chapter 7): energy is the joints' mechanical work.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import takewhile
from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from hexapods.domain.disturbances import Lost, Payload
from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematics import legs_of
from hexapods.domain.posture import rotation_matrices
from hexapods.domain.records import Record
from hexapods.domain.robot import Robot
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World
from hexapods.runs.footfall import Interval, clearances_m, clipped, duty_factor, stance_intervals
from hexapods.runs.recorded_walk import RecordedWalk

GRAVITY_M_S2 = 9.81
MAX_WINDOW_S = 120.0
"""Longest part of a walk that is analysed at once, in robot time."""
MAX_SAMPLES = 1000
"""Samples of a series over time; of longer windows every second, third, … frame."""
MIN_DISTANCE_M = 0.01
"""Below this distance there is no cost of transport."""
CYCLE_REPEATS = 3
"""A sequence of steps is a cycle if it ends the walk so many times in a row."""
MAX_CYCLE_STEPS = 200
MAX_LOOKED_BACK = 10_000
"""Number of last steps in which the repetitions of a cycle are counted."""


Share = Annotated[float, Ge(0), Le(1)]


@dataclass(frozen=True)
class LegGait(Record):
    """Footfalls of a leg in a window: when it stands [s], and the share of that."""

    leg: Annotated[int, Ge(1)]
    stance: list[Interval]
    duty_factor: Share


@dataclass(frozen=True)
class Cycle(Record):
    """The sequence of steps that a walk repeats at its end, at least three times.

    Attributes:
        steps: its length.
        period_s: its duration.
        first_step: the step in which the repetition begins, counted from 0.
        repeats: how often it was walked, in full.
        advance_m: the distance along the track in one period, on average.
        actions: (group, cell) of each step, beginning with that of `first_step`.
    """

    steps: Annotated[int, Ge(1)]
    period_s: float
    first_step: Annotated[int, Ge(0)]
    repeats: Annotated[int, Ge(CYCLE_REPEATS)]
    advance_m: float
    actions: list[tuple[int, int]]


@dataclass(frozen=True)
class Posture(Record):
    """The torso over time: the height of its centre over flat ground, its pitch and roll.

    Attributes:
        time_s: robot time of the samples.
        height_m, pitch_deg, roll_deg: at those times; pitch is positive with the front up, roll
            with the left side up.
        height_range_m, pitch_range_deg, roll_range_deg: lowest and highest of all frames.
    """

    time_s: list[float]
    height_m: list[float]
    pitch_deg: list[float]
    roll_deg: list[float]
    height_range_m: tuple[float, float]
    pitch_range_deg: tuple[float, float]
    roll_range_deg: tuple[float, float]


@dataclass(frozen=True)
class ServoEffort(Record):
    """Torque and mechanical work of the servos.

    Attributes:
        time_s: robot time of the samples.
        torque_nm: the largest torque of any servo since the sample before, by magnitude.
        power_w: mean positive mechanical power of all servos since the sample before.
        largest_torque_nm: in the window.
        torque_limit_nm: the most that the servo with the largest torque has.
        energy_j: positive mechanical work in the window; what servos draw on top is not simulated.
        mean_power_w: energy by time.
        cost_of_transport: energy by weight times distance; None without distance.
    """

    time_s: list[float]
    torque_nm: list[float]
    power_w: list[float]
    largest_torque_nm: float
    torque_limit_nm: float
    energy_j: float
    mean_power_w: float
    cost_of_transport: float | None


@dataclass(frozen=True)
class GaitFigures(Record):
    """Figures of a walk between two times of robot time.

    Attributes:
        from_s, to_s: the window.
        distance_m: along the direction that the robot faces at the beginning of the recorded steps.
        speed_m_s: distance by time.
        speed_body_lengths_s: speed by the diameter of the torso.
        duty_factor: mean of all legs that the robot has.
        mass_kg: of the robot with its payload, mean over the window.
        legs: footfalls of each leg.
        cycle: None if the walk does not end in one, or its choices were not recorded.
        posture: of the torso.
        effort: None if it was not recorded.
    """

    from_s: float
    to_s: float
    distance_m: float
    speed_m_s: float
    speed_body_lengths_s: float
    duty_factor: Share
    mass_kg: float
    legs: list[LegGait]
    cycle: Cycle | None
    posture: Posture
    effort: ServoEffort | None


def window_of(
    walks: Sequence[RecordedWalk], from_s: float | None, to_s: float | None, newest: bool = False
) -> tuple[float, float]:
    """Return the window that is analysed of some walks: by default all, up to `MAX_WINDOW_S`.

    Args:
        walks: the walks.
        from_s: its beginning in robot time; None for the beginning of the walks, or what is
            possible with this end.
        to_s: its end; None for the end of the walks, or what is possible with this beginning.
        newest: whether a window without beginning and end is at the end of longer walks.

    Raises:
        InvalidInput: if it is empty, too long, or after the end.
    """
    first_s = min((walk.from_s for walk in walks if walk.steps), default=0.0)
    last_s = max((walk.to_s for walk in walks), default=0.0)
    if from_s is None:
        latest = to_s if to_s is not None else last_s if newest else first_s
        begin = max(first_s, latest - MAX_WINDOW_S)
    else:
        begin = from_s
    end = min(begin + MAX_WINDOW_S, last_s) if to_s is None else to_s
    if walks and begin >= last_s > 0:
        raise InvalidInput(
            f"the window begins after the end of the recording; choose a from_s under {last_s:.2f}"
        )
    if end <= begin and last_s > 0:
        raise InvalidInput(f"the window ends before it begins; choose a to_s over {begin:g}")
    if end - begin > MAX_WINDOW_S + 1e-9:
        raise InvalidInput(
            f"the window is too long; choose a to_s at most {MAX_WINDOW_S:g} s after from_s"
        )
    return begin, min(end, last_s)


def gait_figures(walk: RecordedWalk, from_s: float, to_s: float) -> GaitFigures | None:
    """Analyse a part of a walk.

    Args:
        walk: the walk.
        from_s: beginning of the part, in robot time.
        to_s: its end.

    Returns:
        None if no recorded frame of the walk lies in that part.
    """
    from_s, to_s = max(from_s, walk.from_s), min(to_s, walk.to_s)
    frames = _frames(walk, from_s, to_s)
    if frames is None:
        return None
    inside = (frames.times_s >= from_s) & (frames.times_s <= to_s)
    # The first frame is the pose before the steps, at which nothing was done.
    if to_s <= from_s or not inside[1:].any():
        return None
    robot = walk.problem.built_robot
    clearance = clearances_m(robot, frames.poses, frames.steps, walk.world)
    legs = []
    for leg in range(1, len(robot.legs) + 1):
        stance = stance_intervals(frames.times_s, clearance[:, leg - 1])
        duty = duty_factor(stance, from_s, to_s)
        legs.append(LegGait(leg, _rounded_intervals(clipped(stance, from_s, to_s)), duty))
    forward = walk.problem.resolved_gait.forward_deg
    distance = _distance_m(walk, frames, forward, from_s, to_s)
    speed = distance / (to_s - from_s)
    is_gone = np.asarray(np.isinf(clearance).all(axis=0))
    duties = [leg.duty_factor for leg, gone in zip(legs, is_gone, strict=True) if not gone]
    mass = _mean_mass_kg(robot, walk.world, frames.steps)
    return GaitFigures(
        from_s=from_s,
        to_s=to_s,
        distance_m=distance,
        speed_m_s=speed,
        speed_body_lengths_s=speed / (2 * robot.torso_half_sides_m[1]),
        duty_factor=ordered_sum(duties) / max(1, len(duties)),
        mass_kg=mass,
        legs=legs,
        cycle=_cycle(walk),
        posture=_posture(frames.times_s[inside], frames.poses[inside], forward),
        effort=_effort(
            frames,
            inside,
            robot,
            weight_n=mass * GRAVITY_M_S2,
            distance_m=distance,
            duration_s=to_s - from_s,
        ),
    )


def gait_summary(figures: GaitFigures | None) -> dict[str, Any] | None:
    """Return the single numbers of figures in plain types, without what they have over time."""
    if figures is None:
        return None
    effort = figures.effort
    numbers = ("from_s", "to_s", "speed_m_s", "speed_body_lengths_s", "duty_factor")
    efforts = ("largest_torque_nm", "energy_j", "cost_of_transport")
    return {
        **{name: getattr(figures, name) for name in numbers},
        "leg_duty_factors": [leg.duty_factor for leg in figures.legs],
        "cycle": None if figures.cycle is None else asdict(figures.cycle),
        "mass_kg": figures.mass_kg,
        **{name: None if effort is None else getattr(effort, name) for name in efforts},
    }


@dataclass(frozen=True)
class _Frames:
    """Frames of consecutive steps, with the pose before the first."""

    times_s: FloatArray
    poses: FloatArray
    steps: NDArray[np.int64]
    """The step that each frame belongs to, counted from 0."""
    torque_nm: FloatArray | None
    """0 in the first frame."""
    work_j: FloatArray | None


def _frames(walk: RecordedWalk, from_s: float, to_s: float) -> _Frames | None:
    """Return the frames of all steps that are partly between two times."""
    step_s, steps = walk.problem.robot.step_s, walk.steps
    if not steps:
        return None
    number = steps[0].step - 1  # of the first, counted from 0
    first = max(0, math.floor(from_s / step_s + 1e-9) - number)
    last = min(len(steps), math.ceil(to_s / step_s - 1e-9) - number)
    motions = [walk.motion(index) for index in range(first, last)]
    if not motions:
        return None
    start = walk.pose_before(first)
    times, numbers = [np.array([(number + first) * step_s])], [np.array([number + first])]
    for step_number, motion in enumerate(motions, start=number + first):
        times.append(motion.time_s.astype(float) + step_number * step_s)
        numbers.append(np.full(len(motion.time_s), step_number))
    efforts = [(motion.torque_nm, motion.work_j) for motion in motions]
    torque = work = None
    if all(torque is not None and work is not None for torque, work in efforts):
        joints = len(start) - 7
        torque = np.concatenate(
            [np.zeros((1, joints)), *(torque for torque, _ in efforts if torque is not None)]
        )
        work = np.concatenate([np.zeros(1), *(other for _, other in efforts if other is not None)])
    return _Frames(
        np.concatenate(times),
        np.concatenate([start[None], *(motion.qpos for motion in motions)]).astype(float),
        np.concatenate(numbers),
        torque,
        work,
    )


def _distance_m(
    walk: RecordedWalk, frames: _Frames, forward_deg: float, from_s: float, to_s: float
) -> float:
    """Return the displacement along the direction that the robot faces at the walk's beginning."""
    turn = rotation_matrices(walk.start_qpos[None].astype(float))[0]
    angle = math.radians(forward_deg)
    ahead = (turn @ (math.cos(angle), math.sin(angle), 0.0))[:2]
    along = frames.poses[:, :2] @ (ahead / math.hypot(*ahead))
    before, after = np.interp([from_s, to_s], frames.times_s, along)
    return float(after - before)


def _mean_mass_kg(robot: Robot, world: World, steps: NDArray[np.int64]) -> float:
    masses_kg = dict(enumerate(legs_of(robot).masses_kg, start=1))
    numbers, counts = np.unique(steps, return_counts=True)
    total = 0.0
    for number, count in zip(numbers.tolist(), counts.tolist(), strict=True):
        conditions = world.as_of(number)
        lost = {leg for disturbance in conditions.all_of(Lost) for leg in disturbance.legs}
        legs = math.fsum(kg for leg, kg in masses_kg.items() if leg not in lost)
        payload = ordered_sum(payload_.kg for payload_ in conditions.all_of(Payload))
        total += count * (robot.torso_kg + legs + payload)
    return total / len(steps)


def _cycle(walk: RecordedWalk) -> Cycle | None:
    """Return the shortest sequence of choices that ends the walk `CYCLE_REPEATS` times in a row."""
    choices = walk.choices(MAX_LOOKED_BACK)[::-1]
    if not choices or choices[0][1] is None:
        return None
    for period in range(1, min(MAX_CYCLE_STEPS, len(choices) // CYCLE_REPEATS) + 1):
        earlier = zip(choices, choices[period:], strict=False)
        repeated = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], earlier))
        if repeated >= (CYCLE_REPEATS - 1) * period:
            return _cycle_of(walk, period, len(walk.steps) - repeated - period)
    return None


def _cycle_of(walk: RecordedWalk, period: int, first: int) -> Cycle:
    repeats = (len(walk.steps) - first) // period
    end = first + repeats * period
    advance = float(walk.motion(end - 1).qpos[-1][1] - walk.pose_before(first)[1]) / repeats
    return Cycle(
        steps=period,
        period_s=period * walk.problem.robot.step_s,
        first_step=walk.steps[first].step - 1,
        repeats=repeats,
        advance_m=advance,
        actions=[
            (step.action.group, step.action.cell)
            for step in walk.steps[first : first + period]
            if step.action is not None
        ],
    )


def _posture(times_s: FloatArray, poses: FloatArray, forward_deg: float) -> Posture:
    turns, angle = rotation_matrices(poses), math.radians(forward_deg)
    cos, sin = math.cos(angle), math.sin(angle)
    # The height that a unit vector of the body has in the world is the sine of its inclination.
    front, left = turns[:, 2, :2] @ (cos, sin), turns[:, 2, :2] @ (-sin, cos)
    height = poses[:, 2]
    pitch, roll = (np.degrees(np.arcsin(np.clip(component, -1, 1))) for component in (front, left))
    every = slice(None, None, -(-len(times_s) // MAX_SAMPLES))
    return Posture(
        time_s=_rounded(times_s[every]),
        height_m=_rounded(height[every], 5),
        pitch_deg=_rounded(pitch[every], 3),
        roll_deg=_rounded(roll[every], 3),
        height_range_m=_range(height, 5),
        pitch_range_deg=_range(pitch, 3),
        roll_range_deg=_range(roll, 3),
    )


def _effort(
    frames: _Frames,
    inside: NDArray[np.bool_],
    robot: Robot,
    *,
    weight_n: float,
    distance_m: float,
    duration_s: float,
) -> ServoEffort | None:
    if frames.torque_nm is None or frames.work_j is None:
        return None
    inside = inside.copy()
    inside[0] = False
    by_joint = np.abs(frames.torque_nm[inside])
    times, torque = frames.times_s[inside], by_joint.max(axis=1)
    joint = legs_of(robot).joints[int(by_joint.max(axis=0).argmax())]
    work, lasted = frames.work_j[inside], np.diff(frames.times_s, prepend=0.0)[inside]
    begins = np.arange(0, len(times), -(-len(times) // MAX_SAMPLES))
    power = np.add.reduceat(work, begins) / np.add.reduceat(lasted, begins)
    energy = float(work.sum())
    has_advanced = distance_m >= MIN_DISTANCE_M
    return ServoEffort(
        time_s=_rounded(times[np.append(begins[1:] - 1, len(times) - 1)]),
        torque_nm=_rounded(np.maximum.reduceat(torque, begins)),
        power_w=_rounded(power, 3),
        largest_torque_nm=round(float(torque.max()), 4),
        torque_limit_nm=robot.servo_of(joint.leg, joint.name).torque_nm,
        energy_j=energy,
        mean_power_w=energy / duration_s,
        cost_of_transport=energy / (weight_n * distance_m) if has_advanced else None,
    )


def _rounded(values: FloatArray, digits: int = 4) -> list[float]:
    rounded: list[float] = np.round(values, digits).tolist()
    return rounded


def _range(values: FloatArray, digits: int) -> tuple[float, float]:
    return round(float(values.min()), digits), round(float(values.max()), digits)


def _rounded_intervals(intervals: Sequence[Interval]) -> list[Interval]:
    return [(round(start, 4), round(end, 4)) for start, end in intervals]
