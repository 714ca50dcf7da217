"""Scores of answers: against all seeds, by hand-computed figures."""

import pytest

from app.features.classroom.lesson import Card, read_lesson
from app.features.classroom.questions import Score, Scorer, WalkOutcome
from app.features.classroom.questions import scorer as scorer_of

OUTCOMES = [WalkOutcome(0.1 * n, curve=[(50, 0.0), (100, 0.1 * n)]) for n in range(1, 6)]
"""Distances 0.1 to 0.5 m; their interquartile mean is 0.3 m."""


def card(ask: dict[str, object], **fields: object) -> Card:
    question = {"text": "?", **ask}
    return read_lesson({"title": "x", "cards": [{"text": "", "ask": question, **fields}]}).cards[0]


def scorer(card: Card, outcomes: list[WalkOutcome]) -> Scorer:
    assert card.ask is not None
    return scorer_of(card.ask, card.revealed.answer, outcomes)


@pytest.mark.parametrize(("unit", "answer"), [("m", 0.2), (None, 0.2), ("cm", 20.0)])
def test_a_number_is_compared_with_all_distances(unit: str | None, answer: float) -> None:
    score = scorer(card({"kind": "number", "unit": unit}), OUTCOMES)(answer)
    assert score.quantile == pytest.approx(0.3)  # one below, and half of one that is equal
    assert score.error == pytest.approx(answer / 2)
    assert score.is_right is None


def test_a_number_of_another_unit_is_not_compared_with_distances() -> None:
    score = scorer(card({"kind": "number", "unit": "°"}), OUTCOMES)(20)
    assert score == Score()


def test_an_answer_of_the_lesson_decides() -> None:
    asks = card({"kind": "number"}, reveal={"answer": 16})
    assert scorer(asks, OUTCOMES)(16).is_right
    assert scorer(asks, OUTCOMES)(12) == Score(is_right=False, error=4)
    choice = card({"kind": "choice", "choices": ["a", "b"]}, reveal={"answer": "b"})
    assert [scorer(choice, [])(answer).is_right for answer in ("a", "b")] == [False, True]


def test_a_choice_among_agents_has_its_share_of_the_races() -> None:
    races = [("greedy",), ("greedy", "q-learning"), ("q-learning",), ("beam",)]
    score = scorer(
        card({"kind": "choice", "choices": ["greedy", "q-learning", "beam", "wave"]}),
        [WalkOutcome(0.1, winners) for winners in races],
    )
    shares = [score(agent).share for agent in ("greedy", "q-learning", "beam", "wave")]
    assert shares == [0.375, 0.375, 0.25, 0]


def test_points_and_curves_are_compared_with_the_mean_curve() -> None:
    point = scorer(card({"kind": "point"}), OUTCOMES)
    assert point([75, 0.15]).error == pytest.approx(0)
    assert point([100, 0.5]).error == pytest.approx(0.2)
    curve = scorer(card({"kind": "curve"}), OUTCOMES)
    assert curve([[50, 0.1], [100, 0.3]]).error == pytest.approx(0.05)
    assert curve([[0, 0]]).error == pytest.approx(0)


def test_without_a_run_there_is_no_score() -> None:
    for kind, answer in (("number", 1), ("point", [1, 2]), ("curve", [[0, 0], [1, 1]])):
        assert scorer(card({"kind": kind}), [])(answer) == Score()
