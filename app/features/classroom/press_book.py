"""Presses of a class, added up by the step of the robot that its pupils saw."""

import threading
from typing import NamedTuple

from app.storage.errors import Conflict
from hexapods.domain.sums import ordered_sum

GRACE_STEPS = 0.5
"""Steps of the picture for which a press may come late, as over a poor network."""
EARLY_STEPS = 1.0
"""Steps by which the picture of a phone may be ahead of the server's."""


class ClassPress(NamedTuple):
    """What a class pressed during a step: the mean over those who pressed."""

    step: int
    """Number of the step, from 0."""
    at_step: float
    """Mean of the steps done in the picture when they pressed."""
    value: float
    """From −1 to 1: the mean of +1 and −1 over those who pressed."""
    plus: int
    minus: int


class PressBook:
    """Presses of the steps that are still open. Thread-safe.

    Each pupil counts once a step, with their last press. A step is closed when the picture is
    `GRACE_STEPS` behind its end: then its presses are added up, and later ones are refused.
    """

    def __init__(self, first: int = 0) -> None:
        """Begin.

        Args:
            first: number of steps that are closed already.
        """
        self._lock = threading.Lock()
        self._first = first
        self._steps: dict[int, dict[int, tuple[float, int]]] = {}

    def add(self, seed: int, at_step: float, value: int, shown: float) -> int:
        """Add a press of a pupil.

        Args:
            seed: seed of the pupil.
            at_step: steps done in the pupil's picture when it was pressed.
            value: 1 or −1.
            shown: steps done in the picture of the server now.

        Returns:
            number of the step.

        Raises:
            Conflict: if the step is over, or has not been shown yet.
        """
        step = int(at_step)
        with self._lock:
            if at_step > shown + EARLY_STEPS:
                raise Conflict("this step was not shown yet; press for what you see", "early")
            if step < max(self._first, int(shown - 1 - GRACE_STEPS)):
                raise Conflict("this step is over; press for what you see now", "late")
            self._steps.setdefault(step, {})[seed] = (at_step, value)
        return step

    def close(self, shown: float, seeds: set[int]) -> list[ClassPress]:
        """Close the steps that the picture has left, and return what the class pressed for them.

        Args:
            shown: steps done in the picture.
            seeds: pupils who count; others have left.
        """
        end = int(shown - GRACE_STEPS)
        with self._lock:
            closed = sorted(step for step in self._steps if step < end)
            presses = [(step, self._steps.pop(step)) for step in closed]
            self._first = max(self._first, end)
        counted = [(step, _of(by_seed, seeds)) for step, by_seed in presses]
        return [_mean(step, values) for step, values in counted if values]


def _of(by_seed: dict[int, tuple[float, int]], seeds: set[int]) -> list[tuple[float, int]]:
    return [press for seed, press in sorted(by_seed.items()) if seed in seeds]


def _mean(step: int, presses: list[tuple[float, int]]) -> ClassPress:
    count, plus = len(presses), sum(value > 0 for _, value in presses)  # whole numbers
    return ClassPress(
        step=step,
        at_step=round(ordered_sum(at_step for at_step, _ in presses) / count, 3),
        value=round((2 * plus - count) / count, 4),
        plus=plus,
        minus=count - plus,
    )
