"""Multilevel regression of a step's reward: from the cells of the feet to state-action pairs.

A Bayesian multilevel model with partial pooling (Gelman and Hill 2007, chapter 12) of four levels,
each a correction of the coarser one: a linear model of the cells on which the feet stand after
landing; the landing, which is all of these cells; the landing with the group that moved; and the
state-action pair, which says also where that group came from. A member that was tried often has
nearly its own mean reward, and one that was never tried the expectation of the coarser levels.
"""

from typing import NamedTuple

import numpy as np

from hexapods.agents.bayesian_regression import BayesianRegression
from hexapods.agents.protocol import Problem
from hexapods.domain.types import Cells, FloatArray, IntArray

# As shares of h, half the side of the foot grid: the noise of a reward, and the prior standard
# deviations of what each level adds to the coarser one.
_NOISE, _CELL, _LANDING, _MOVER, _PAIR = 0.1, 1.0, 0.2, 0.2, 0.3


class PairLayout:
    """Indices of the state-action pairs of a problem, and of the coarser members they belong to.

    The index of a state is that of its row in a Q-table; that of a pair is its state's index times
    the number of actions, plus the action's column. Pairs that stay on their cell are illegal, and
    have an index too.

    Attributes:
        groups, cells, states, pairs: their numbers.
        cells_of: cells of each state, (states, groups).
        is_legal: whether the group leaves its cell, (pairs,).
        landings: state whose cells the feet stand on after landing, (pairs,).
        movers: landing · groups + group that moved, (pairs,).
    """

    def __init__(self, problem: Problem) -> None:
        self.groups, self.cells = len(problem.groups), len(problem.cells_m)
        shape = (self.cells,) * self.groups
        self.states = self.cells**self.groups
        self.pairs = self.states * self.groups * self.cells
        self.cells_of: IntArray = np.array(np.unravel_index(np.arange(self.states), shape)).T
        state, group, cell = np.indices((self.states, self.groups, self.cells))
        came_from = self.cells_of[state, group]
        digits = np.array([self.cells ** (self.groups - 1 - place) for place in range(self.groups)])
        landed = state + (cell - came_from) * digits[group]
        self.is_legal = (cell != came_from).ravel()
        self.landings: IntArray = landed.ravel()
        self.movers: IntArray = (landed * self.groups + group).ravel()

    def index(self, observation: Cells) -> int:
        """Return the index of a state."""
        index: int = 0
        for cell in observation:
            index = index * self.cells + cell
        return index

    def members(self, pair: int) -> tuple[int, int, int, int]:
        """Return a pair's member of each of the four levels, the coarsest first."""
        landing = int(self.landings[pair])
        return landing, landing, int(self.movers[pair]), pair

    def next_by_law(self, problem: Problem) -> IntArray:
        """Return the state after each landing with mover, by the law of a step without slip.

        All feet shift back by the mean of their forward offsets, each to the nearest cell;
        (states · groups,).
        """
        cells_m, shares = problem.cells_m, problem.shares / self.groups
        offsets = cells_m[self.cells_of]  # (states, groups, 2)
        offsets[:, :, 1] -= (offsets[:, :, 1] * shares).sum(1)[:, None]
        squares = (offsets[:, :, None] - cells_m) ** 2
        nearest = (squares[..., 0] + squares[..., 1]).argmin(-1)
        after: IntArray = np.zeros(self.states, np.intp)
        for cell in nearest.T:
            after = after * self.cells + cell
        return np.repeat(after, self.groups)


class Level(NamedTuple):
    """Posterior of the rewards that a level of the model expects [m]; one entry a member."""

    name: str
    mean: FloatArray
    deviation: FloatArray


class _Evidence(NamedTuple):
    """Evidence of the steps about the rewards of a level's members.

    Attributes:
        precision: precision of each member's mean reward, (members,) [1/m²]; 0 without a step.
        weighted: that mean times its precision, (members,) [1/m].
    """

    precision: FloatArray
    weighted: FloatArray

    def widened(self, variance: float) -> "_Evidence":
        """Return the evidence about rewards that differ from these with a variance [m²]."""
        share = 1 / (1 + variance * self.precision)
        return _Evidence(share * self.precision, share * self.weighted)

    def summed(self, members: IntArray, count: int) -> "_Evidence":
        """Return the evidence of a coarser level; `members` are indices of its `count`."""
        # `bincount` adds in order, so that the last bits are the same on all machines.
        sums = (np.bincount(members, amounts, count) for amounts in self)
        return _Evidence(*(np.asarray(amounts, float) for amounts in sums))

    def corrected(self, name: str, coarser: Level, members: IntArray, variance: float) -> Level:
        """Return the posterior of this level, which corrects a coarser one (partial pooling)."""
        mean, deviation = coarser.mean[members], coarser.deviation[members]
        share = 1 / (1 + variance * self.precision)
        pooled = share * mean + share * variance * self.weighted
        return Level(name, pooled, np.sqrt((share * deviation) ** 2 + share * variance))


class MultilevelRegression:
    """Exact posterior of the expected rewards of all pairs, by messages between the levels.

    Args:
        problem: number of groups and cells, and the grid's size.
        layout: indices of the problem's pairs.
    """

    def __init__(self, problem: Problem, layout: PairLayout) -> None:
        self._layout = layout
        half_side_m = float(np.abs(problem.cells_m).max()) or 1.0
        self._noise, self._landing, self._mover, self._pair = (
            (share * half_side_m) ** 2 for share in (_NOISE, _LANDING, _MOVER, _PAIR)
        )
        features = layout.groups * layout.cells
        deviations = np.full(features, _CELL * half_side_m)
        # The evidence is in precisions already, so that its noise is 1.
        self._linear = BayesianRegression(np.zeros(features), deviations, 1.0)
        self._features = np.eye(layout.cells)[layout.cells_of].reshape(layout.states, features)
        self._columns = layout.cells_of + np.arange(layout.groups) * layout.cells

    def levels(self, tries: IntArray, reward_sums_m: FloatArray) -> tuple[Level, ...]:
        """Return the four levels, from the coarsest: of landings twice, movers and pairs.

        Args:
            tries: how often each pair was tried, (pairs,).
            reward_sums_m: sum of its rewards [m], (pairs,).
        """
        layout = self._layout
        of_pair = _Evidence(tries / self._noise, reward_sums_m / self._noise)
        movers = layout.states * layout.groups
        of_mover = of_pair.widened(self._pair).summed(layout.movers, movers)
        landing_of_mover = np.repeat(np.arange(layout.states), layout.groups)
        of_landing = of_mover.widened(self._mover).summed(landing_of_mover, layout.states)
        cells = self._fitted(of_landing.widened(self._landing))
        states = np.arange(layout.states)
        landing = of_landing.corrected("landing", cells, states, self._landing)
        mover = of_mover.corrected("landing and mover", landing, landing_of_mover, self._mover)
        return cells, landing, mover, of_pair.corrected("pair", mover, layout.movers, self._pair)

    def _fitted(self, evidence: _Evidence) -> Level:
        """Return the linear model's rewards of all landings, fitted to the evidence of each."""
        count = self._features.shape[1]
        pairs = [
            (column[:, None] * count + other[:, None]).ravel()
            for column in self._columns.T
            for other in self._columns.T
        ]
        moments = np.zeros(count * count)
        for places in pairs:
            moments += np.bincount(places, evidence.precision, count * count)
        products = np.zeros(count)
        for columns in self._columns.T:
            products += np.bincount(columns, evidence.weighted, count)
        self._linear.set_evidence(moments.reshape(count, count), products)
        features = self._features
        return Level("cells", self._linear.expected(features), self._linear.deviation(features))
