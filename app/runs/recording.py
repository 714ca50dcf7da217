"""Recordings: joint positions against time, and what was decided, from which all is drawn.

A recording grows while a run goes on, and is immutable in what it already holds. Live is its
tail, a replay is the same from its start.
"""

import json
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.domain.simulator import Motion
from app.domain.types import Action, FloatArray
from app.runs.records import ActionValues, Evaluated, LaneStep, StepTaken

Arrays = dict[str, NDArray[Any]]


@dataclass
class LaneRecording:
    """One lane of a race.

    Attributes:
        agent: the name of the lane's agent.
        rest_qpos: the pose on the start line, (7 + joints,).
        steps: all that were taken so far.
        failure: why the lane went no further, if it failed.
    """

    agent: str
    rest_qpos: NDArray[np.float32]
    steps: list[LaneStep] = field(default_factory=list)
    failure: str | None = None

    def start_qpos(self, step: int) -> NDArray[np.float32]:
        """The pose in which a step began; steps count from 0 here."""
        if step == 0:
            return self.rest_qpos
        last: NDArray[np.float32] = self.steps[step - 1].motion.qpos[-1]
        return last

    @property
    def distance_m(self) -> float:
        """How far it came so far."""
        return self.steps[-1].distance_m if self.steps else 0.0


FIRST_STEPS, NEWEST_STEPS = 20, 500


@dataclass
class PracticeRecording:
    """A training: its first steps, every evaluation, and its newest steps.

    One thread adds, others read; what is read is a copy, so they need no lock.

    Attributes:
        rest_qpos: the pose in which it began, (7 + joints,).
    """

    rest_qpos: NDArray[np.float32]
    _first: list[StepTaken] = field(default_factory=list)
    _newest: deque[StepTaken] = field(default_factory=lambda: deque(maxlen=NEWEST_STEPS))
    _evaluations: list[Evaluated] = field(default_factory=list)

    def add(self, record: StepTaken | Evaluated) -> None:
        """Take in the next step or evaluation."""
        if isinstance(record, Evaluated):
            self._evaluations.append(record)
        elif len(self._first) < FIRST_STEPS:
            self._first.append(record)
        else:
            self._newest.append(record)

    @property
    def steps(self) -> list[StepTaken]:
        """The steps that are kept, in order; after the first 20 some may be missing."""
        return [*self._first, *list(self._newest)]

    @property
    def evaluations(self) -> list[Evaluated]:
        """All evaluations so far, in order."""
        return list(self._evaluations)


def pose_at(start: NDArray[np.float32], motion: Motion, time_s: float) -> FloatArray:
    """The pose `time_s` into a motion that began from `start`, (7 + joints,)."""
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
    """A race's recording as arrays for a file: about 0.3 MB a minute and lane."""
    arrays: Arrays = {}
    meta = []
    for number, lane in enumerate(lanes):
        meta.append({"agent": lane.agent, "failure": lane.failure})
        key = f"lane{number}."
        arrays[key + "rest_qpos"] = lane.rest_qpos
        if not lane.steps:
            continue
        for name in ("time_s", "qpos"):
            arrays[key + name] = np.concatenate([getattr(s.motion, name) for s in lane.steps])
        arrays[key + "frames"] = np.array([len(s.motion.time_s) for s in lane.steps])
        arrays[key + "observation"] = np.array([s.observation for s in lane.steps])
        arrays[key + "action"] = np.array([s.action for s in lane.steps])
        scalars = ("reward_m", "distance_m", "transitions", "decision_s")
        table = [[getattr(s, name) for name in scalars] for s in lane.steps]
        arrays[key + "scalars"] = np.array(table, float)
        known = [s.knowledge for s in lane.steps if s.knowledge]
        if known:
            arrays[key + "values"] = np.array([k.values for k in known], np.float32)
            arrays[key + "visits"] = np.array([k.visits for k in known], np.float32)
    arrays["meta"] = np.array(json.dumps(meta))
    return arrays


def race_recording(arrays: Arrays) -> list[LaneRecording]:
    """The recording that `race_arrays` wrote."""
    lanes = []
    for number, about in enumerate(json.loads(str(arrays["meta"]))):
        key = f"lane{number}."
        lane = LaneRecording(about["agent"], arrays[key + "rest_qpos"], [], about["failure"])
        lanes.append(lane)
        if key + "frames" not in arrays:
            continue
        ends = list(accumulate(arrays[key + "frames"].tolist()))
        starts = [0, *ends[:-1]]
        for step, (start, end) in enumerate(zip(starts, ends, strict=True)):
            lane.steps.append(_lane_step(arrays, key, number, step, slice(start, end)))
    return lanes


def _lane_step(arrays: Arrays, key: str, lane: int, step: int, frames: slice) -> LaneStep:
    reward, distance, transitions, decision = arrays[key + "scalars"][step].tolist()
    knowledge = None
    if key + "values" in arrays:
        values, visits = (arrays[key + name][step].astype(float) for name in ("values", "visits"))
        knowledge = ActionValues(values, visits)
    return LaneStep(
        lane,
        step + 1,
        tuple(arrays[key + "observation"][step].tolist()),
        Action(*arrays[key + "action"][step].tolist()),
        reward,
        distance,
        int(transitions),
        decision,
        Motion(arrays[key + "time_s"][frames], arrays[key + "qpos"][frames]),
        knowledge,
    )
