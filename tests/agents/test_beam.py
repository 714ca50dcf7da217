"""Beam search: which sequences are followed, and what they cost."""

import pytest

from hexapods.agents.beam import Beam
from hexapods.agents.lookahead import LookAhead
from hexapods.agents.protocol import Problem
from hexapods.domain.errors import InvalidInput
from hexapods.domain.grid import FootGrid
from tests.agents.trees import Graph, World
from tests.agents.walkers import kinematic_walker

# A's steps earn 3, 2 and 1; the best sequence of three begins with the worst of them.
PROBLEM = Problem(((1, 4), (2, 5), (3, 6)), FootGrid().cells)
WORLD: World = {
    "A": [("B", 3.0), ("C", 2.0), ("D", 1.0)],
    "B": [("E", 0.0), ("E", 0.5)],
    "C": [("E", 2.0), ("F", 0.0)],
    "D": [("F", 4.5)],
    "E": [("E", 1.0)],
    "F": [("F", 9.0), ("E", 0.0)],
}


@pytest.mark.parametrize(
    ("width", "depth", "first", "calls"),
    [
        (1, 1, 0, [3]),  # greedy
        (1, 2, 0, [3, 2]),  # follows B alone: 3 + 0.5
        (2, 2, 1, [3, 4]),  # follows B and C: 2 + 2 beats 3 + 0.5
        (3, 2, 2, [3, 5]),  # all of them: 1 + 4.5
        (2, 3, 1, [3, 4, 2]),  # D was dropped: C, E, E earns 5, B, E, E 4.5
        (3, 3, 2, [3, 5, 4]),  # D, F, F earns 14.5
    ],
)
def test_only_the_best_sums_are_followed(
    width: int, depth: int, first: int, calls: list[int]
) -> None:
    world = Graph(WORLD)

    assert Beam(world, width=width, depth=depth).act((0,), ()) == (0, first)
    assert world.calls == calls


def test_ties_go_to_the_first_sequence() -> None:
    world = Graph({"A": [("A", 1.0), ("A", 1.0)]})

    assert Beam(world, width=1, depth=3).act((0,), ()) == (0, 0)


def test_wide_beam_is_the_exhaustive_search() -> None:
    """The same decisions over twenty steps of the kinematic simulator."""
    beam, _ = kinematic_walker(lambda expand: Beam(expand, width=12, depth=2))
    exhaustive, _ = kinematic_walker(lambda expand: LookAhead(expand, 2))
    for _ in range(20):
        action = beam.decide()
        assert action == exhaustive.decide()
        beam.carry_out(action)
        exhaustive.carry_out(action)
    assert beam.transitions == exhaustive.transitions == 20 * 156


def test_decision_costs_at_most_one_expansion_a_sequence_and_layer() -> None:
    walker, expand = kinematic_walker(lambda expand: Beam(expand, width=4, depth=3))
    walker.decide()

    assert expand.transitions == 12 + 4 * 12 + 4 * 12


def test_search_that_is_too_large_is_refused() -> None:
    Beam(Graph({}), PROBLEM, width=1000, depth=4)

    with pytest.raises(InvalidInput, match=r"depth 8 would simulate more than 40,000.*depth 6 or"):
        Beam(Graph({}), PROBLEM, width=1000, depth=8)
