"""Encode and decode a training's recording as arrays: steps in one file, evaluations in several.

Evaluations are many and immutable, so each of their files is written once, when it is full.
"""

from collections.abc import Iterable, Sequence
from itertools import accumulate
from typing import Any

import numpy as np

from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.runs.recording import Arrays, PracticeRecording
from hexapods.runs.records import ActionValues, Evaluated, StepTaken

_SCALARS = ("step", "episode", "epsilon", "reward_m", "distance_m")


def practice_arrays(recording: PracticeRecording) -> Arrays:
    """Encode the stored steps, and the number of evaluations so far; up to about 1 MB."""
    steps = recording.steps
    arrays: Arrays = {
        "rest_qpos": recording.rest_qpos,
        "evaluations": np.array(len(recording.evaluations)),
        "scalars": np.array([[getattr(s, n) for n in _SCALARS] for s in steps], float),
        "observation": np.array([s.observation for s in steps]),
        "action": np.array([s.action for s in steps]),
        "is_known": np.array([s.action_values is not None for s in steps]),
        **_motion_arrays([s.motion for s in steps]),
    }
    action_values = [s.action_values for s in steps if s.action_values]
    if action_values:
        arrays["values"] = np.array([k.values for k in action_values], np.float32)
        arrays["visits"] = np.array([k.visits for k in action_values], np.float32)
    return arrays


def evaluation_arrays(evaluations: Sequence[Evaluated]) -> Arrays:
    """Encode evaluations with their motion; about 0.1 MB each."""
    scalars = [(e.step, e.epsilon, e.distance_m) for e in evaluations]
    return {"scalars": np.array(scalars, float), **_motion_arrays([e.motion for e in evaluations])}


def practice_recording(
    arrays: Arrays, evaluations: Iterable[Arrays], *, is_whole: bool = True
) -> PracticeRecording:
    """Decode the output of `practice_arrays` and, in order, of `evaluation_arrays`.

    Args:
        arrays: of the steps.
        evaluations: of the evaluations, one file at a time.
        is_whole: whether all motions of evaluations are to be there, not only the newest.
    """
    recording = PracticeRecording(arrays["rest_qpos"])
    for step in _steps(arrays):
        recording.add(step)
    # Evaluation files are written separately, and may be newer than the file of steps.
    count = int(arrays["evaluations"])
    for file in evaluations:
        for evaluation in _evaluations(file)[: count - len(recording.evaluations)]:
            recording.add(evaluation)
        if not is_whole:
            recording.forget_motions(count)
    return recording


def rewound(recording: PracticeRecording, step: int) -> PracticeRecording:
    """Return the recording truncated after `step` steps, for a training that resumes there."""
    earlier = PracticeRecording(recording.rest_qpos)
    records: list[StepTaken | Evaluated] = [*recording.steps, *recording.evaluations]
    for record in records:
        if record.step <= step:
            earlier.add(record)
    return earlier


def _steps(arrays: Arrays) -> list[StepTaken]:
    motions = _motions(arrays)
    action_values = iter(_action_values(arrays))
    steps = []
    for number, row in enumerate(arrays["scalars"].tolist()):
        step, episode, epsilon, reward, distance = row
        steps.append(
            StepTaken(
                int(step),
                int(episode),
                epsilon,
                tuple(arrays["observation"][number].tolist()),
                Action(*arrays["action"][number].tolist()),
                reward,
                distance,
                motions[number],
                next(action_values) if arrays["is_known"][number] else None,
            )
        )
    return steps


def _action_values(arrays: Arrays) -> list[ActionValues]:
    if "values" not in arrays:
        return []
    tables = zip(arrays["values"].astype(float), arrays["visits"].astype(float), strict=True)
    return [ActionValues(values, visits) for values, visits in tables]


def _evaluations(arrays: Arrays) -> list[Evaluated]:
    rows = zip(arrays["scalars"].tolist(), _motions(arrays), strict=True)
    return [Evaluated(int(row[0]), row[1], row[2], motion) for row, motion in rows]


def _motion_arrays(motions: Sequence[Motion | None]) -> Arrays:
    """Concatenate motions, with the number of frames of each; 0 for a missing motion."""
    present = [motion for motion in motions if motion is not None]
    frames = [0 if motion is None else len(motion.time_s) for motion in motions]
    arrays: Arrays = {"frames": np.array(frames, int)}
    if present:
        arrays["time_s"] = np.concatenate([motion.time_s for motion in present])
        arrays["qpos"] = np.concatenate([motion.qpos for motion in present])
    return arrays


def _motions(arrays: Arrays) -> list[Motion | None]:
    frames: list[Any] = arrays["frames"].tolist()
    starts = accumulate(frames, initial=0)
    return [
        Motion(arrays["time_s"][start : start + count], arrays["qpos"][start : start + count])
        if count
        else None
        for start, count in zip(starts, frames, strict=False)
    ]
