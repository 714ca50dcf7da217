"""Export of a race's recording as streamed JSON."""

import json
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import LaneStep


def as_json(
    look: Callable[[], Sequence[LaneRecording]], training_ids: Sequence[str | None], steps: int
) -> Iterator[str]:
    """Yield the JSON document of a race in chunks, with all that a replay needs.

    Each step has its observation and action, and `qpos` (keyframes) at `time_s` [s] since its
    motion began.

    Args:
        look: returns the recording. Called for each chunk and not kept while a client receives
            that: recordings are large, and clients may be many and slow.
        training_ids: for each lane the training its table is from.
        steps: number of steps of each lane.
    """
    yield f'{{"steps": {steps}, "lanes": ['
    for number, training in enumerate(training_ids):
        yield (", " if number else "") + _head(look()[number], training)
        # The number of steps is fixed here; the race may append to the recording meanwhile.
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
    """Round to 1e-5 m and rad, which keeps the file short and is below what can be seen."""
    return np.round(array.astype(float), 5).tolist()
