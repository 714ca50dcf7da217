"""A recorded walk as pulses of a robot's servos, and whether the servos can follow it.

The angles are the recorded ones, at which the joints were, and not those that the simulated servos
were commanded. Time is robot time: the motion of all steps, without the time that decisions take.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.errors import InvalidInput, TooLong
from hexapods.domain.types import FloatArray
from hexapods.exports.recorded_walks import ExportedLane, RecordedWalks, checked_lane
from hexapods.exports.servo_map import Servo, ServoMap

FRAME_S = 0.02
"""Time between two pulses of a servo, and two frames of a walk."""
MAX_FRAMES = 200_000
"""More than an hour."""


class ServoSpeed(NamedTuple):
    """Highest angular speed that a walk demands of a servo, and the speed that it can reach."""

    servo: Servo
    needed_deg_s: float
    """Largest speed of the servo, as it was recorded [°/s]."""
    at_s: float
    """Robot time of the largest speed [s]."""
    usable_deg_s: float | None
    """The share of its no-load speed that can be counted on [°/s]; None if it is not known."""

    @property
    def times_slower(self) -> float:
        """Factor by which the walk must be slowed for the servo to follow; at most 1 if not."""
        return 0.0 if self.usable_deg_s is None else self.needed_deg_s / self.usable_deg_s


@dataclass(frozen=True)
class ServoWalk:
    """A walk as servos get it, a frame every `FRAME_S`.

    Attributes:
        map: the servos.
        lane: number of the lane, from 0.
        agent: name of its agent.
        steps: the first and the last step.
        angles_rad: angles of the joints, in the order of poses, (frames, joints).
        pulses_us: pulse widths of the servos [µs], (frames, joints).
        speeds: highest speed of each servo, as it was recorded.
        slowed: factor by which its duration is longer than recorded.
    """

    map: ServoMap
    lane: int
    agent: str
    steps: tuple[int, int]
    angles_rad: FloatArray
    pulses_us: NDArray[np.int32]
    speeds: tuple[ServoSpeed, ...]
    slowed: float

    @property
    def duration_s(self) -> float:
        """Time of the last frame [s]."""
        return (len(self.angles_rad) - 1) * FRAME_S

    @property
    def too_slow(self) -> list[ServoSpeed]:
        """The servos that cannot follow, those that lack most first."""
        lacking = [speed for speed in self.speeds if speed.times_slower > self.slowed]
        return sorted(lacking, key=lambda speed: -speed.times_slower)

    @property
    def slow_enough(self) -> float:
        """Least factor by which the walk must be slowed so that all servos follow; at least 1."""
        return times_slower(self.speeds)


def times_slower(speeds: Sequence[ServoSpeed]) -> float:
    """Return the least factor by which a walk must be slowed, rounded up to 0.01; at least 1."""
    most = max(speed.times_slower for speed in speeds)
    return max(1.0, math.ceil(100 * most) / 100)


def servo_walk(
    walks: RecordedWalks, servo_map: ServoMap, lane: int = 0, *, slow_down: bool = False
) -> ServoWalk:
    """Return the pulses of a recorded walk.

    Of a practice these are its newest steps, of which none between them is missing.

    Args:
        walks: the recording.
        servo_map: map of the robot's servos.
        lane: number of the lane, from 0.
        slow_down: scale time as much as the servos need to follow.

    Raises:
        InvalidInput: if there is no such lane, nothing is recorded of it, or a servo would get a
            pulse outside of its limits; the message names the servo.
        TooLong: if there are more than `MAX_FRAMES` frames.
    """
    (number,) = checked_lane(walks, lane)
    chosen = walks.lanes[number]
    if not chosen.steps:
        raise InvalidInput(f"lane {number} has no recorded step; choose another one")
    first, step_s = _first_without_gap(chosen), walks.problem.robot.step_s
    # Before they are read: the longest races have millions of frames.
    _frames(step_s * (len(chosen.steps) - first))
    times_s, angles = _recorded(chosen, first, step_s)
    _check_finite(servo_map, times_s, angles)
    speeds = _speeds(servo_map, times_s, angles)
    slowed = times_slower(speeds) if slow_down else 1.0
    sampled_s = np.arange(_frames(times_s[-1] * slowed)) * FRAME_S / slowed
    sampled = np.column_stack([np.interp(sampled_s, times_s, joint) for joint in angles.T])
    pulses = np.column_stack(
        [servo.pulses_us(joint) for servo, joint in zip(servo_map.servos, sampled.T, strict=True)]
    )
    rounded = np.rint(pulses).astype(np.int32)
    _check_limits(servo_map, rounded)
    steps = chosen.steps[first].step, chosen.steps[-1].step
    return ServoWalk(servo_map, number, chosen.agent, steps, sampled, rounded, speeds, slowed)


def _frames(duration_s: float) -> int:
    """Return the number of frames, of which the last is at the end or after it.

    Raises:
        TooLong: if there are more than `MAX_FRAMES`.
    """
    # A hair less, so that a rounding error adds no frame.
    count = 1 + max(1, math.ceil(duration_s / FRAME_S - 1e-6))
    if count > MAX_FRAMES:
        raise TooLong(
            f"the walk would have {count:,} frames of {1000 * FRAME_S:g} ms, at most {MAX_FRAMES:,}"
            " can be had; choose a run with fewer steps"
        )
    return count


def _first_without_gap(lane: ExportedLane) -> int:
    """Return the index of the step from which on none is missing."""
    first = len(lane.steps) - 1
    # The steps of a race have no gap; they may be many, and in files.
    if lane.steps[0].step == lane.steps[first].step - first:
        return 0
    while lane.steps[first - 1].step == lane.steps[first].step - 1:
        first -= 1
    return first


def _recorded(lane: ExportedLane, first: int, step_s: float) -> tuple[FloatArray, FloatArray]:
    """Return the times of the recorded frames [s], and the angles of the joints [rad]."""
    times, poses = [np.zeros(1)], [lane.pose_before(first)[None]]
    for place, index in enumerate(range(first, len(lane.steps))):
        motion = lane.motion(index)
        times.append(place * step_s + motion.time_s.astype(float))
        poses.append(motion.qpos)
    return np.concatenate(times), np.concatenate(poses)[:, 7:].astype(float)


def _speeds(servo_map: ServoMap, times_s: FloatArray, angles: FloatArray) -> tuple[ServoSpeed, ...]:
    # Sampling interpolates between the recorded frames, so no sampled speed is higher.
    turned = np.rad2deg(np.abs(np.diff(angles, axis=0))) / np.diff(times_s)[:, None]
    fastest = turned.argmax(axis=0)
    share = servo_map.speed_share
    return tuple(
        ServoSpeed(
            servo,
            float(turned[frame, joint]),
            float(times_s[frame + 1]),
            None if servo.speed_deg_s is None else share * servo.speed_deg_s,
        )
        for joint, (servo, frame) in enumerate(zip(servo_map.servos, fastest, strict=True))
    )


def _check_finite(servo_map: ServoMap, times_s: FloatArray, angles: FloatArray) -> None:
    bad = ~np.isfinite(angles)
    if bad.any():
        frame, joint = (int(place[0]) for place in np.nonzero(bad))
        raise InvalidInput(
            f"the angle of {servo_map.servos[joint].joint} at {times_s[frame]:.2f} s is no number; "
            "choose a run whose simulation did not fail"
        )


def _check_limits(servo_map: ServoMap, pulses_us: NDArray[np.int32]) -> None:
    low, high = np.array([servo.limits_us for servo in servo_map.servos]).T
    beyond = np.maximum(low - pulses_us, pulses_us - high)
    if (beyond <= 0).all():
        return
    frame, joint = np.unravel_index(int(beyond.argmax()), beyond.shape)
    servo = servo_map.servos[joint]
    raise InvalidInput(
        f"{servo.title} would get {pulses_us[frame, joint]} µs at {frame * FRAME_S:.2f} s, outside "
        f"of its limits_us, {low[joint]:g} to {high[joint]:g}; correct its pulses in "
        f"{servo_map.name}, or choose a walk on a smaller grid"
    )
