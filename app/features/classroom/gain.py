"""What a class gains by a lesson: answers to the same question before and after it, paired."""

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np

from app.answer import Answer, Count
from app.features.classroom.questions import scorer
from app.features.classroom.room import Room
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import FloatArray
from hexapods.experiments.statistics import interval

_SEED_OF_INTERVAL = 0


class GainView(Answer):
    """The gain of a class, over the participants who have answered before and after the lesson.

    Attributes:
        pairs: number of these participants.
        right_before, right_after: number of them who were right.
        gain: share who were right after the lesson, less the share before it.
        low, high: its 95 % interval, a bootstrap over participants; null below three.
    """

    pairs: Count
    right_before: Count
    right_after: Count
    gain: float
    low: float | None
    high: float | None


class Knowledge(NamedTuple):
    """Whether a participant was right before the lesson and after it; None without an answer."""

    before: bool | None
    after: bool | None

    @property
    def gain(self) -> Literal[-1, 0, 1] | None:
        """1 if it was learned, -1 if it was lost, else 0; None unless both are answered."""
        if self.before is None or self.after is None:
            return None
        if self.before == self.after:
            return 0
        return 1 if self.after else -1


def knowledge_in(room: Room) -> Mapping[int, Knowledge]:
    """Return by seed what the participants of a room knew; empty if its lesson asks nothing."""
    if room.knowledge_cards is None or room.lesson.before is None:
        return {}
    before, after = room.knowledge_cards
    asked = {before: room.lesson.before, after: room.lesson.after or room.lesson.before}
    right = {card: scorer(question.ask, question.right, ()) for card, question in asked.items()}

    def knew(seed: int, card: int) -> bool | None:
        value = room.predictions.get((seed, card))
        return None if value is None else right[card](value).is_right

    return {seed: Knowledge(knew(seed, before), knew(seed, after)) for seed in room.participants}


def class_gain(knowledge: Mapping[int, Knowledge]) -> GainView | None:
    """Return the gain over all participants who have answered both questions; None without any."""
    pairs = [known for known in knowledge.values() if known.gain is not None]
    if not pairs:
        return None
    before, after = (sum(map(bool, side)) for side in zip(*pairs, strict=True))  # whole numbers
    gains = tuple(float(known.gain or 0) for known in pairs)
    gain = interval((gains,), _mean, _SEED_OF_INTERVAL)
    return GainView(
        pairs=len(pairs),
        right_before=before,
        right_after=after,
        gain=ordered_sum(gains) / len(gains),
        low=gain.low,
        high=gain.high,
    )


def _mean(samples: FloatArray, axis: int = -1) -> FloatArray:
    return np.asarray(samples.mean(axis=axis), dtype=np.float64)
