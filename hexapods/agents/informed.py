"""Informed search: simulates only the steps that the kinematic law ranks best.

The paper names an "informed search with a reasonable heuristic" as future work. The heuristic here
is the kinematic law of a step (`hexapods.domain.feet`): the body's displacement if no foot slips
and no joint gives way, computed from where the feet are. The difference between a simulated reward
and the law, the residual, is learned by Bayesian linear regression.
"""

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np

from hexapods.agents.bayesian_regression import BayesianRegression
from hexapods.agents.protocol import Expand, Node, Problem
from hexapods.agents.search import Budget, Search
from hexapods.domain.types import Action, Cells, FloatArray, IntArray

LAYER_WEIGHTS = (2, 3, 3)
"""Shares of the budget of the layers of the tree: the first has the fewest candidates."""
BUDGET_PER_LAYER = 20
"""A budget of 20 transitions pays for a second layer, one of 40 for a third."""
PROMISING = 24
"""Number of actions of a node that become candidates, those with the highest predicted rewards."""
PRIOR_DEVIATION_M, NOISE_DEVIATION_M = 0.005, 0.002
"""Deviations: of the prior of a weight of the residual, and of a reward about the model."""


class Informed(Search):
    """Best-first search with a learned heuristic, layer by layer, within a budget of transitions.

    The candidates of a layer are all actions of the nodes that were simulated in the layer before.
    Those are simulated that promise most: rewards so far, plus the predicted reward of the action,
    plus the highest predicted reward of the step after it. Every answer of the simulator improves
    the prediction, over the whole walk. The budget decides on the number of layers, at most three.
    The first action of the best sequence is taken, the highest predicted reward after its end
    included. Nothing is random; a tree is not kept for the next decision.

    Args:
        expand: simulates the transitions.
        problem: groups of legs, and cells of the foot grid.
        budget: maximum of transitions simulated for a decision.
    """

    title = "Informed"
    description = "Simulates only the steps that promise most by the law of a step without slip."
    color = "#2E5EAA"
    compares = "highest sum of simulated rewards, and of one that is predicted after them"

    def __init__(self, expand: Expand, problem: Problem, *, budget: Budget = 3) -> None:
        super().__init__(expand)
        self._model = RewardModel(problem)
        self._shares = shares_of(budget)

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the first action of the most promising sequence."""
        layer = [_Sequence(self._expand.here, 0.0, None)]
        firsts: list[Action] = []
        for step, share in enumerate(self._shares, 1):
            layer = self._simulate(self._candidates(layer)[:share])
            firsts = [sequence.first for sequence in layer if sequence.first is not None]
            self._record_futures(firsts, [sequence.sum_m for sequence in layer], step)
        after = self._model.best_rewards(np.array([sequence.node.offsets_m for sequence in layer]))
        values = [sequence.sum_m for sequence in layer] + after
        self._record_futures(firsts, values.tolist(), len(self._shares) + 1)
        return firsts[int(values.argmax())]

    def _candidates(self, layer: Sequence["_Sequence"]) -> list["_Candidate"]:
        """Return further steps of some sequences, the most promising first."""
        candidates = []
        for sequence in layer:
            offsets_m = np.array(sequence.node.offsets_m)
            actions = np.array(sequence.node.legal)
            rewards, ends = self._model.predict(offsets_m, actions)
            promising = np.argsort(-rewards, kind="stable")[:PROMISING]
            after = self._model.best_rewards(ends[promising])
            values = sequence.sum_m + rewards[promising] + after
            for index, value in zip(promising, values, strict=True):
                action = sequence.node.legal[index]
                candidates.append(_Candidate(float(value), sequence, action, offsets_m))
        return sorted(candidates, key=lambda candidate: -candidate.value_m)

    def _simulate(self, candidates: Sequence["_Candidate"]) -> list["_Sequence"]:
        """Simulate the steps, learn from their rewards, and return the longer sequences."""
        nodes, rewards = self._expand(
            [candidate.sequence.node for candidate in candidates],
            [candidate.action for candidate in candidates],
        )
        offsets_m = np.array([candidate.offsets_m for candidate in candidates])
        self._model.learn(
            offsets_m, np.array([candidate.action for candidate in candidates]), rewards
        )
        longer = []
        for candidate, node, reward in zip(candidates, nodes, rewards.tolist(), strict=True):
            first = (
                candidate.action if candidate.sequence.first is None else candidate.sequence.first
            )
            longer.append(_Sequence(node, candidate.sequence.sum_m + reward, first))
        return longer


class _Sequence(NamedTuple):
    """A simulated sequence of steps: where it ends, its sum of rewards, and its first action."""

    node: Node
    sum_m: float
    first: Action | None
    """None before the first step."""


class _Candidate(NamedTuple):
    """A step that may be simulated next."""

    value_m: float
    """Estimated return of the whole sequence, the step after this one included."""
    sequence: _Sequence
    action: Action
    offsets_m: FloatArray
    """Offsets of the feet before the step, (groups, 2)."""


def shares_of(budget: int) -> list[int]:
    """Return the number of transitions of a budget for each layer of the tree."""
    weights = LAYER_WEIGHTS[: 1 + budget // BUDGET_PER_LAYER]
    total = sum(weights)  # whole numbers
    ends = [budget * weight // total for weight in accumulate(weights, initial=0)]
    return [end - start for start, end in pairwise(ends)]


class RewardModel:
    """Reward of a step: the kinematic law, plus a linear residual that is learned.

    The features are: which group lands on which cell; the cells nearest to all groups once it has
    landed; where it comes from; and, for the group that moves, the offsets of all groups. The prior
    of the weights is independent and normal with mean 0: without data the law alone predicts. Sums
    are taken row by row, so that a prediction does not depend on how many are made at
    once.
    """

    def __init__(self, problem: Problem) -> None:
        self._cells_m = np.array(problem.cells_m)
        self._unit_m = float(np.abs(self._cells_m).max())
        self._groups, self._cells = len(problem.groups), len(self._cells_m)
        self._shares = problem.shares
        group, cell = np.divmod(np.arange(self._groups * self._cells), self._cells)
        self._actions = np.column_stack([group, cell])
        start = np.zeros((self._groups, 2))
        action = self._actions[:1]
        count = self._features(start, self._land(start, action), action).shape[1]
        deviation_m = np.full(count, PRIOR_DEVIATION_M)
        self._residual = BayesianRegression(np.zeros(count), deviation_m, NOISE_DEVIATION_M)

    def predict(self, offsets_m: FloatArray, actions: IntArray) -> tuple[FloatArray, FloatArray]:
        """Predict the rewards of some actions, and the offsets after them by the kinematic law.

        Args:
            offsets_m: offsets of the groups from home, (groups, 2), or (n, groups, 2).
            actions: n actions, (n, 2).

        Returns:
            rewards [m], (n,), and offsets [m], (n, groups, 2).
        """
        landed = self._land(offsets_m, actions)
        law = self._law(landed)
        residual = self._residual.expected(self._features(offsets_m, landed, actions))
        landed[:, :, 1] -= law[:, None]
        return law + residual, landed

    def best_rewards(self, offsets_m: FloatArray) -> FloatArray:
        """Return the highest predicted reward of a step from each of n offsets (n, groups, 2)."""
        count, actions = len(offsets_m), len(self._actions)
        rewards, _ = self.predict(
            np.repeat(offsets_m, actions, axis=0), np.tile(self._actions, (count, 1))
        )
        stays = self._nearest(offsets_m)[:, self._actions[:, 0]] == self._actions[:, 1]
        best: FloatArray = np.where(stays, -np.inf, rewards.reshape(count, actions)).max(axis=1)
        return best

    def learn(self, offsets_m: FloatArray, actions: IntArray, rewards_m: FloatArray) -> None:
        """Update the residual with simulated rewards.

        Args:
            offsets_m: offsets before each step, (groups, 2), or (n, groups, 2).
            actions: n actions, (n, 2).
            rewards_m: their rewards, (n,).
        """
        landed = self._land(offsets_m, actions)
        features = self._features(offsets_m, landed, actions)
        residuals = rewards_m - self._law(landed)
        # All at once, as each update inverts a matrix; without BLAS, see `BayesianRegression`.
        self._residual.set_evidence(
            self._residual.moments + np.einsum("nd,ne->de", features, features),
            self._residual.products + (features * residuals[:, None]).sum(axis=0),
        )

    def _land(self, offsets_m: FloatArray, actions: IntArray) -> FloatArray:
        """Return the offsets once the group of each action has landed, (n, groups, 2)."""
        landed = np.broadcast_to(offsets_m, (len(actions), self._groups, 2)).copy()
        landed[np.arange(len(actions)), actions[:, 0]] = self._cells_m[actions[:, 1]]
        return landed

    def _law(self, landed_m: FloatArray) -> FloatArray:
        """Return the mean forward offset of all feet, by which the body moves [m], (n,)."""
        mean: FloatArray = (landed_m[:, :, 1] * self._shares).mean(axis=1)
        return mean

    def _features(
        self, offsets_m: FloatArray, landed_m: FloatArray, actions: IntArray
    ) -> FloatArray:
        """Return the features of some actions, (n, features)."""
        count, (group, cell) = len(actions), actions.T
        rows = np.arange(count)
        lands = np.zeros((count, self._groups, self._cells))
        lands[rows, group, cell] = 1
        cells = np.zeros((count, self._groups, self._cells))
        cells[rows[:, None], np.arange(self._groups), self._nearest(landed_m)] = 1
        comes_from = np.zeros((count, self._groups, 2))
        before = np.broadcast_to(offsets_m, landed_m.shape)
        comes_from[rows, group] = before[rows, group] / self._unit_m
        stance = np.zeros((count, self._groups, self._groups, 2))
        stance[rows, group] = landed_m / self._unit_m
        blocks = (np.ones(count), lands, cells, comes_from, stance)
        return np.concatenate([columns.reshape(count, -1) for columns in blocks], axis=1)

    def _nearest(self, offsets_m: FloatArray) -> IntArray:
        """Return the cell nearest to each offset, (…, 2)."""
        distances = ((offsets_m[..., None, :] - self._cells_m) ** 2).sum(axis=-1)
        nearest: IntArray = distances.argmin(axis=-1)
        return nearest
