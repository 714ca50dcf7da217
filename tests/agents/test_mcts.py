"""Monte Carlo tree search: choices on a hand-made graph, its budget, and its determinism."""

import numpy as np
import pytest

from hexapods.agents.mcts import HORIZON, Mcts
from hexapods.domain.types import Action
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


@pytest.mark.parametrize("seed", range(8))
def test_with_two_transitions_the_better_of_two_first_steps_is_taken(seed: int) -> None:
    """The first steps of A earn 3, 1 and 2: which two are tried is random, not which is taken."""
    rewards = dict(zip(((0, 0), (0, 1), (0, 2)), (3.0, 1.0, 2.0), strict=True))
    world = Graph(WORLD)
    taken = Mcts(world, np.random.default_rng(seed), budget=2).act((0,), ())

    assert world.calls == [1, 1]
    assert rewards[taken] >= 2


def test_sequence_that_the_budget_cuts_short_counts() -> None:
    """Of seven transitions the last begins a third sequence, perhaps with the best first step."""
    world: World = {"A": [("B", 0.0), ("B", 0.0), ("B", 9.0)], "B": [("B", 0.0), ("B", 0.0)]}
    for seed in range(8):
        assert Mcts(Graph(world), np.random.default_rng(seed), budget=7).act((0,), ()) == (0, 2)


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
