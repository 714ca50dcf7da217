"""A race's recording in the forms that leave the server."""

import json
from collections.abc import Iterator, Sequence

import numpy as np

from app.runs.recording import LaneRecording
from app.runs.records import LaneStep


def as_json(
    lanes: Sequence[LaneRecording], training_ids: Sequence[str | None], steps: int
) -> Iterator[str]:
    """All that a replay needs, in chunks.

    Of each step: what was seen and done, and `qpos` at the times `time_s` since its motion began.
    """
    yield f'{{"steps": {steps}, "lanes": ['
    for number, (lane, training) in enumerate(zip(lanes, training_ids, strict=True)):
        head = {
            "agent": lane.agent,
            "training_id": training,
            "failure": lane.failure,
            "rest_qpos": _rounded(lane.rest_qpos),
        }
        yield (", " if number else "") + json.dumps(head)[:-1] + ', "steps": ['
        for place, step in enumerate(list(lane.steps)):
            yield (",\n" if place else "") + json.dumps(_step(step))
        yield "]}"
    yield "]}\n"


def _step(step: LaneStep) -> dict[str, object]:
    return {
        "step": step.step,
        "observation": step.observation,
        "action": step.action,
        "reward_m": step.reward_m,
        "distance_m": step.distance_m,
        "transitions": step.transitions,
        "decision_s": step.decision_s,
        "time_s": _rounded(step.motion.time_s),
        "qpos": _rounded(step.motion.qpos),
    }


def _rounded(array: np.ndarray[tuple[int, ...], np.dtype[np.float32]]) -> object:
    """To a hundredth of a millimetre and of a milliradian: shorter, and no eye sees more."""
    return np.round(array.astype(float), 5).tolist()
