"""Recordings: joint positions over time, observations and actions, for live view and replay.

A recording is append-only. The live view shows its tail; a replay shows it from the start.
"""

import json
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate, islice, repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.agents.explanation import Future
from app.domain.simulator import Motion
from app.domain.types import Action, FloatArray
from app.runs.records import ActionValues, Evaluated, LaneStep, StepTaken

Arrays = dict[str, NDArray[Any]]
_STEP_OVERHEAD_BYTES = 1000
"""Approximate size of a step in memory besides its motion."""
_FUTURES = ("future_actions", "future_values", "future_counts")


@dataclass
class LaneRecording:
    """Recording of one lane of a race.

    Attributes:
        agent: name of the lane's agent.
        rest_qpos: pose on the start line, (7 + joints,): position [m], quaternion, angles [rad].
        steps: steps taken so far.
        failure: reason if the lane failed.
    """

    agent: str
    rest_qpos: NDArray[np.float32]
    steps: list[LaneStep] = field(default_factory=list)
    failure: str | None = None

    def start_qpos(self, step: int) -> NDArray[np.float32]:
        """Return the pose at the start of a step, (7 + joints,); steps are counted from 0 here."""
        if step == 0:
            return self.rest_qpos
        last: NDArray[np.float32] = self.steps[step - 1].motion.qpos[-1]
        return last

    @property
    def distance_m(self) -> float:
        """Distance covered so far [m]."""
        return self.steps[-1].distance_m if self.steps else 0.0

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        return sum(_size_of(step.motion, step.action_values) for step in self.steps)


FIRST_STEPS, NEWEST_STEPS = 20, 500


@dataclass
class PracticeRecording:
    """Recording of a training: its first and its newest steps (ring buffer), and all evaluations.

    One thread appends, others read; the properties return copies, so no lock is needed.

    Attributes:
        rest_qpos: pose at the start, (7 + joints,).
    """

    rest_qpos: NDArray[np.float32]
    _first: list[StepTaken] = field(default_factory=list)
    _newest: deque[StepTaken] = field(default_factory=lambda: deque(maxlen=NEWEST_STEPS))
    _evaluations: list[Evaluated] = field(default_factory=list)

    def add(self, record: StepTaken | Evaluated) -> None:
        """Append a step or an evaluation."""
        if isinstance(record, Evaluated):
            self._evaluations.append(record)
        elif len(self._first) < FIRST_STEPS:
            self._first.append(record)
        else:
            self._newest.append(record)

    @property
    def steps(self) -> list[StepTaken]:
        """The stored steps, in order; there may be a gap after the first `FIRST_STEPS`."""
        return [*self._first, *list(self._newest)]

    @property
    def evaluations(self) -> list[Evaluated]:
        """All evaluations so far, in order."""
        return list(self._evaluations)

    def without_evaluation_motions(self) -> "PracticeRecording":
        """Return a copy that knows of its evaluations only what they reached.

        It takes a fraction of the memory: an evaluation has the motion of 50 steps.
        """
        evaluations = [replace(one, motion=None) for one in self.evaluations]
        return PracticeRecording(self.rest_qpos, self._first[:], self._newest.copy(), evaluations)

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        steps = sum(_size_of(step.motion, step.action_values) for step in self.steps)
        return steps + sum(_size_of(one.motion) for one in self.evaluations)


def _size_of(motion: Motion | None, action_values: ActionValues | None = None) -> int:
    values = (action_values.values, action_values.visits) if action_values else ()
    arrays: tuple[NDArray[Any] | None, ...] = (*(motion or ()), *values)
    return _STEP_OVERHEAD_BYTES + sum(array.nbytes for array in arrays if array is not None)


def pose_at(start: NDArray[np.float32], motion: Motion, time_s: float) -> FloatArray:
    """Interpolate the pose at a time within a motion.

    Linear in position and angles; the quaternion is interpolated linearly and normalised (nlerp).

    Args:
        start: pose at the start of the motion, (7 + joints,).
        motion: the motion.
        time_s: time since its start [s], clamped to its duration.

    Returns:
        the pose, (7 + joints,).
    """
    times = np.concatenate(([0.0], motion.time_s))
    upper = min(int(np.searchsorted(times, time_s, side="left")), len(times) - 1)
    if upper == 0:
        return start.astype(float)
    lower = upper - 1
    before = start if lower == 0 else motion.qpos[lower - 1]
    share = (time_s - times[lower]) / (times[upper] - times[lower])
    blend = before + min(max(share, 0.0), 1.0) * (motion.qpos[upper - 1] - before)
    blend[3:7] /= np.sqrt((blend[3:7] * blend[3:7]).sum())
    pose: FloatArray = blend.astype(float)
    return pose


def race_arrays(lanes: Sequence[LaneRecording]) -> Arrays:
    """Encode a race's recording as arrays for a file: about 0.4 MB per minute and lane."""
    arrays: Arrays = {}
    meta = []
    for number, lane in enumerate(lanes):
        meta.append({"agent": lane.agent, "failure": lane.failure})
        key = f"lane{number}."
        arrays[key + "rest_qpos"] = lane.rest_qpos
        if not lane.steps:
            continue
        for name in Motion._fields:
            columns = [getattr(s.motion, name) for s in lane.steps]
            if all(column is not None for column in columns):
                arrays[key + name] = np.concatenate(columns)
        arrays[key + "frames"] = np.array([len(s.motion.time_s) for s in lane.steps])
        arrays[key + "observation"] = np.array([s.observation for s in lane.steps])
        arrays[key + "action"] = np.array([s.action for s in lane.steps])
        scalars = ("reward_m", "distance_m", "transitions", "decision_s")
        table = [[getattr(s, name) for name in scalars] for s in lane.steps]
        arrays[key + "scalars"] = np.array(table, float)
        action_values = [s.action_values for s in lane.steps if s.action_values]
        if action_values:
            arrays[key + "values"] = np.array([k.values for k in action_values], np.float32)
            arrays[key + "visits"] = np.array([k.visits for k in action_values], np.float32)
        arrays |= {key + name: array for name, array in _future_arrays(lane.steps).items()}
    arrays["meta"] = np.array(json.dumps(meta))
    return arrays


def _future_arrays(steps: Sequence[LaneStep]) -> Arrays:
    """Encode what a search found: the number of actions of each step, and one row an action."""
    found = [future for step in steps for future in step.futures]
    if not found:
        return {}
    return {
        "futures": np.array([len(step.futures) for step in steps]),
        "future_actions": np.array([one.action for one in found], np.uint8),
        "future_values": np.array([(one.reward_m, one.return_m) for one in found], float),
        "future_counts": np.array([(one.sequences, one.steps) for one in found], np.uint32),
    }


def _futures(arrays: Arrays, key: str) -> Iterator[tuple[Future, ...]]:
    """Decode the output of `_future_arrays`, step by step.

    Raises:
        ValueError: if it is inconsistent, as in an untrusted file.
    """
    counts: list[int] = arrays[key + "futures"].tolist()
    columns: list[list[Any]] = [arrays[key + name].tolist() for name in _FUTURES]
    if min(counts) < 0 or {len(column) for column in columns} != {sum(counts)}:
        raise ValueError("what its search found is of other steps")
    rows = zip(*columns, strict=True)
    for count in counts:
        yield tuple(
            Future(Action(*action), *values, *numbers)
            for action, values, numbers in islice(rows, count)
        )


def race_recording(arrays: Arrays) -> list[LaneRecording]:
    """Decode the output of `race_arrays`."""
    lanes = []
    for number, info in enumerate(json.loads(str(arrays["meta"]))):
        key = f"lane{number}."
        lane = LaneRecording(info["agent"], arrays[key + "rest_qpos"], [], info["failure"])
        lanes.append(lane)
        if key + "frames" not in arrays:
            continue
        ends = list(accumulate(arrays[key + "frames"].tolist()))
        starts = [0, *ends[:-1]]
        futures = _futures(arrays, key) if key + "futures" in arrays else repeat(())
        for step, (start, end) in enumerate(zip(starts, ends, strict=True)):
            taken = _lane_step(arrays, key, number, step, slice(start, end))
            lane.steps.append(replace(taken, futures=next(futures)))
    return lanes


def _lane_step(arrays: Arrays, key: str, lane: int, step: int, frames: slice) -> LaneStep:
    reward, distance, transitions, decision = arrays[key + "scalars"][step].tolist()
    action_values = None
    if key + "values" in arrays:
        values, visits = (arrays[key + name][step].astype(float) for name in ("values", "visits"))
        action_values = ActionValues(values, visits)
    return LaneStep(
        lane,
        step + 1,
        tuple(arrays[key + "observation"][step].tolist()),
        Action(*arrays[key + "action"][step].tolist()),
        reward,
        distance,
        int(transitions),
        decision,
        Motion(*(_column(arrays, key + name, frames) for name in Motion._fields)),
        action_values,
    )


def _column(arrays: Arrays, name: str, frames: slice) -> Any:
    """Return a part of an array; None if it was not recorded."""
    return arrays[name][frames] if name in arrays else None
