"""Uninformed search over the next few steps (paper, Algorithms 3 and 4).

Depth 1 is the greedy agent, depth 2 the two-steps-ahead agent. As in the paper nothing of one
decision's tree is kept for the next.
"""

from collections.abc import Sequence

import numpy as np

from app.agents.protocol import AgentState, Expand, Node, Transition
from app.domain.types import Action, Cells, FloatArray


class LookAhead:
    """Simulates every sequence of `depth` actions and takes the first action of the best one.

    Every layer is simulated by one call of `expand`. Of equals the first is taken.
    """

    learns = False

    def __init__(self, expand: Expand, depth: int = 1) -> None:
        self._expand, self._depth = expand, depth

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """The first action of the sequence with the highest sum of rewards."""
        best = self._best_sums([self._expand.here], self._depth)
        return self._expand.here.legal[best.first[0]]

    def learn(self, transition: Transition) -> None:
        """Nothing: it knows the simulation."""

    def state(self) -> AgentState:
        return {}

    def load(self, state: AgentState) -> None:
        pass

    def _best_sums(self, nodes: Sequence[Node], depth: int) -> "_Best":
        """For each node the highest sum of `depth` rewards from it, and which action starts it."""
        legal = [node.legal for node in nodes]
        origins = [node for node, actions in zip(nodes, legal, strict=True) for _ in actions]
        children, sums = self._expand(origins, [a for actions in legal for a in actions])
        if depth > 1:
            sums = sums + self._best_sums(children, depth - 1).sums
        ends = np.cumsum([len(actions) for actions in legal])
        return _Best.of(np.split(sums, ends[:-1]))


class _Best:
    """The best child of each node: its sum and its place among the node's legal actions."""

    def __init__(self, sums: FloatArray, first: list[int]) -> None:
        self.sums, self.first = sums, first

    @classmethod
    def of(cls, families: Sequence[FloatArray]) -> "_Best":
        first = [int(sums.argmax()) for sums in families]
        return cls(np.array([s[i] for s, i in zip(families, first, strict=True)]), first)


class Greedy(LookAhead):
    """One step ahead (Algorithm 3): 12 simulated transitions a decision at two divisions."""

    title = "Greedy"
    description = "Simulates every possible step, and takes the best one."
    color = "#56B4E9"

    def __init__(self, expand: Expand) -> None:
        super().__init__(expand, depth=1)


class TwoStep(LookAhead):
    """Two steps ahead (Algorithm 4): 156 simulated transitions a decision at two divisions."""

    title = "Two-step"
    description = "Simulates every possible pair of steps, and takes the best one."
    color = "#009E73"

    def __init__(self, expand: Expand) -> None:
        super().__init__(expand, depth=2)
