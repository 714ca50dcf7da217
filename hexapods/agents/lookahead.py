"""Exhaustive look-ahead search over the next few steps (paper, Algorithms 3 and 4).

Depth 1 is the greedy agent, depth 2 the two-steps-ahead agent. As in the paper, the search tree
of one decision is not reused for the next.
"""

from collections.abc import Sequence

import numpy as np

from hexapods.agents.explanation import Future
from hexapods.agents.protocol import Expand, Node, Problem
from hexapods.agents.search import Depth, Search, action_count, check_depth
from hexapods.domain.types import Action, Cells, FloatArray


class LookAhead(Search):
    """Agent that simulates all sequences of `depth` actions, and takes the best one's first action.

    Breadth-first: each level of the tree is simulated by one call of `expand`. Ties go to the
    first action in the order of `legal`. With A actions in each state, a decision simulates
    A + A² + … + A^depth transitions: 12, 156, 1,884 at two divisions.

    Args:
        expand: simulates the transitions.
        depth: number of steps ahead.
        problem: limits the depth; None for no limit.

    Raises:
        InvalidInput: if a decision would simulate more than `MAX_TRANSITIONS`.
    """

    title = "Look-ahead"
    description = "Simulates every possible sequence of steps, and takes the best one."
    color = "#117733"
    is_memoryless = True

    def __init__(self, expand: Expand, depth: Depth = 3, problem: Problem | None = None) -> None:
        super().__init__(expand)
        if problem is not None:
            self.check_problem(problem, depth)
        self._depth = depth

    @staticmethod
    def check_problem(problem: Problem, depth: int = 1) -> None:
        """Check that the tree of a decision is not too large, if its depth is a setting.

        Raises:
            InvalidInput: if it is.
        """
        actions = action_count(problem)
        sizes, size = [], 0
        for level in range(1, depth + 1):
            size += actions**level
            sizes.append(size)
        check_depth(depth, sizes, actions)

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the first action of the sequence with the highest sum of rewards."""
        legal = self._expand.here.legal
        rewards, sums = self._sums([self._expand.here], self._depth)
        sequences = len(legal) ** (self._depth - 1)
        findings = zip(legal, rewards.tolist(), sums.tolist(), strict=True)
        self._futures = {
            action: Future(action, reward, best, sequences, self._depth)
            for action, reward, best in findings
        }
        return legal[int(sums.argmax())]

    def _sums(self, nodes: Sequence[Node], depth: int) -> tuple[FloatArray, FloatArray]:
        """Return the reward of each node's actions, and the highest sum of `depth` rewards."""
        legal = [node.legal for node in nodes]
        parents = [node for node, actions in zip(nodes, legal, strict=True) for _ in actions]
        children, rewards = self._expand(parents, [a for actions in legal for a in actions])
        if depth == 1:
            return rewards, rewards
        ends = np.cumsum([len(child.legal) for child in children])
        _, sums = self._sums(children, depth - 1)
        best = np.array([later.max() for later in np.split(sums, ends[:-1])])
        return rewards, rewards + best


class Greedy(LookAhead):
    """One-step look-ahead (Algorithm 3): simulates 12 transitions per decision at two divisions."""

    title = "Greedy"
    description = "Simulates every possible step, and takes the best one."
    color = "#56B4E9"
    is_memoryless = True
    steps_ahead = 1

    def __init__(self, expand: Expand) -> None:
        super().__init__(expand, depth=self.steps_ahead)


class TwoStep(LookAhead):
    """Two-step look-ahead (Algorithm 4): simulates 156 transitions a decision at two divisions."""

    title = "Two-step"
    description = "Simulates every possible pair of steps, and takes the best one."
    color = "#009E73"
    is_memoryless = True
    steps_ahead = 2

    def __init__(self, expand: Expand) -> None:
        super().__init__(expand, depth=self.steps_ahead)
