"""Generalising learner: a Bayesian linear model of a step's reward, chosen from by optimism.

A table learns each state and action by itself. This learner assumes that the reward depends on
where the feet stand after landing, by a sum over groups of legs, and so learns from every step
about every other. Sources: Bayesian linear regression (Bishop 2006, §3.3), LinUCB (Li et al. 2010),
choice between experts as a non-stationary bandit with discounted rewards (Garivier & Moulines
2011) and optimistic initial values (Sutton & Barto 2018, §2.6).
"""

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from annotated_types import Ge, Le

from hexapods.agents.experts import (
    FORGETTING,
    NOISE,
    Expert,
    ExpertPolicy,
    MeasuredExpert,
    PlannedExpert,
    Prior,
    Readings,
)
from hexapods.agents.explanation import (
    Belief,
    ChoiceExplanation,
    UpdateExplanation,
    ValueUpdate,
    in_millimetres,
)
from hexapods.agents.group_cycles import CycleBandit, Order, cycles_of
from hexapods.agents.protocol import AgentState, Observe, Problem, Transition
from hexapods.domain.settings import Setting, declare
from hexapods.domain.types import Action, Cells, FloatArray, IntArray

Optimism = Annotated[
    float,
    Ge(0),
    Le(10),
    Setting(
        title="Optimism",
        symbol="β",
        help="Posterior standard deviations added to an expected reward; higher explores more.",
        live=True,
        examples=(0.5, 1),
    ),
]

_TURNS = 2
"""Turns of every group for which a policy decides: six steps of a robot with three groups."""
_UNTRIED, _UNTRIED_MEASURED = 1.0, 0.5
"""Expected reward per step of an untried policy, counted as one step, as a share of the best
possible without slip, so that orders are tried early: that costs little where they are no better.
The policy by measured cells needs many steps to learn, and is tried where the others earn
little."""
_FAST, _SLOW = 1 / 4, 1 / 40
"""Weights of the newest squared error in the short and the long moving average."""
_CHANGE_RATIO, _CHANGE_LEAST = 4.0, 4.0
"""A change is noticed where the short average exceeds the long one by this ratio, and the noise's
variance by that one."""
_KEPT = 0.1
"""Share of the evidence that remains after a noticed change."""


class LinearModel:
    """Bayesian linear models of the reward by two experts, one for each reading of the state.

    Both learn from every step. One of several policies chooses the actions, for two turns of all
    groups at a time: the policy with the highest recent reward. Two follow the plan, and let the
    groups take turns in one order or the other, which have equal rewards in a single step (two
    groups have one order); the last follows the measured cells. A policy takes the action with the
    highest mean plus `optimism` posterior deviations (LinUCB). Where errors of prediction rise
    suddenly, most of the evidence is forgotten, which makes it explore again. It makes no random
    choices: ties go to the first action in `legal`.

    Args:
        problem: number of groups, and the cells' displacements.
        observe: reads measured cells and planned offsets, whatever the run's observation is.
        explore: if False, an action is chosen by the mean alone.
        prior: the prior mean of the reward: 0, or what the kinematic law predicts.
        optimism: β, the weight of the posterior's standard deviation.
        order: `turns`, or `cycles`, by which `CycleBandit` chooses the policy.
    """

    title = "Linear model"
    description = (
        "Learns what each place of the feet is worth, tries what it is unsure of, never stops."
    )
    color = "#D55E00"
    needs_practice = True
    keeps_learning = True

    def __init__(
        self,
        problem: Problem,
        observe: Observe,
        *,
        explore: bool = True,
        prior: Prior = "none",
        optimism: Optimism = 0.5,
        order: Order = "turns",
    ) -> None:
        self._observe, self._explore, self._optimism = observe, explore, optimism
        self._tuned_optimism = np.nan
        self._cells = len(problem.cells_m)
        self._half_side_m = float(np.abs(problem.cells_m).max()) or 1.0
        self._experts = (PlannedExpert(problem, prior), MeasuredExpert(problem, prior))
        self._visits: IntArray = np.zeros((len(problem.groups), self._cells), np.int64)
        planned, measured = self._experts
        groups = len(problem.groups)
        self._block_steps = _TURNS * groups
        forth = tuple((group + 1) % groups for group in range(groups))
        back = tuple((group - 1) % groups for group in range(groups))
        cycles = cycles_of(groups) if order == "cycles" else []
        turns: list[tuple[int, ...] | None] = [*dict.fromkeys((forth, back))]
        self._policies = (
            *(ExpertPolicy(planned, turn, _UNTRIED) for turn in [None for _ in cycles] or turns),
            ExpertPolicy(measured, None, _UNTRIED_MEASURED),
        )
        sizes = [len(group) for group in problem.groups]
        legs = sum(sizes)  # whole numbers
        squares = sum(size * size for size in sizes) / (legs * legs)  # whole numbers
        self._law_m = 2 * self._half_side_m / (groups * (1 + squares))
        """Advance per step of the steady walk without slip [m]."""
        self._bandit = CycleBandit([*cycles, None], groups, self._law_m) if cycles else None
        self._deciding, self._decided, self._last_group = 0, 0, groups - 1
        self._earned: FloatArray = np.zeros((len(self._policies), 2))
        """Discounted number of steps of each policy, and their discounted rewards [m]."""
        self._noise_variance = (NOISE * self._half_side_m) ** 2
        self._errors: FloatArray = np.array([[0.0, self._noise_variance]] * len(self._experts))
        """Short and long moving average of each expert's squared errors [m²]."""
        self._predicted: FloatArray = np.zeros(len(self._experts))
        """Rewards [m] predicted by each expert since a frozen copy last chose a policy."""
        self._before = self._read()

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:  # noqa: ARG002
        """Return the action with the highest upper confidence bound of the current policy."""
        return self._choose(legal)[0]

    def explain_choice(
        self,
        observation: Cells,  # noqa: ARG002
        legal: Sequence[Action],
    ) -> ChoiceExplanation:
        """Choose as `act` does, and explain the choice."""
        action, allowed, bounds_m = self._choose(legal)
        scores = np.full(self._visits.shape, np.nan)
        scores[tuple(np.transpose(allowed))] = bounds_m
        policy, beta = self._policies[self._deciding], self._optimism if self._explore else 0.0
        criterion = f"expected reward of the step by its {policy.expert.name} model"
        if beta:
            criterion += f", plus {beta:g} standard deviations"
        if policy.successor is not None:
            criterion += "; the groups take turns"
        elif len(allowed) < len(legal):
            criterion += "; the groups move in the cycle that it tries"
        return ChoiceExplanation(action, "exploited", criterion, scores)

    def _choose(self, legal: Sequence[Action]) -> tuple[Action, Sequence[Action], FloatArray]:
        """Return an action, the allowed actions, and their upper confidence bounds [m].

        Where a block has ended, the next policy is chosen first.
        """
        self._before = self._read()
        if self._bandit is not None and self._explore:
            if self._bandit.is_over:
                self._deciding = self._bandit.choose(self._deciding, self._last_group)
        elif self._decided % self._block_steps == 0:
            self._choose_policy()
        self._decided += 1
        policy = self._policies[self._deciding]
        if self._bandit is None:
            allowed = policy.allowed(legal, self._last_group)
        else:
            group = self._bandit.next_group(self._deciding)
            allowed = [action for action in legal if action.group == group] or legal
        optimism = self._optimism if self._explore else 0.0
        bounds_m = policy.expert.upper_bound_m(self._before, allowed, optimism)
        best = allowed[int(bounds_m.argmax())]
        self._predicted += self._predictions(best)
        self._last_group = best.group
        return best, allowed, bounds_m

    def learn(self, transition: Transition) -> None:
        """Update both experts' posteriors, and the rewards of the current policy."""
        action, reward = transition.action, transition.reward_m
        errors = (reward - self._predictions(action)) ** 2
        for expert in self._experts:
            (features,) = expert.features(self._before, [action])
            expert.model.update(features, reward)
        self._visits[action] += 1
        self._earned *= FORGETTING
        self._earned[self._deciding] += 1, reward
        if self._bandit is not None:
            self._bandit.earn(reward)
        self._errors[:, 0] += _FAST * (errors - self._errors[:, 0])
        self._errors[:, 1] += _SLOW * (errors - self._errors[:, 1])
        if self._has_changed():
            self._forget()

    def explain_update(self, transition: Transition) -> UpdateExplanation:
        """Learn as `learn` does, and explain how both experts' expectations change.

        The rule is the expected reward of the step after the update, by the policy's expert.
        """
        before = [self._belief(expert, transition.action) for expert in self._experts]
        self.learn(transition)
        after = [self._belief(expert, transition.action) for expert in self._experts]
        beliefs = [
            Belief(f"reward by its {expert.name} model", old[0], new[0], "m", old[1], new[1])
            for expert, old, new in zip(self._experts, before, after, strict=True)
        ]
        decided = self._policies[self._deciding].expert
        index = self._experts.index(decided)
        (features,) = decided.features(self._before, [transition.action])
        rule, terms = decided.explain(features)
        (expected, deviation), (became, _) = before[index], after[index]
        place = transition.observation, transition.action
        update = ValueUpdate(*place, rule, tuple(terms), expected, became)
        error = transition.reward_m - expected
        summary = (
            f"It expected {in_millimetres(expected)}, ± {in_millimetres(deviation)}, and got "
            f"{in_millimetres(transition.reward_m)}: {in_millimetres(abs(error))} "
            f"{'more' if error > 0 else 'less'}. It now expects {'more' if error > 0 else 'less'} "
            "of every step that ends alike, not of this one alone."
        )
        return UpdateExplanation(summary, update, (), beliefs)

    def _belief(self, expert: Expert, action: Action) -> tuple[float, float]:
        """Return an expert's expected reward of the last step, and its standard deviation [m]."""
        features = expert.features(self._before, [action])
        return float(expert.model.expected(features)[0]), float(expert.model.deviation(features)[0])

    def _read(self) -> Readings:
        return Readings(self._observe("measured"), np.array(self._observe.planned_offsets_m, float))

    def _predictions(self, action: Action) -> FloatArray:
        """Return the reward that each expert expects [m], (experts,)."""
        return np.array([expert.expected_m(self._before, [action])[0] for expert in self._experts])

    def _choose_policy(self) -> None:
        """Choose the policy with the highest recent reward; untried ones are rated optimistically.

        A frozen copy gets no rewards. It keeps its policy, unless that steps on the spot: in a
        cycle of cells with high values, for which the plan predicts hardly any advance.
        """
        if self._explore:
            self._deciding = self._best_policy(self._policies, optimistic=True)
        else:
            by_plan, by_cells = self._predicted
            is_planned = self._policies[self._deciding].expert is self._experts[0]
            if not is_planned and by_plan < by_cells / 4:
                self._deciding = self._best_policy(self._policies[:-1], optimistic=False)
        self._predicted = np.zeros_like(self._predicted)

    def _best_policy(self, policies: Sequence[ExpertPolicy], optimistic: bool) -> int:
        """Return the index of the policy with the highest reward per step.

        One step is added to each: with an untried policy's reward if `optimistic`, else with 0.
        """
        steps, rewards = self._earned[: len(policies)].T
        untried = np.array([policy.untried * self._law_m for policy in policies])
        return int(((rewards + optimistic * untried) / (steps + 1)).argmax())

    def _has_changed(self) -> bool:
        """Whether the recent errors of all experts exceed their long-term average."""
        short, long = self._errors.T
        risen = (short > _CHANGE_RATIO * long) & (short > _CHANGE_LEAST * self._noise_variance)
        return self._decided > 2 * self._block_steps and bool(risen.all())

    def _forget(self) -> None:
        for expert in self._experts:
            expert.model.discount(_KEPT)
        self._earned *= _KEPT
        self._errors[:, 1] = np.maximum(self._errors[:, 1], self._errors[:, 0])
        if self._bandit is not None:
            self._bandit.restart(self._deciding, self._last_group)

    def tune(self, *, optimism: Optimism | None = None) -> None:
        """Change the optimism from the next step on."""
        if optimism is not None:
            self._optimism = self._tuned_optimism = optimism

    def values(self, observation: Cells) -> FloatArray:
        """Return the expected reward of the next step [m], (groups, cells), NaN where illegal."""
        groups, cells = self._visits.shape
        actions = [Action(group, cell) for group in range(groups) for cell in range(cells)]
        expected_m = self._policies[self._deciding].expert.expected_m(self._read(), actions)
        return _without_illegal(expected_m.reshape(groups, cells), observation)

    def visits(self, observation: Cells) -> FloatArray:
        """Return visit counts of the actions over all states, (groups, cells), NaN where illegal.

        Every visit teaches the model about all states.
        """
        return _without_illegal(self._visits.astype(float), observation)

    def state(self) -> AgentState:
        """Return the evidence, the policies' rewards, the experts' errors, visits and optimism."""
        evidence: AgentState = {}
        for expert in self._experts:
            evidence[f"{expert.name}_moments"] = expert.model.moments.copy()
            evidence[f"{expert.name}_products"] = expert.model.products.copy()
        return {
            **evidence,
            **({} if self._bandit is None else self._bandit.dump()),
            "earned": self._earned.copy(),
            "errors": self._errors.copy(),
            "visits": self._visits.copy(),
            "deciding": np.array([self._deciding, self._decided, self._last_group], np.int64),
            "tuned_optimism": np.array([self._tuned_optimism]),
        }

    def continue_from(self, state: AgentState) -> None:
        """Load a saved state without its tuned optimism.

        Raises:
            ValueError: if the state is of another number of groups or cells.
        """
        self.load({**state, "tuned_optimism": np.array([np.nan])})

    def load(self, state: AgentState) -> None:
        """Restore a state that `state` returned.

        Raises:
            ValueError: if the state is of another number of groups or cells.
        """
        present = self.state()
        if not present.keys() <= state.keys():
            raise ValueError("it was learned with another order of the groups")
        for name, array in present.items():
            if state[name].shape != array.shape:
                raise ValueError(f"{name} has the shape {state[name].shape}, not {array.shape}")
        for expert in self._experts:
            expert.model.set_evidence(
                state[f"{expert.name}_moments"].copy(), state[f"{expert.name}_products"].copy()
            )
        self._earned, self._errors = state["earned"].copy(), state["errors"].copy()
        self._visits = state["visits"].copy()
        self._deciding, self._decided, self._last_group = state["deciding"].tolist()
        (self._tuned_optimism,) = state["tuned_optimism"].tolist()
        if not np.isnan(self._tuned_optimism):
            self._optimism = self._tuned_optimism
        if self._bandit is not None:
            self._bandit.load(state)
        if not self._explore:  # a new walk, from rest
            self._deciding, self._decided = self._best_policy(self._policies, optimistic=False), 0
            if self._bandit is not None:
                self._deciding = self._bandit.walk_from_rest()
            self._last_group = len(self._visits) - 1

    @staticmethod
    def check_state(state: AgentState) -> None:
        """Check the arrays of a saved state: optimism, evidence, errors and counters.

        Raises:
            InvalidInput: for an optimism out of its limits.
            KeyError, ValueError: if `state` is not a state of this agent.
        """
        (optimism,) = state["tuned_optimism"].tolist()
        if not np.isnan(optimism):
            declare("optimism", Optimism).check(optimism)
        for name in ("planned", "measured"):
            moments, products = state[f"{name}_moments"], state[f"{name}_products"]
            if moments.shape != (len(products), len(products)) or products.ndim != 1:
                raise ValueError(f"its {name} evidence has no shape of a regression")
            if not np.array_equal(moments, moments.T) or (moments.diagonal() < 0).any():
                raise ValueError(f"its {name} evidence is no sum of squares")
        for name in ("planned_products", "measured_products", "earned", "errors"):
            if state[name].dtype.kind != "f" or not np.isfinite(state[name]).all():
                raise ValueError(f"its {name} are no numbers")
        policies = len(state["earned"])
        CycleBandit.check(state, policies)
        if (
            (policies not in (2, 3) and "cycle_rewards" not in state)
            or state["earned"].shape != (policies, 2)
            or state["errors"].shape != (2, 2)
        ):
            raise ValueError("it has no records of its policies and two experts")
        if (state["earned"][:, 0] < 0).any() or (state["errors"] < 0).any():
            raise ValueError("it has records below zero")
        deciding, decided, last_group = state["deciding"].tolist()
        visits = state["visits"]
        kinds = state["deciding"].dtype.kind + visits.dtype.kind
        counts = kinds == "ii" and visits.ndim == 2 and (visits >= 0).all()
        if (
            not counts
            or decided < 0
            or deciding not in range(policies)
            or last_group not in range(len(visits))
        ):
            raise ValueError("its counters are out of range")


def _without_illegal(values: FloatArray, observation: Cells) -> FloatArray:
    values[np.arange(len(values)), observation] = np.nan
    return values
