"""Beam search over the next few steps (Lowerre 1976; Russell and Norvig 2021, §4.1.3)."""

from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from hexapods.agents.protocol import Expand, Node, Problem
from hexapods.agents.search import Depth, Search, Width, action_count, check_depth
from hexapods.domain.types import Action, Cells


class Beam(Search):
    """Look-ahead that follows only the `width` sequences with the highest sums of rewards.

    Of each layer of the tree the nodes with the highest sums are expanded, with all their actions,
    by one call of `expand`; ties go to the sequence that comes first. With A actions in each state,
    a decision simulates at most A + (depth − 1) · width · A transitions. With a width of
    A^(depth−1) it is the exhaustive look-ahead; with less it may drop the best sequence, if that
    begins with low rewards.

    Args:
        expand: simulates the transitions.
        problem: limits width and depth; None for no limit.
        width: number of sequences that are followed.
        depth: number of steps ahead.

    Raises:
        InvalidInput: if a decision would simulate more than `MAX_TRANSITIONS`.
    """

    title = "Beam"
    description = "Looks several steps ahead, and follows only the best few sequences."
    color = "#CC79A7"
    is_memoryless = True

    def __init__(
        self,
        expand: Expand,
        problem: Problem | None = None,
        *,
        width: Width = 8,
        depth: Depth = 3,
    ) -> None:
        super().__init__(expand)
        if problem is not None:
            self.check_problem(problem, width, depth)
        self._width, self._depth = width, depth

    @staticmethod
    def check_problem(problem: Problem, width: int, depth: int) -> None:
        """Check that the search of a decision is not too large.

        Raises:
            InvalidInput: if it is.
        """
        actions = action_count(problem)
        parents = [min(width, actions**level) for level in range(depth)]
        sizes = [actions * count for count in accumulate(parents)]
        check_depth(depth, sizes, actions)

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the first action of the best sequence that is left at the last layer."""
        nodes: Sequence[Node] = [self._expand.here]
        sums, first = np.zeros(1), [-1]
        root = self._expand.here.legal
        for step in range(self._depth):
            branches = [node.legal for node in nodes]
            parents = [index for index, actions in enumerate(branches) for _ in actions]
            children, rewards = self._expand(
                [nodes[index] for index in parents],
                [action for each in branches for action in each],
            )
            sums = sums[parents] + rewards
            first = [
                number if first[parent] == -1 else first[parent]
                for number, parent in enumerate(parents)
            ]
            self._record_futures([root[number] for number in first], sums.tolist(), step + 1)
            best = np.argsort(-sums, kind="stable")[: self._width].tolist()
            nodes, sums, first = [children[i] for i in best], sums[best], [first[i] for i in best]
        return root[first[0]]
