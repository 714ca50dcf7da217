"""Explanations: the rule with its numbers gives the stored value, to the last bit."""

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hexapods.agents.bayesian_regression import sum_rule
from hexapods.agents.derived_explanation import explain_choice, explain_update
from hexapods.agents.explanation import (
    ChoiceExplanation,
    Term,
    UpdateExplanation,
    ValueUpdate,
    copy_of,
    evaluate,
)
from hexapods.agents.fixed_policies import RandomWalk
from hexapods.agents.landing_table import LandingTable
from hexapods.agents.protocol import Tabular, Transition, Valuing
from hexapods.agents.q_table import QTable
from hexapods.agents.registry import BUILT_IN, find, learns, settings_of
from hexapods.agents.tabular import TabularLearner
from hexapods.agents.value_table import ValueTable
from hexapods.assembly import build_learner
from hexapods.domain.observation import legal_actions
from hexapods.domain.types import Action, Cells, FloatArray
from hexapods.runs.config import TrainingConfig, training_config
from hexapods.runs.tables import snapshot
from hexapods.runs.training import Learner, train
from tests.agents.by_hand import FIRST, PROBLEM, A, B, set_value, value
from tests.agents.by_hand import step as by_hand

AVERAGE = " by average"
"""Mark of a learner whose objective is the average reward."""
TEMPORAL = [name for name in BUILT_IN if "average_rate" in settings_of(find(name))]
TABLE_LEARNERS = [*TEMPORAL, *(name + AVERAGE for name in TEMPORAL)]
LEARNERS = [*(name for name in BUILT_IN if learns(name)), *(name + AVERAGE for name in TEMPORAL)]


def config_of(agent: str, seed: int = 4, steps: int = 90) -> TrainingConfig:
    average = {"objective": "average"} if agent.endswith(AVERAGE) else {}
    return training_config(
        agent.removesuffix(AVERAGE),
        settings=average,
        gait="left-right-origin",
        simulator="kinematic",
        steps=steps,
        seed=seed,
        evaluate_every=0,
    )


class ExplainedStep:
    """A step of a learner that explained its choice and its update, and what it stored before."""

    def __init__(self, learner: Learner) -> None:
        walker = learner.walker
        self.agent = walker.agent
        assert isinstance(self.agent, Valuing)
        self.table_before = table_of(learner)
        observation, legal = walker.observed, walker.legal
        chosen = learner.next_action
        self.choice: ChoiceExplanation | None = None
        if chosen is None:
            self.choice, chosen = self.choose(observation, legal)
        step = walker.carry_out(walker.legal_action(chosen))
        learner.next_action = None
        if getattr(self.agent, "is_on_policy", False):
            self.choice, learner.next_action = self.choose(walker.observed, walker.legal)
        self.transition = Transition(
            observation, chosen, step.reward_m, walker.observed, walker.legal, learner.next_action
        )
        update = explain_update(self.agent, self.transition)
        assert update is not None
        self.update: UpdateExplanation = update
        self.table_after = table_of(learner)
        learner.step += 1

    def choose(
        self, observation: Cells, legal: Sequence[Action]
    ) -> tuple[ChoiceExplanation, Action]:
        choice = explain_choice(self.agent, observation, legal)
        assert choice is not None
        return choice, choice.action

    @property
    def updates(self) -> list[ValueUpdate]:
        direct = [] if self.update.update is None else [self.update.update]
        return [*direct, *self.update.others]

    def stored(self, update: ValueUpdate) -> float:
        """Return what the learner stores now of the value that was updated."""
        assert isinstance(self.agent, Valuing)
        return float(self.agent.values(update.observation)[update.action])


def table_of(learner: Learner) -> FloatArray | None:
    """Return the values of a learner's table, a row a state or a landing."""
    agent = learner.walker.agent
    if not isinstance(agent, Tabular):
        return None
    assert isinstance(agent.table, QTable | LandingTable)
    return np.array([values for _, values, _ in agent.table.rows()])


def entry_of(table: ValueTable, place: tuple[Cells, Action]) -> tuple[int, ...]:
    """Return the index, in what `table_of` returns, of the value of an action in a state."""
    observation, action = place
    state, column = table.entry(table.index(observation), table.column(action))
    return (state,) if isinstance(table, LandingTable) else (state, *table.action_at(column))


@cache
def explained(agent: str) -> list[ExplainedStep]:
    """Return the steps of a training, which several tests look at."""
    config = config_of(agent)
    learner = build_learner(config)
    return [ExplainedStep(learner) for _ in range(config.steps)]


@pytest.fixture(params=LEARNERS)
def agent(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


@pytest.mark.test
def test_an_explained_training_is_the_training_to_the_last_bit(agent: str) -> None:
    config = config_of(agent)
    plain, explained_learner = build_learner(config), build_learner(config)
    for _ in train(plain, config):
        pass
    for _ in range(config.steps):
        ExplainedStep(explained_learner)

    arrays = snapshot(plain, config).arrays
    for name, array in snapshot(explained_learner, config).arrays.items():
        np.testing.assert_array_equal(array, arrays[name], name)


@pytest.mark.test
def test_every_rule_gives_the_value_after_it_to_the_last_bit(agent: str) -> None:
    for step in explained(agent):
        for update in step.updates:
            assert evaluate(update.rule, update.terms) == update.after, update
            assert update.is_exact


@pytest.mark.test
@pytest.mark.parametrize("name", [name for name in LEARNERS if name != "linear-model"])
@settings(max_examples=4, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_the_last_update_of_each_value_gives_what_is_stored(name: str, seed: int) -> None:
    """The values of the linear model are those of where the feet stand now."""
    learner = build_learner(config_of(name, seed))
    for _ in range(30):
        step = ExplainedStep(learner)
        last = {(update.observation, update.action): update for update in step.updates}
        for update in last.values():
            assert update.after == step.stored(update)
        if step.update.update is not None:
            assert step.update.stored == step.stored(step.update.update)


@pytest.mark.parametrize("name", TABLE_LEARNERS)
def test_every_value_that_changed_is_explained(name: str) -> None:
    changed = 0
    for step in explained(name):
        assert step.table_before is not None
        assert step.table_after is not None
        assert isinstance(step.agent, Tabular)
        before = {
            entry_of(step.agent.table, (update.observation, update.action)): update.before
            for update in reversed(step.updates)
        }
        is_changed = np.nan_to_num(step.table_after) != np.nan_to_num(step.table_before)
        for entry in np.argwhere(is_changed).tolist():
            assert before[tuple(entry)] == step.table_before[tuple(entry)]
            changed += 1
    assert changed > 20


def test_choices_are_explained_by_what_they_were_made_by(agent: str) -> None:
    kinds = set()
    for step in explained(agent):
        choice = step.choice
        if choice is None:
            continue
        kinds.add(choice.kind)
        assert (choice.action in choice.best) == (choice.margin is None or choice.margin >= 0)
        if choice.kind != "explored":
            assert choice.action in choice.best
        if choice.draw is not None:
            assert choice.epsilon is not None
            assert (choice.draw < choice.epsilon) == (choice.kind == "explored")
        assert 0 < choice.probability <= 1
    assert kinds & {"exploited", "unknown"}


class FirstNextValue(TabularLearner):
    """A learner of another package: it values the first legal action of the next state."""

    next_meaning = "value of the first action there"

    def _next_value(self, transition: Transition) -> float:
        return self.table.values_of(transition.next_observation, transition.next_legal)[0]


class Forgetful(TabularLearner):
    """A learner whose own update rule changes no value."""

    def _update(self, transition: Transition, state: int, column: int) -> None:
        pass


def test_a_learner_that_implements_its_next_value_is_explained() -> None:
    agent = FirstNextValue(np.random.default_rng(0), PROBLEM, alpha=0.5, gamma=0.9)
    set_value(agent, B, legal_actions(B, 5)[0], 0.04)
    table = agent.table
    explained = explain_update(agent, by_hand(A, FIRST, 0.02, B))

    assert explained is not None
    assert explained.update is not None
    assert explained.update.numbers == "(1 − 0.5) · 0 + 0.5 · (0.02 + 0.9 · 0.04)"
    assert [term.meaning for term in explained.update.terms][
        -1
    ] == "value of the first action there"
    assert evaluate(explained.update.rule, explained.update.terms) == value(agent, A, FIRST)
    assert agent.table is table


def test_a_step_that_changes_no_value_is_explained_as_one() -> None:
    explained = explain_update(
        Forgetful(np.random.default_rng(0), PROBLEM), by_hand(A, FIRST, 0.02, B)
    )

    assert explained is not None
    assert explained.update is None
    assert explained.summary == "No value changes."


def test_a_learner_that_fails_keeps_its_table() -> None:
    agent = FirstNextValue(np.random.default_rng(0), PROBLEM)
    table = agent.table
    with pytest.raises(IndexError):
        explain_update(agent, by_hand(A, FIRST, 0.02, B)._replace(next_legal=[]))

    assert agent.table is table


def test_agents_without_explanations_act_and_learn_as_they_do() -> None:
    walk = RandomWalk(np.random.default_rng(0))

    assert explain_choice(walk, A, legal_actions(A, 5)) is None
    assert explain_update(walk, by_hand(A, FIRST, 0.02, B)) is None


def test_probability_of_a_choice_counts_chance_and_ties() -> None:
    scores = np.array([[np.nan, 2.0, 1.0], [2.0, np.nan, 0.5]])
    choice = ChoiceExplanation(Action(0, 1), "exploited", "value", scores, 0.2, 0.7)

    assert choice.best == [Action(0, 1), Action(1, 0)]
    assert choice.runner_up == Action(1, 0)
    assert choice.margin == 0
    assert choice.probability == pytest.approx(0.2 / 4 + 0.8 / 2)


def test_rules_are_arithmetic_and_nothing_else() -> None:
    terms = [Term("Q", -0.5, ""), Term("Q′", 2.0, ""), Term("γ", 0.9, "")]

    assert evaluate("(1 − γ) · Q + Q′ / 4", terms) == (1 - 0.9) * -0.5 + 2.0 / 4
    for rule in ("Q + δ", "Q ** 2", "len(Q)", "Q +"):
        with pytest.raises(ValueError, match="no arithmetic"):
            evaluate(rule, terms)


def test_numbers_are_put_into_the_rule() -> None:
    terms = (Term("Q", -0.5, ""), Term("α", 0.25, ""), Term("Q′", 1.23456789, ""))
    update = ValueUpdate((0,), Action(0, 1), "(1 − α) · Q + α · Q′", terms, -0.5, 0.0)

    assert update.numbers == "(1 − 0.25) · (−0.5) + 0.25 · 1.235"
    small = update._replace(rule="Q", terms=(Term("Q", -1.5e-12, ""),))
    assert small.numbers == "(−1.5 · 10⁻¹²)"


@settings(deadline=None)
@given(st.integers(1, 300), st.data())
def test_sum_rule_adds_as_numpy_does(count: int, data: st.DataObject) -> None:
    """The rule of the linear model relies on the order in which NumPy adds."""
    nonzero = st.dictionaries(
        st.integers(0, count - 1), st.floats(-1, 1).filter(bool), min_size=1, max_size=9
    )
    values = data.draw(nonzero)
    row = np.zeros((1, count))
    row[0, list(values)] = list(values.values())
    terms = [Term(f"<{index}>", value, "") for index, value in values.items()]
    rule = sum_rule({index: f"<{index}>" for index in values}, count)

    assert evaluate(rule, terms) == row.sum(1)[0]


def test_a_copy_of_a_generator_draws_the_same_and_leaves_it_alone() -> None:
    rng = np.random.default_rng(3)
    seen = copy_of(rng).random(4)

    np.testing.assert_array_equal(rng.random(4), seen)
