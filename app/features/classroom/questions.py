"""Questions of cards: a class for each kind checks answers, and scores them against all seeds.

To add a kind: its name in `Kind`, and a class in `_TYPES`; on the page an entry in
`static/features/classroom/room/questions.js`.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from annotated_types import MaxLen
from pydantic import Field

from app.features.classroom.markdown import Markdown, Title, check_line, check_markdown
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.records import Record
from hexapods.domain.sums import ordered_sum
from hexapods.experiments.statistics import iqm, quantile_of

MAX_CHOICES = 20
MAX_POINTS = 200
"""Points of a drawn curve."""
_MOST = 1e9
_METRES = {"m": 1.0, "cm": 0.01}
"""Metres in each unit in which a distance may be asked; without a unit it is in metres."""
Number = Annotated[float, Field(allow_inf_nan=False)]
Kind = Literal["choice", "number", "point", "curve"]
Curve = Sequence[tuple[float, float]]
"""A learning curve: (step, distance [m]) by step."""


@dataclass(frozen=True, kw_only=True)
class Ask(Record):
    """A question, to which each participant gives one answer before the reveal.

    Attributes:
        kind: of answer: a text of the choices, a number, a point [x, y] on a chart, or a curve, a
            list of points.
        text: the question, in Markdown.
        choices: of which one is the answer, of kind `choice` alone; a name of an agent stands for
            the race that it wins.
        minimum, maximum: between which a number is.
        unit: of the number; `m` and `cm` are compared with distances.
    """

    kind: Kind
    text: Markdown
    choices: Annotated[tuple[Title, ...], MaxLen(MAX_CHOICES)] = ()
    minimum: Number | None = None
    maximum: Number | None = None
    unit: Annotated[str, MaxLen(20)] | None = None


@dataclass(frozen=True, kw_only=True)
class KnowledgeQuestion(Ask):
    """A question about what a lesson teaches, which is asked before it and after it.

    Attributes:
        right: the right answer: one of the choices, or a number.
    """

    right: Number | Title

    @property
    def ask(self) -> Ask:
        """The question without its answer."""
        return Ask(**{name: getattr(self, name) for name in Ask.__dataclass_fields__})


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


@dataclass(frozen=True, kw_only=True)
class Score(Record):
    """Score of an answer against all seeds; null where that does not apply.

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


Scorer = Callable[[Any], Score]


class QuestionType:
    """Base class of the kinds of questions; a question of it has any answer, and no score.

    Attributes:
        kind: its name.
        fields: fields of a question that this kind has, and not all kinds.
    """

    kind: ClassVar[Kind]
    fields: ClassVar[frozenset[str]] = frozenset()

    def check(self, ask: Ask, where: str) -> None:
        """Check a question of the kind.

        Raises:
            InvalidInput: if its fields cannot be so; the message names them below `where`.
        """

    def check_right(self, ask: Ask, answer: float | str, where: str) -> None:
        """Check the answer that a lesson gives as the right one.

        Raises:
            InvalidInput: if it is none; the message names its field below `where`.
        """

    def check_answer(self, ask: Ask, value: Any) -> Any:
        """Return an answer as it is kept.

        Raises:
            InvalidInput: if it is no answer to the question; the message names what is.
        """
        del ask
        return value

    def scorer(
        self, ask: Ask, right: float | str | None, outcomes: Sequence[WalkOutcome]
    ) -> Scorer:
        """Return the function that scores an answer.

        Args:
            ask: the question.
            right: the answer that the lesson gives; None where it follows from the runs.
            outcomes: of all participants whose run has finished.
        """
        del ask, right, outcomes
        return lambda value: Score()  # noqa: ARG005


class Choice(QuestionType):
    """One of several texts, which may be names of agents that race."""

    kind = "choice"
    fields = frozenset({"choices"})

    def check(self, ask: Ask, where: str) -> None:
        for number, choice in enumerate(ask.choices):
            check_line(f"{where}.choices.{number}", choice)
        if len(set(ask.choices)) < max(2, len(ask.choices)):
            raise InvalidInput(
                f"{where}.choices must be a list of 2 to {MAX_CHOICES} different texts"
            )

    def check_right(self, ask: Ask, answer: float | str, where: str) -> None:
        if answer not in ask.choices:
            raise UnknownName(f"answer of {where}", answer, ask.choices)

    def check_answer(self, ask: Ask, value: Any) -> str:
        if not isinstance(value, str) or value not in ask.choices:
            raise UnknownName("answer", value if isinstance(value, str) else "", ask.choices)
        return value

    def scorer(
        self, ask: Ask, right: float | str | None, outcomes: Sequence[WalkOutcome]
    ) -> Scorer:
        del ask
        races = [outcome.winners for outcome in outcomes if outcome.winners]

        def score(value: Any) -> Score:
            won = [1 / len(winners) if value in winners else 0.0 for winners in races]
            # If no race has an agent of this name, the choices are not agents.
            return Score(
                is_right=None if right is None else value == right,
                share=ordered_sum(won) / len(won) if any(won) or (won and right is None) else None,
            )

        return score


class NumberType(QuestionType):
    """A number, which is compared with the distances of all seeds if it is one."""

    kind = "number"
    fields = frozenset({"minimum", "maximum"})

    def check(self, ask: Ask, where: str) -> None:
        low, high = ask.minimum, ask.maximum
        if low is not None and high is not None and low >= high:
            raise InvalidInput(f"{where}.minimum must be less than its maximum, {high:g}")

    def check_right(self, ask: Ask, answer: float | str, where: str) -> None:
        del ask
        if isinstance(answer, str):
            raise InvalidInput(f"{where}.answer must be a number, as the question asks one")

    def check_answer(self, ask: Ask, value: Any) -> float:
        low = -_MOST if ask.minimum is None else ask.minimum
        high = _MOST if ask.maximum is None else ask.maximum
        if not _is_number(value) or not low <= value <= high:
            raise InvalidInput(f"the answer must be a number from {low:g} to {high:g}")
        return float(value)

    def scorer(
        self, ask: Ask, right: float | str | None, outcomes: Sequence[WalkOutcome]
    ) -> Scorer:
        if isinstance(right, int | float):
            return lambda value: Score(is_right=value == right, error=abs(value - right))
        metres = _METRES.get(ask.unit or "m")
        distances = [outcome.distance_m for outcome in outcomes if outcome.distance_m is not None]
        if metres is None or not distances:
            return super().scorer(ask, right, outcomes)
        mean_m = float(iqm(np.array(distances)))
        return lambda value: Score(
            quantile=quantile_of(value * metres, distances), error=abs(value - mean_m / metres)
        )


class _ChartType(QuestionType):
    """Points of distance over the steps of a practice, which are compared with the mean curve."""

    def scorer(
        self, ask: Ask, right: float | str | None, outcomes: Sequence[WalkOutcome]
    ) -> Scorer:
        means = _mean_curve([outcome.curve for outcome in outcomes if outcome.curve])
        if not means:
            return super().scorer(ask, right, outcomes)
        steps, distances = list(means), list(means.values())

        def score(value: Any) -> Score:
            points = self._points(value)
            errors = [abs(y - float(np.interp(x, steps, distances))) for x, y in points]
            return Score(error=ordered_sum(errors) / len(errors))

        return score

    def _points(self, value: Any) -> Sequence[Sequence[float]]:
        """Return the points of an answer."""
        raise NotImplementedError


class PointType(_ChartType):
    """A point on the chart."""

    kind = "point"

    def check_answer(self, ask: Ask, value: Any) -> list[float]:
        del ask
        return _point(value, "a point is [x, y], two numbers")

    def _points(self, value: Any) -> Sequence[Sequence[float]]:
        return [value]


class CurveType(_ChartType):
    """A curve that is drawn on the chart."""

    kind = "curve"

    def check_answer(self, ask: Ask, value: Any) -> list[list[float]]:
        del ask
        valid = f"a curve is a list of 2 to {MAX_POINTS} points [x, y], from left to right"
        if not isinstance(value, list) or not 2 <= len(value) <= MAX_POINTS:
            raise InvalidInput(valid)
        points = [_point(point, valid) for point in value]
        if any(after[0] <= before[0] for before, after in pairwise(points)):
            raise InvalidInput(valid)
        return points

    def _points(self, value: Any) -> Sequence[Sequence[float]]:
        points: Sequence[Sequence[float]] = value
        return points


_TYPES: Mapping[str, QuestionType] = {
    question.kind: question for question in (Choice(), NumberType(), PointType(), CurveType())
}


def check_question(ask: Ask, where: str) -> None:
    """Check a question.

    Raises:
        InvalidInput: naming the field below `where`, and what is valid.
    """
    check_markdown(ask.text, f"{where}.text")
    for kind, question_type in _TYPES.items():
        for field in question_type.fields - _TYPES[ask.kind].fields:
            if getattr(ask, field) not in (None, ()):
                raise InvalidInput(
                    f"{where}.{field} is for questions of the kind {kind} alone, not of {ask.kind}"
                )
    _TYPES[ask.kind].check(ask, where)


def check_knowledge(question: KnowledgeQuestion, where: str) -> None:
    """Check a question about what a lesson teaches; errors as `check_question`."""
    if question.kind not in ("choice", "number"):
        raise InvalidInput(
            f"{where}.kind must be choice or number, which have one right answer, not "
            f"{question.kind}"
        )
    check_question(question, where)
    if question.kind == "choice" and not isinstance(question.right, str):
        raise UnknownName(f"right of {where}", str(question.right), question.choices)
    check_right(question, question.right, where)


def check_right(ask: Ask, answer: float | str, where: str) -> None:
    """Check the answer that a lesson gives as the right one; see `QuestionType`."""
    _TYPES[ask.kind].check_right(ask, answer, where)


def check_answer(ask: Ask, value: Any) -> Any:
    """Return an answer to a question as it is kept; see `QuestionType`."""
    return _TYPES[ask.kind].check_answer(ask, value)


def scorer(ask: Ask, right: float | str | None, outcomes: Sequence[WalkOutcome]) -> Scorer:
    """Return the function that scores an answer to a question; see `QuestionType`."""
    return _TYPES[ask.kind].scorer(ask, right, outcomes)


def _point(value: Any, valid: str) -> list[float]:
    is_point = isinstance(value, list) and len(value) == 2
    if not is_point or not all(
        _is_number(coordinate) and abs(coordinate) <= _MOST for coordinate in value
    ):
        raise InvalidInput(valid)
    return [float(value[0]), float(value[1])]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _mean_curve(curves: Sequence[Curve]) -> Mapping[float, float]:
    """Return the interquartile mean of several curves, at the steps that all have."""
    by_step = [dict(curve) for curve in curves]
    steps = set.intersection(*(set(curve) for curve in by_step)) if by_step else set()
    return {
        step: float(iqm(np.array([curve[step] for curve in by_step]))) for step in sorted(steps)
    }
