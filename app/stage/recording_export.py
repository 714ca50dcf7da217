"""A race's recording in the forms that leave the server."""

import json
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from app.runs.recording import LaneRecording
from app.runs.records import LaneStep


def as_json(
    look: Callable[[], Sequence[LaneRecording]], training_ids: Sequence[str | None], steps: int
) -> Iterator[str]:
    """All that a replay needs, in chunks.

    Of each step: what was seen and done, and `qpos` at the times `time_s` since its motion began.

    Args:
        look: the recording. It is asked for anew for each chunk, and not held while a client
            takes that: recordings are large, and readers may be many and slow.
        training_ids: for each lane where its table is from.
        steps: that each lane is to take.
    """
    yield f'{{"steps": {steps}, "lanes": ['
    for number, training in enumerate(training_ids):
        yield (", " if number else "") + _head(look()[number], training)
        # Others may add to the recording meanwhile.
        for place in range(len(look()[number].steps)):
            yield (",\n" if place else "") + json.dumps(_step(look()[number].steps[place]))
        yield "]}"
    yield "]}\n"


def _head(lane: LaneRecording, training_id: str | None) -> str:
    head = {
        "agent": lane.agent,
        "training_id": training_id,
        "failure": lane.failure,
        "rest_qpos": _rounded(lane.rest_qpos),
    }
    return json.dumps(head)[:-1] + ', "steps": ['


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
