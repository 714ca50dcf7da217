"""Which of our cases comes nearest to the numbers that the paper printed."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from app.domain.types import FloatArray
from app.experiments.claims.cases import PAPERS_AGENT, Case
from app.experiments.statistics import (
    CONFIDENCE,
    Interval,
    Points,
    Verdict,
    decided,
    interval,
    iqm,
    quantile_of,
)


class _Printed(NamedTuple):
    gait: str
    steps: int
    total_m: float
    points: Points


class Near(NamedTuple):
    """A case beside the printed total distances of Q-learning.

    Attributes:
        inside: how many of the printed values lie in the central 95 % of our seeds.
        of: how many there are.
        apart_m: from our middle to the printed value, averaged without sign.
    """

    case: Case
    inside: int
    of: int
    apart_m: float


def near(case: Case) -> Near | None:
    """How near a case comes; None if nothing was printed of it, or a setting has no trials."""
    printed = _printed(case)
    if not printed:
        return None
    tail = (1 - CONFIDENCE) / 2
    inside = sum(tail <= quantile_of(one.total_m, one.points) <= 1 - tail for one in printed)
    apart = _apart([np.asarray(one.points) for one in printed], printed, -1)
    return Near(case, inside, len(printed), float(apart))


def nearer(a: Case, b: Case) -> tuple[Verdict, Interval] | None:
    """Whether `a` comes nearer than `b`, and by how much [m]: yes, no, or not established.

    The interval is of our seeds only; that each printed value is one run it cannot know.
    """
    ours, others = _printed(a), _printed(b)
    if not ours or len(ours) != len(others):
        return None

    def by(*samples: FloatArray, axis: int = -1) -> FloatArray:
        mine, theirs = samples[: len(ours)], samples[len(ours) :]
        return _apart(theirs, others, axis) - _apart(mine, ours, axis)

    found = interval([one.points for one in (*ours, *others)], by, a.seed)
    return decided(found, 0, min(len(one.points) for one in (*ours, *others))), found


def _printed(case: Case) -> list[_Printed]:
    """Q-learning's settings that the paper has too, if all of them have trials."""
    learners = [one for one in case.settings if one["agent"] == PAPERS_AGENT and one["published"]]
    if not all(one["n"] for one in learners):
        return []
    return [
        _Printed(
            one["gait"], one["steps"], one["published"]["total_m"], tuple(one["total"]["points_m"])
        )
        for one in learners
    ]


def _apart(samples: Sequence[FloatArray], printed: Sequence[_Printed], axis: int) -> FloatArray:
    """The mean distance between a printed value and our middle [m]."""
    each = [
        np.abs(iqm(points, axis) - one.total_m)
        for points, one in zip(samples, printed, strict=True)
    ]
    return np.asarray(np.mean(each, axis=0), dtype=np.float64)
