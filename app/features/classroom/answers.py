"""Checks answers to the questions of cards, and scores them against all seeds, not against one."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from app.features.classroom.lesson import Ask, Card
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.sums import ordered_sum

MAX_POINTS = 200
"""Points of a drawn curve."""
_MOST = 1e9
_METRES = {"m": 1.0, "cm": 0.01}
"""Of the units in which a distance may be asked; without a unit it is in metres."""
Curve = Sequence[tuple[float, float]]
"""A learning curve: (step, distance [m]) by step."""


class WalkOutcome(NamedTuple):
    """Outcome of a participant's run.

    Attributes:
        distance_m: how far the robot walked [m]; of a race that of the learner, at time-out.
        winners: agents of the lanes that won a race; several if they are level.
        curve: of a training.
    """

    distance_m: float | None
    winners: tuple[str, ...] = ()
    curve: Curve = ()


class Score(NamedTuple):
    """How an answer compares with all seeds; what does not apply is None.

    Attributes:
        is_right: whether it is the answer that the lesson gives.
        share: of races, the share of seeds in which the chosen agent won (a draw counts in part).
        quantile: share of the seeds below the number; one that is equal counts half.
        error: absolute difference from the answer of the lesson, or else from the interquartile
            mean, in the unit of the question; of a point or a curve the mean over its points [m].
    """

    is_right: bool | None = None
    share: float | None = None
    quantile: float | None = None
    error: float | None = None


def check_answer(ask: Ask, value: Any) -> Any:
    """Return an answer as it is kept.

    Raises:
        InvalidInput: if it is no answer to the question; the message names what is.
    """
    if ask.kind == "choice":
        if not isinstance(value, str) or value not in ask.choices:
            raise UnknownName("answer", value if isinstance(value, str) else "", ask.choices)
        return value
    if ask.kind == "number":
        return _number(value, ask)
    if ask.kind == "point":
        return list(_point(value, "a point is [x, y], two numbers"))
    valid = f"a curve is a list of 2 to {MAX_POINTS} points [x, y], from left to right"
    if not isinstance(value, list) or not 2 <= len(value) <= MAX_POINTS:
        raise InvalidInput(valid)
    points = [_point(one, valid) for one in value]
    if any(after[0] <= before[0] for before, after in pairwise(points)):
        raise InvalidInput(valid)
    return [list(one) for one in points]


def scorer(card: Card, outcomes: Sequence[WalkOutcome]) -> Callable[[Any], Score]:
    """Return the function that scores an answer to the question of a card.

    Args:
        card: with a question.
        outcomes: of all participants whose run has finished.
    """
    ask, answer = card.ask, card.revealed.answer
    if ask is None:
        return lambda value: Score()  # noqa: ARG005
    if ask.kind == "choice":
        return lambda value: _choice_score(value, answer, outcomes)
    if ask.kind == "number":
        return lambda value: _number_score(value, answer, _METRES.get(ask.unit or "m"), outcomes)
    means = _mean_curve([one.curve for one in outcomes if one.curve])
    return lambda value: _curve_score([value] if ask.kind == "point" else value, means)


def _number(value: Any, ask: Ask) -> float:
    low = -_MOST if ask.minimum is None else ask.minimum
    high = _MOST if ask.maximum is None else ask.maximum
    if not _is_number(value) or not low <= value <= high:
        raise InvalidInput(f"the answer must be a number from {low:g} to {high:g}")
    return float(value)


def _point(value: Any, valid: str) -> tuple[float, float]:
    is_point = isinstance(value, list) and len(value) == 2
    if not is_point or not all(_is_number(one) and abs(one) <= _MOST for one in value):
        raise InvalidInput(valid)
    return float(value[0]), float(value[1])


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _choice_score(value: Any, answer: Any, outcomes: Sequence[WalkOutcome]) -> Score:
    races = [one.winners for one in outcomes if one.winners]
    won = [1 / len(winners) if value in winners else 0.0 for winners in races]
    # Where no race has an agent of this name, the choices are no agents.
    return Score(
        is_right=None if answer is None else value == answer,
        share=ordered_sum(won) / len(won) if any(won) or (won and answer is None) else None,
    )


def _number_score(
    value: float, answer: Any, metres: float | None, outcomes: Sequence[WalkOutcome]
) -> Score:
    if isinstance(answer, int | float):
        return Score(is_right=value == answer, error=abs(value - answer))
    distances = [one.distance_m for one in outcomes if one.distance_m is not None]
    if metres is None or not distances:
        return Score()
    # SciPy, which it imports, takes a second, and most servers score no answers.
    from hexapods.experiments.statistics import iqm, quantile_of  # noqa: PLC0415

    mean_m = float(iqm(np.array(distances)))
    return Score(
        quantile=quantile_of(value * metres, distances), error=abs(value - mean_m / metres)
    )


def _mean_curve(curves: Sequence[Curve]) -> Mapping[float, float]:
    """Return the interquartile mean of several curves, at the steps that all have."""
    from hexapods.experiments.statistics import iqm  # noqa: PLC0415 - as above

    by_step = [dict(curve) for curve in curves]
    steps = set.intersection(*(set(one) for one in by_step)) if by_step else set()
    return {step: float(iqm(np.array([one[step] for one in by_step]))) for step in sorted(steps)}


def _curve_score(points: Sequence[Sequence[float]], means: Mapping[float, float]) -> Score:
    if not means:
        return Score()
    steps, distances = list(means), list(means.values())
    errors = [abs(y - float(np.interp(x, steps, distances))) for x, y in points]
    return Score(error=ordered_sum(errors) / len(errors))
