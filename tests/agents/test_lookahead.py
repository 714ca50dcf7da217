"""Look-ahead agents: chosen actions, and number of simulated transitions."""

from itertools import product

import numpy as np
import pytest

from hexapods.agents.lookahead import Greedy, LookAhead, TwoStep
from hexapods.agents.protocol import Problem
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import PAPER_GAITS
from hexapods.domain.grid import FootGrid
from hexapods.runs.walker import SimulatorExpand, Walker
from tests.agents.trees import Graph, World
from tests.agents.walkers import kinematic_walker

HOME, FRONT_LEFT, FRONT_RIGHT, BACK_LEFT, BACK_RIGHT = range(5)


def walker(
    depth: int, gait: str = "left-right-origin", divisions: int = 2
) -> tuple[Walker, SimulatorExpand]:
    return kinematic_walker(lambda expand: LookAhead(expand, depth), gait, divisions)


@pytest.mark.parametrize(("depth", "transitions"), [(1, 12), (2, 156), (3, 1884)])
def test_decision_simulates_every_sequence_once(depth: int, transitions: int) -> None:
    robot, expand = walker(depth)
    robot.decide()

    assert expand.transitions == transitions
    assert transitions == sum(12**d for d in range(1, depth + 1))


def test_at_three_divisions_there_are_24_actions() -> None:
    robot, expand = walker(2, divisions=3)
    robot.decide()

    assert expand.transitions == 24 + 24 * 24


@pytest.mark.parametrize(
    ("divisions", "depth", "message"),
    [
        (2, 5, "depth 5 would simulate more than 40,000 transitions.*choose depth 4 or less"),
        (3, 4, "with 24 actions in each state.*choose depth 3 or less, or fewer divisions"),
        (8, 3, "choose depth 2 or less"),
    ],
)
def test_tree_that_is_too_large_is_refused(divisions: int, depth: int, message: str) -> None:
    problem = Problem(((1, 4), (2, 5), (3, 6)), FootGrid(divisions=divisions).cells)

    with pytest.raises(InvalidInput, match=message):
        LookAhead(Graph({}), depth, problem)


@pytest.mark.parametrize(("depth", "transitions"), [(1, 600), (2, 7_800)])
def test_search_depth_is_constant_over_fifty_steps(depth: int, transitions: int) -> None:
    robot, expand = walker(depth)
    for _ in range(50):
        robot.carry_out(robot.decide())

    assert expand.transitions == robot.transitions == transitions


@pytest.mark.parametrize("gait", PAPER_GAITS)
def test_greedy_moves_the_pairs_to_the_front_in_turn(gait: str) -> None:
    """Ties go to the first: pair 1 before 2, left before right; then to the rearmost pair."""
    robot, _ = walker(1, gait)
    chosen = []
    for _ in range(9):
        chosen.append(robot.decide())
        robot.carry_out(chosen[-1])

    assert chosen[:3] == [(0, FRONT_LEFT), (1, FRONT_LEFT), (2, FRONT_LEFT)]
    assert [action.group for action in chosen] == [0, 1, 2] * 3
    assert {action.cell for action in chosen} <= {FRONT_LEFT, FRONT_RIGHT}


@pytest.mark.parametrize("depth", [1, 2, 3])
def test_first_action_of_the_best_sequence_is_chosen(depth: int) -> None:
    """Compare with a recursive search over all sequences, from states along a random walk."""
    robot, _ = walker(depth)
    simulator, rng = robot.simulator, np.random.default_rng(depth)

    def best_sum(state: object, left: int) -> float:
        if left == 0:
            return 0.0
        robot.set_state(state)  # type: ignore[arg-type]
        sums = []
        for action in robot.legal:
            step = simulator.step(state, action)
            sums.append(step.reward_m + best_sum(step.state, left - 1))
            robot.set_state(state)  # type: ignore[arg-type]
        return max(sums)

    for _ in range(3 if depth == 3 else 8):
        state = robot.state
        chosen = robot.decide()
        step = simulator.step(state, chosen)
        worth = step.reward_m + best_sum(step.state, depth - 1)
        assert worth == pytest.approx(best_sum(state, depth), abs=1e-12)
        robot.set_state(state)
        robot.carry_out(robot.legal[int(rng.integers(len(robot.legal)))])


# The best step from A leads to a place with low rewards only.
TRAP_DOOR: World = {
    "A": [("B", 1.0), ("C", 0.5), ("D", 0.4), ("D", 0.4)],
    "B": [("A", -5.0)],
    "C": [("A", 0.1), ("A", 0.2)],
    "D": [("A", 0.1), ("A", 0.5), ("A", 0.0)],
}


def test_greedy_takes_the_best_first_step_even_if_it_is_worse_later() -> None:
    assert Greedy(Graph(TRAP_DOOR)).act((0,), ()) == (0, 0)


def test_two_step_maximises_the_sum_and_ties_go_to_the_first() -> None:
    world = Graph(TRAP_DOOR)

    assert TwoStep(world).act((0,), ()) == (0, 2)
    assert world.calls == [4, 1 + 2 + 3 + 3]  # a layer a call, and a family may have any size


def test_layers_in_several_batches_give_the_same_decisions(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, _ = walker(2)
    in_parts, expand = walker(2)
    for _ in range(4):
        whole.carry_out(whole.decide())
        with monkeypatch.context() as context:
            context.setattr("hexapods.runs.walker._MAX_BATCH", 5)
            in_parts.carry_out(in_parts.decide())

    assert in_parts.state == whole.state
    assert expand.transitions == 4 * 156


def test_every_pair_moves_at_each_gait_and_depth() -> None:
    for gait, depth in product(PAPER_GAITS, (1, 2)):
        robot, _ = walker(depth, gait)
        moved = set()
        for _ in range(6):
            action = robot.decide()
            moved.add(action.group)
            robot.carry_out(action)
        assert moved == {0, 1, 2}
