"""Explains learners with a Q-table from the outside: what they know before and after `learn`.

Each write to the table is seen before it is made, so that the terms of a rule are read from the
table, the model or the traces from which the learner computes the new value.

Learners that plan (`ModelAgent`, `MultilevelModel`) or predict (`LinearModel`) have no update rule
of a stored value: their values follow from a plan or from weights that only they keep. They explain
themselves, by comparing these before and after `learn`, which records nothing.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from typing import Any, Generic, TypeVar, cast

from hexapods.agents.double_q import DoubleQ
from hexapods.agents.dyna_q import DynaQ
from hexapods.agents.expected_sarsa import ExpectedSarsa
from hexapods.agents.explanation import (
    Belief,
    ChoiceExplanation,
    Explaining,
    Rule,
    Term,
    UpdateExplanation,
    ValueUpdate,
    copy_of,
    in_millimetres,
)
from hexapods.agents.n_step_sarsa import NStepSarsa
from hexapods.agents.prioritized_sweeping import PrioritizedSweeping
from hexapods.agents.protocol import Agent, Transition
from hexapods.agents.tabular import TabularLearner
from hexapods.agents.traces import TraceLearner
from hexapods.agents.value_table import ValueTable
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import Action, Cells

Learner = TypeVar("Learner", bound=TabularLearner)


def explain_choice(
    agent: Agent, observation: Cells, legal: Sequence[Action]
) -> ChoiceExplanation | None:
    """Let an agent choose an action, and explain the choice.

    Args:
        agent: chooses as by `act`.
        observation: the present state.
        legal: actions that are allowed there.

    Returns:
        the explanation with the action; None, without a choice, for an agent without explanations.
    """
    if isinstance(agent, Explaining):
        return agent.explain_choice(observation, legal)
    if not isinstance(agent, TabularLearner):
        return None
    epsilon = agent.epsilon
    draw = float(copy_of(agent._rng).random()) if epsilon > 0 else None
    scores = agent.values(observation)
    return ChoiceExplanation(
        agent.act(observation, legal),
        "exploited" if draw is None or draw >= epsilon else "explored",
        "value in the table",
        scores,
        epsilon,
        draw,
    )


def explain_update(agent: Agent, transition: Transition) -> UpdateExplanation | None:
    """Let an agent learn from a transition, and explain how its values change.

    Returns:
        the explanation; None for an agent without explanations, which learns all the same.
    """
    if isinstance(agent, Explaining):
        return agent.explain_update(transition)
    if not isinstance(agent, TabularLearner):
        agent.learn(transition)
        return None
    kind = next(_EXPLAINERS[base] for base in type(agent).__mro__ if base in _EXPLAINERS)
    return kind(agent, transition).learn()


class OneStepExplainer(Generic[Learner]):
    """Explains an update by one transition: (1 − α) Q + α (r + γ Q′).

    It reads what the learner knows when it is created, and whenever a value is about to change.
    """

    def __init__(self, learner: Learner, transition: Transition) -> None:
        self.learner, self.transition = learner, transition
        table = learner.table
        self.pair = table.index(transition.observation), table.column(transition.action)
        """State and column of the transition."""
        self.updates: list[ValueUpdate] = []
        self._average_m = learner._average_m

    def learn(self) -> UpdateExplanation:
        """Let the learner learn from the transition, and explain the changes."""
        learner, table = self.learner, self.learner.table
        learner.table = cast(ValueTable, _WatchedTable(table, self))
        try:
            learner.learn(self.transition)
        finally:
            learner.table = table
        summary, direct = self.direct_update()
        further = [update for update in self.updates if update is not direct]
        beliefs = []
        if learner._is_average:
            name = "average reward of a step"
            beliefs.append(Belief(name, self._average_m, learner._average_m))
        return UpdateExplanation(summary, direct, further, beliefs)

    def add_write(self, table: ValueTable, state: int, column: int, after: float) -> None:
        """Add the update of an entry, which is about to get the value `after`."""
        before = table.value(state, column)
        rule, terms = self.rule((state, column), before)
        place = table.cells_at(state), table.action_at(column)
        self.updates.append(ValueUpdate(*place, rule, tuple(terms), before, after))

    def rule(self, pair: tuple[int, int], before: float) -> Rule:
        """Return the rule of the next value of a state and column, which is `before` now."""
        target, terms = self.target(pair)
        return f"(1 − α) · Q + α · ({target})", (*self.rate_terms(before), *terms)

    def direct_update(self) -> tuple[str, ValueUpdate | None]:
        """Return a summary of the updates, and that of the entry which the step taught directly."""
        if not self.updates:
            return "No value changes.", None
        return summary_of(self.updates[0]), self.updates[0]

    def target(self, pair: tuple[int, int]) -> Rule:  # noqa: ARG002
        """Return the target of a value: the reward and the value of the next state."""
        later, terms = self.next_value()
        return self.return_rule("r", later), (*self.reward_terms(), *terms)

    def next_value(self) -> Rule:
        """Return the value of the next state."""
        value = self.learner._next_value(self.transition)
        return "Q′", (Term("Q′", value, self.learner.next_meaning),)

    def rate_terms(self, before: float) -> Sequence[Term]:
        """Return the value before the update, and the learning rate."""
        return Term("Q", before, "value before"), Term("α", self.learner._alpha, "learning rate")

    def reward_terms(self) -> Sequence[Term]:
        """Return the reward of the step, and the objective's term."""
        reward = Term("r", self.transition.reward_m, "reward of this step [m]")
        return reward, self.objective_term()

    def return_rule(self, reward: str, later: str) -> str:
        """Return the formula of a return from the names of a reward and of the value after it."""
        return f"{reward} − R̄ + {later}" if self.learner._is_average else f"{reward} + γ · {later}"

    def objective_term(self) -> Term:
        """Return the term of `return_rule` that the objective adds: the average reward, or γ."""
        if self.learner._is_average:
            average_m = self.learner._average_m
            return Term("R̄", average_m, "average reward of a step, as learned so far [m]")
        return Term("γ", self.learner._gamma, "discount")


class _WatchedTable:
    """A learner's table which shows an explainer each value before it is written."""

    def __init__(self, table: ValueTable, explainer: OneStepExplainer[Any]) -> None:
        self._table, self._explainer = table, explainer

    def __getattr__(self, name: str) -> Any:
        return getattr(self._table, name)

    def set_value(self, state: int, column: int, value: float) -> None:
        """Replace the value of an entry."""
        self._explainer.add_write(self._table, state, column, value)
        self._table.set_value(state, column, value)


class ExpectedSarsaExplainer(OneStepExplainer[ExpectedSarsa]):
    """Explains an update by the mean of the next values under the ε-greedy policy."""

    def next_value(self) -> Rule:
        """Return the mean value of the next action."""
        step = self.transition
        values = self.learner.table.values_of(step.next_observation, step.next_legal)
        return "((1 − ε) · Q⁺ + ε · Σ / n)", (
            Term("ε", self.learner.epsilon, "probability that the next action is a random one"),
            Term("Q⁺", max(values), "highest value in the next state"),
            Term("Σ", ordered_sum(values), "sum of all values in the next state"),
            Term("n", len(values), "number of actions there"),
        )


class DoubleQExplainer(OneStepExplainer[DoubleQ]):
    """Explains the mean of two tables, of which one was drawn to learn."""

    def __init__(self, learner: DoubleQ, transition: Transition) -> None:
        super().__init__(learner, transition)
        drawing = copy(learner)
        drawing._rng = copy_of(learner._rng)
        self._drawn, self._value = drawing._draw(transition)
        self._before = [half.value(*self.pair) for half in learner._halves]

    def rule(self, pair: tuple[int, int], before: float) -> Rule:  # noqa: ARG002
        """Return the rule of the mean of both tables."""
        drawn = self._drawn
        meaning = "value in the other table of the best next action by the first"
        return f"((1 − α) · Q₁ + α · ({self.return_rule('r', 'Q₂′')}) + Q₂) / 2", (
            Term("α", self.learner._alpha, "learning rate"),
            Term(
                "Q₁", self._before[drawn], f"value in table {drawn + 1}, which was drawn to learn"
            ),
            *self.reward_terms(),
            Term("Q₂′", self._value, meaning),
            Term("Q₂", self._before[1 - drawn], "value in the other table"),
        )


class NStepSarsaExplainer(OneStepExplainer[NStepSarsa]):
    """Explains the update of the value n − 1 steps ago, if there is one."""

    def __init__(self, learner: NStepSarsa, transition: Transition) -> None:
        super().__init__(learner, transition)
        self._rewards = [reward for *_, reward in learner._waiting] + [transition.reward_m]

    def target(self, pair: tuple[int, int]) -> Rule:  # noqa: ARG002
        """Return the n rewards and the value after them, nested as they are added up."""
        count = len(self._rewards)
        rewards = [
            Term(f"r{number}", reward, f"reward {number} of these {count} steps [m]")
            for number, reward in enumerate(self._rewards, start=1)
        ]
        formula = "Q′"
        for term in reversed(rewards):
            later = formula if formula == "Q′" else f"({formula})"
            formula = self.return_rule(term.symbol, later)
        value = self.learner._chosen_next(self.transition)
        meaning = "value of the next action, which is chosen already"
        return formula, (*rewards, self.objective_term(), Term("Q′", value, meaning))

    def direct_update(self) -> tuple[str, ValueUpdate | None]:
        """Return a summary with the number of steps since, and the late update."""
        count = self.learner._return_steps
        if not self.updates:
            waiting = len(self.learner._waiting)
            return (
                f"No value changes yet: a step is judged when {count} rewards are "
                f"known, and {waiting} of them are."
            ), None
        summary, direct = super().direct_update()
        if count > 1:
            ago = "one step" if count == 2 else f"{count - 1} steps"
            summary = f"The step of {ago} ago is judged now. {summary}"
        return summary, direct


class TraceExplainer(OneStepExplainer[TraceLearner]):
    """Explains the updates of all steps with an eligibility trace: Q + α δ e."""

    def __init__(self, learner: TraceLearner, transition: Transition) -> None:
        super().__init__(learner, transition)
        target, terms = self.target(self.pair)
        self._difference: Rule = f"({target} − Q)", terms
        error = learner._target(transition) - learner.table.value(*self.pair)
        self._error = Term("δ", error, "what came, less what this step was worth before")

    def rule(self, pair: tuple[int, int], before: float) -> Rule:
        """Return the rule of a value with a trace."""
        difference, terms = self._difference if pair == self.pair else ("δ", [self._error])
        meaning = "trace: how much the step counts for it"
        trace = Term("e", self.learner._traces[pair], meaning)
        return f"Q + α · {difference} · e", (*self.rate_terms(before), *terms, trace)

    def direct_update(self) -> tuple[str, ValueUpdate | None]:
        """Return a summary of all updates, and that of the newest step, which is the last."""
        direct, earlier = self.updates[-1], len(self.updates) - 1
        summary = summary_of(direct)
        if earlier:
            steps = "The step before" if earlier == 1 else f"{earlier} steps before"
            summary += f" {steps} share in it, by their traces."
        return summary, direct


class DynaQExplainer(OneStepExplainer[DynaQ]):
    """Explains the update by the real step, and those by the imagined steps after it."""

    def target(self, pair: tuple[int, int]) -> Rule:
        """Return the target of the real step for the first update, then that of an imagined one."""
        if not self.updates:
            return super().target(pair)
        imagined = self.learner._model.pair(*pair)
        reward_m = self.learner._imagined_reward_m(imagined)
        best = self.learner.table.best(imagined.last_next)
        return self.return_rule("r̂", "Q′"), (
            Term("r̂", reward_m, "imagined reward [m]"),
            self.objective_term(),
            Term("Q′", best, "highest value in the state that followed last time"),
        )

    def direct_update(self) -> tuple[str, ValueUpdate | None]:
        """Return a summary that counts the planned updates, and the first update."""
        summary, direct = super().direct_update()
        return f"{summary} {planning_summary(self.updates[1:])}", direct


class PrioritizedSweepingExplainer(OneStepExplainer[PrioritizedSweeping]):
    """Explains the planned updates, among which that of the step itself may be."""

    def target(self, pair: tuple[int, int]) -> Rule:
        """Return the target as an expectation over all tries of a pair."""
        tried = self.learner._model.pair(*pair)
        later = self.learner._later(tried)
        return self.return_rule("r̄", "Σ / N"), (
            Term("r̄", tried.mean_reward_m, "mean reward of all tries [m]"),
            self.objective_term(),
            Term("Σ", later, "sum of the highest values in the states that followed"),
            Term("N", tried.tries, "number of tries"),
        )

    def direct_update(self) -> tuple[str, ValueUpdate | None]:
        """Return a summary, and the first update of the step's own value; None without one."""
        place = self.transition.observation, self.transition.action
        direct = next(
            (update for update in self.updates if (update.observation, update.action) == place),
            None,
        )
        if direct is None:
            summary = (
                "The step's own value was not updated: others would change more, or it too little."
            )
        else:
            summary = summary_of(direct)
        return f"{summary} {planning_summary(self.updates)}", direct


_EXPLAINERS: Mapping[type, type[OneStepExplainer[Any]]] = {
    TabularLearner: OneStepExplainer,
    ExpectedSarsa: ExpectedSarsaExplainer,
    DoubleQ: DoubleQExplainer,
    NStepSarsa: NStepSarsaExplainer,
    TraceLearner: TraceExplainer,
    DynaQ: DynaQExplainer,
    PrioritizedSweeping: PrioritizedSweepingExplainer,
}
"""Explainer of each learner with an update rule of its own, and of those derived from it."""


def summary_of(update: ValueUpdate) -> str:
    """Return in a sentence how a value changed."""
    change = update.after - update.before
    if change == 0:
        return "It got what it expected: the value stays as it was."
    came = "more" if change > 0 else "less"
    return (
        f"It got {came} than it expected, counting what it expects from there on: the value "
        f"{'rises' if change > 0 else 'falls'} from {in_millimetres(update.before)} to "
        f"{in_millimetres(update.after)}."
    )


def planning_summary(planned: Sequence[ValueUpdate]) -> str:
    """Return in a sentence how many values were changed by planning."""
    changed = {
        (update.observation, update.action) for update in planned if update.before != update.after
    }
    updates, values = len(planned), len(changed)
    return (
        f"Then it went over {updates} remembered step{'s' * (updates != 1)}, which changed "
        f"{values or 'no'} value{'s' * (values != 1)}."
    )
