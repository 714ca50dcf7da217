"""Monte Carlo tree search: choices on a hand-made graph, its budget, and its determinism."""

import numpy as np
import pytest

from app.agents.mcts import HORIZON, Mcts
from app.domain.types import Action
from tests.agents.trees import Graph, World
from tests.agents.walkers import kinematic_walker

# The best first step leads nowhere; the best sequence of three earns 8, and begins with (0, 1).
WORLD: World = {
    "A": [("B", 3.0), ("C", 1.0), ("B", 2.0)],
    "B": [("B", 0.0), ("B", 0.0)],
    "C": [("C", 1.0), ("D", 2.0)],
    "D": [("D", 5.0), ("B", 0.0)],
}


@pytest.mark.parametrize("seed", range(5))
def test_most_sequences_begin_with_the_step_that_ends_best(seed: int) -> None:
    search = Mcts(Graph(WORLD), np.random.default_rng(seed), budget=60)

    assert search.act((0,), ()) == (0, 1)


@pytest.mark.parametrize("budget", [1, 2, 7, 60])
def test_no_more_than_the_budget_is_simulated(budget: int) -> None:
    walker, expand = kinematic_walker(
        lambda expand: Mcts(expand, np.random.default_rng(0), budget=budget)
    )
    walker.decide()

    assert expand.transitions == budget


def test_known_sequences_cost_nothing() -> None:
    """Of this graph there are 3 · 2 · 2 sequences, of 3 + 6 + 12 transitions."""
    world = Graph(WORLD)
    Mcts(world, np.random.default_rng(0), budget=10_000).act((0,), ())

    assert HORIZON == 3
    assert sum(world.calls) == 3 + 6 + 12


def test_the_generator_alone_decides() -> None:
    def walk(seed: int) -> list[Action]:
        rng = np.random.default_rng(seed)
        walker, _ = kinematic_walker(lambda expand: Mcts(expand, rng, budget=30))
        chosen = []
        for _ in range(10):
            chosen.append(walker.decide())
            walker.carry_out(chosen[-1])
        return chosen

    assert walk(1) == walk(1)
    assert walk(1) != walk(2)
