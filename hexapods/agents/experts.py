"""Experts of the linear model: each expects a step's reward from its own reading of the state.

An expert is a Bayesian linear regression (Bishop 2006, §3.3) on features of where the feet stand
after landing: on their measured cells, or on their planned offsets.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Annotated, Literal, NamedTuple

import numpy as np

from hexapods.agents.bayesian_regression import BayesianRegression, sum_rule
from hexapods.agents.explanation import Term
from hexapods.agents.protocol import Problem
from hexapods.domain.settings import Setting
from hexapods.domain.types import Action, Cells, FloatArray

Prior = Annotated[
    Literal["none", "kinematic"],
    Setting(
        title="Prior",
        phrase="prior\u00a0{}",
        help="What it assumes before its first step: nothing, or the law of a step without slip.",
    ),
]

# All lengths are shares of h, half the side of the foot grid: at h = 0.02 m the deviations are
# those of the prototypes, 0.02 m a priori and 0.003 m of noise.
NOISE = 0.15
_DEVIATION, _LATERAL_DEVIATION = 1.0, 0.1
FORGETTING = 0.98
"""Share of the evidence, and of the policies' rewards, that remains at each further step."""


class Readings(NamedTuple):
    """The observations of the state before a step, one for each expert."""

    cells: Cells
    """The measured cells, whatever the run's observation is."""
    planned_m: FloatArray
    """Offset (x, y) of each group from home by dead reckoning, (groups, 2)."""


class Expert(ABC):
    """One reading of the state, as features of where the feet stand after landing."""

    name: str

    def __init__(self, problem: Problem, prior: Prior) -> None:
        self._cells_m = problem.cells_m
        self._half_side_m = float(np.abs(problem.cells_m).max()) or 1.0
        self._shares = problem.shares
        weights, deviations = self._prior(len(problem.groups))
        weights = weights if prior == "kinematic" else np.zeros_like(weights)
        half = self._half_side_m
        self.model = BayesianRegression(weights * half, deviations * half, NOISE * half, FORGETTING)

    @abstractmethod
    def _prior(self, groups: int) -> tuple[FloatArray, FloatArray]:
        """Return the weights of the kinematic law, and their prior deviations [h], (d,)."""

    @abstractmethod
    def features(self, before: Readings, actions: Sequence[Action]) -> FloatArray:
        """Return the features of each of n actions, (n, d)."""

    def expected_m(self, before: Readings, actions: Sequence[Action]) -> FloatArray:
        """Return the expected rewards of n actions [m], (n,)."""
        return self.model.expected(self.features(before, actions))

    def explain(self, features: FloatArray) -> tuple[str, Sequence[Term]]:
        """Return the rule of the expected reward for features (d,), with its terms."""
        used = np.flatnonzero(features).tolist()
        terms, products = [], {}
        for number, index in enumerate(used, 1):
            name = self.feature_name(index)
            terms += [
                Term(f"w{number}", float(self.model.mean[index]), f"weight of {name} [m]"),
                Term(f"x{number}", float(features[index]), name),
            ]
            products[index] = f"x{number} · w{number}"
        return sum_rule(products, len(features)) or "0", terms

    @abstractmethod
    def feature_name(self, index: int) -> str:
        """Return the name of a feature, for explanations."""

    def upper_bound_m(
        self, before: Readings, actions: Sequence[Action], optimism: float
    ) -> FloatArray:
        """Return the upper confidence bounds of the rewards of n actions [m], (n,)."""
        features = self.features(before, actions)
        return self.model.expected(features) + optimism * self.model.deviation(features)


class MeasuredExpert(Expert):
    """One-hot features of each group's observed cell after landing: groups × cells weights."""

    name = "measured"

    def _prior(self, groups: int) -> tuple[FloatArray, FloatArray]:
        weights = np.outer(self._shares, self._cells_m[:, 1] / self._half_side_m).ravel() / groups
        return weights, np.full(len(weights), _DEVIATION)

    def features(self, before: Readings, actions: Sequence[Action]) -> FloatArray:  # noqa: D102
        landed = np.tile(before.cells, (len(actions), 1))  # (n, groups)
        for row, action in enumerate(actions):
            landed[row, action.group] = action.cell
        one_hot: FloatArray = np.eye(len(self._cells_m))[landed]
        return one_hot.reshape(len(actions), -1)

    def feature_name(self, index: int) -> str:  # noqa: D102
        group, cell = divmod(index, len(self._cells_m))
        return f"group {group + 1} on cell {cell}"


class PlannedExpert(Expert):
    """Features of the planned offsets after landing, which are continuous: 1 + groups weights.

    They are the mean forward offset of all feet, by which the body would move without slip, and
    each group's lateral offset, as a wider or narrower stance slips less or more. All forward
    offsets share one weight: with a weight for each group, greedy steps favour the groups with the
    largest weights and never bring the other groups forward.
    """

    name = "planned"

    def _prior(self, groups: int) -> tuple[FloatArray, FloatArray]:
        deviations = np.array([_DEVIATION, *[_LATERAL_DEVIATION] * groups])
        return np.array([1.0, *[0.0] * groups]), deviations

    def features(self, before: Readings, actions: Sequence[Action]) -> FloatArray:  # noqa: D102
        landed = np.tile(before.planned_m, (len(actions), 1, 1))  # (n, groups, 2)
        for row, action in enumerate(actions):
            landed[row, action.group] = self._cells_m[action.cell]
        landed /= self._half_side_m
        return np.column_stack(((landed[:, :, 1] * self._shares).mean(1), landed[:, :, 0]))

    def feature_name(self, index: int) -> str:  # noqa: D102
        return f"how far group {index} stands out" if index else "how far forward the feet stand"


class ExpertPolicy(NamedTuple):
    """A policy: an expert, and the order in which the groups take turns."""

    expert: Expert
    successor: tuple[int, ...] | None
    """The group that moves after each group; None if any may."""
    untried: float
    """Expected reward per step of the untried policy, as a share of the law's."""

    def allowed(self, legal: Sequence[Action], last_group: int) -> Sequence[Action]:
        """Return the legal actions of the group in turn; all legal actions if it has none."""
        if self.successor is None:
            return legal
        return [action for action in legal if action.group == self.successor[last_group]] or legal
