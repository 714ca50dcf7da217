"""The tabular model: what it remembers, and which problems are too large for it."""

import numpy as np
import pytest

from hexapods.agents import tabular_model
from hexapods.agents.protocol import Problem
from hexapods.agents.registry import BUILT_IN, build, check_problem, find, learns
from hexapods.agents.tabular_model import TabularModel
from hexapods.domain.errors import InvalidInput
from hexapods.domain.grid import FootGrid
from tests.agents.by_hand import PROBLEM

SHAPE = {"shape": np.array([3, 5])}


def is_modelling(name: str) -> bool:
    return getattr(find(name), "check_problem", None) is tabular_model.check_problem


WITH_A_MODEL = [name for name in BUILT_IN if learns(name) and is_modelling(name)]


def remembered() -> TabularModel:
    model = TabularModel()
    model.learn(0, 1, 0.5, 7)
    model.learn(0, 1, 0.1, 8)
    model.learn(7, 3, 0.2, 0)
    model.learn(0, 1, 0.3, 7)
    model.imagine(7, 4)
    return model


def test_it_counts_what_followed_each_pair() -> None:
    first, second, imagined = remembered().pairs

    assert (first.tries, first.outcomes) == (3, {7: 2, 8: 1})
    assert first.mean_reward_m == pytest.approx(0.3)
    assert (first.last_reward_m, first.last_next, first.last_step) == (0.3, 7, 3)
    assert (second.tries, second.outcomes) == (1, {0: 1})
    assert (imagined.tries, imagined.last_next, imagined.mean_reward_m) == (0, 7, 0)


def test_it_knows_what_led_to_a_state() -> None:
    model = remembered()

    assert list(model.leading_to(8)) == [0]
    assert list(model.leading_to(0)) == [1]
    assert list(model.leading_to(3)) == []


def test_it_round_trips() -> None:
    model, copy = remembered(), TabularModel()
    TabularModel.check(model.dump() | SHAPE)
    copy.load(model.dump())

    assert (copy.steps, copy.pairs) == (model.steps, model.pairs)
    assert copy.number(7, 3) == 1
    assert sorted(copy.leading_to(7)) == [0]


@pytest.mark.parametrize(
    ("name", "row", "column", "value", "message"),
    [
        ("model_pairs", 0, 0, 125, "states that do not exist"),
        ("model_pairs", 0, 1, -1, "states that do not exist"),
        ("model_pairs", 0, 2, 4, "tries that differ from its outcomes"),
        ("model_pairs", 0, 3, 125, "to states that do not exist"),
        ("model_pairs", 0, 4, 9, "steps beyond its total"),
        ("model_outcomes", 0, 0, 3, "to states that do not exist"),
        ("model_outcomes", 0, 1, 125, "to states that do not exist"),
        ("model_outcomes", 0, 1, 8, "duplicate entries"),
        ("model_rewards", 0, 0, np.inf, "rewards that are not finite numbers"),
    ],
)
def test_an_invalid_model_is_refused(
    name: str, row: int, column: int, value: float, message: str
) -> None:
    state = remembered().dump() | SHAPE
    state[name][row, column] = value
    with pytest.raises(ValueError, match=message):
        TabularModel.check(state)


@pytest.mark.parametrize("name", WITH_A_MODEL)
def test_a_problem_that_is_too_large_is_refused_before_and_at_the_start(name: str) -> None:
    large = Problem(PROBLEM.groups, FootGrid(divisions=5).cells)
    sentence = "at most 300,000 .* 3 groups of legs on 25 cells have 1,171,875: choose fewer"
    with pytest.raises(InvalidInput, match=sentence):
        check_problem(name, large, {})
    with pytest.raises(InvalidInput, match=sentence):
        build(find(name), {"rng": np.random.default_rng(0), "problem": large})

    check_problem(name, Problem(PROBLEM.groups, FootGrid(divisions=4).cells), {})


def test_learners_without_a_model_take_any_problem() -> None:
    assert {"dyna-q", "dyna-q-plus", "prioritized-sweeping", "r-max"} < set(WITH_A_MODEL)
    check_problem("q-learning", Problem(PROBLEM.groups, FootGrid(divisions=8).cells), {})
