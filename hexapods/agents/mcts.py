"""Monte Carlo tree search: UCT (Kocsis and Szepesvári 2006), within a budget of transitions."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from hexapods.agents.explanation import Future
from hexapods.agents.protocol import Expand, Node
from hexapods.agents.search import Budget, Search
from hexapods.domain.sums import ordered_sum
from hexapods.domain.types import Action, Cells

HORIZON = 3
"""Length of a simulated sequence of steps, if the budget pays for two of them."""
EXPLORATION = 1 / math.sqrt(2)
"""Constant of the upper confidence bound, for returns from 0 to 1 (Kocsis and Szepesvári, §2.3)."""


@dataclass
class _TreeNode:
    """Node of the tree: its simulated actions, and the returns of the sequences through it."""

    node: Node
    reward_m: float = 0.0
    """Reward of the step that leads to this node."""
    visits: int = 0
    total_m: float = 0.0
    """Sum of the returns of the sequences through this node."""
    children: dict[Action, "_TreeNode"] = field(default_factory=dict)


class Mcts(Search):
    """Agent that simulates random sequences of steps, more of those with promising first steps.

    Each sequence has `HORIZON` steps, with a small budget fewer, so that at least two first steps
    are compared: through the tree by the upper confidence bound of their returns, which are
    normalised to the range seen so far in the decision, then at random. Steps are deterministic, so
    each is simulated once and stored: a sequence costs only its new steps. The last sequence, which
    the budget may cut short, counts by its mean reward. The action with which most sequences began
    is taken; ties go to the higher mean return. Each decision builds a new tree.

    Args:
        expand: simulates the transitions.
        rng: random generator of the sequences.
        budget: maximum of transitions simulated for a decision.
    """

    title = "Tree search"
    description = "Simulates random sequences of steps, more of those that begin well."
    color = "#D14A00"
    compares = "number of sequences that begin with it, then their mean sum of rewards"

    def __init__(self, expand: Expand, rng: np.random.Generator, *, budget: Budget = 156) -> None:
        super().__init__(expand)
        self._rng, self._budget = rng, budget
        self._horizon = max(1, min(HORIZON, budget // 2))

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        """Return the action with which most of the simulated sequences began."""
        root = _TreeNode(self._expand.here)
        self._left = self._budget
        self._lowest, self._highest = math.inf, -math.inf
        # Sequences without a new step cost nothing, so that their number is limited too.
        for _ in range(self._budget):
            if self._left <= 0:
                break
            self._simulate(root)
        self._futures = {
            action: Future(
                action, child.reward_m, child.total_m / child.visits, child.visits, self._horizon
            )
            for action, child in root.children.items()
            if child.visits
        }
        return max(root.children, key=lambda action: _rank(root.children[action]))

    def _simulate(self, root: _TreeNode) -> None:
        """Simulate one sequence of steps, and add its return to all nodes on its way."""
        path, tree_node, is_in_tree = [root], root, True
        while len(path) <= self._horizon:
            untried = [
                action for action in tree_node.node.legal if action not in tree_node.children
            ]
            if untried and is_in_tree:
                is_in_tree = False
                action = self._random(untried)
            elif is_in_tree:
                action = self._most_promising(tree_node)
            else:
                action = self._random(tree_node.node.legal)
            if action not in tree_node.children:
                if self._left == 0:
                    break
                tree_node.children[action] = self._step(tree_node, action)
            tree_node = tree_node.children[action]
            path.append(tree_node)
        stretch = self._horizon / (len(path) - 1)  # over 1 if the budget cut it short
        total_m = stretch * ordered_sum(visited.reward_m for visited in path)
        self._lowest, self._highest = min(self._lowest, total_m), max(self._highest, total_m)
        for visited in path:
            visited.visits += 1
            visited.total_m += total_m

    def _step(self, tree_node: _TreeNode, action: Action) -> _TreeNode:
        (node,), (reward_m,) = self._expand([tree_node.node], [action])
        self._left -= 1
        return _TreeNode(node, float(reward_m))

    def _random(self, actions: Sequence[Action]) -> Action:
        return actions[int(self._rng.integers(len(actions)))]

    def _most_promising(self, tree_node: _TreeNode) -> Action:
        """Return the action with the highest upper confidence bound (UCB1)."""
        span = max(self._highest - self._lowest, 1e-12)
        logarithm = math.log(max(1, tree_node.visits))

        def bound(action: Action) -> float:
            child = tree_node.children[action]
            if child.visits == 0:
                return math.inf
            mean = (child.total_m / child.visits - self._lowest) / span
            return mean + 2 * EXPLORATION * math.sqrt(logarithm / child.visits)

        return max(tree_node.children, key=bound)


def _rank(tree_node: _TreeNode) -> tuple[int, float]:
    return tree_node.visits, tree_node.total_m / max(1, tree_node.visits)
