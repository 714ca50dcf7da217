"""Informed search: its heuristic, what it learns of the simulator, its budget and its figures."""

from collections.abc import Sequence

import numpy as np
import pytest

from hexapods.agents.informed import Informed, RewardModel, shares_of
from hexapods.agents.protocol import Problem
from hexapods.assembly import build_walkers
from hexapods.domain.feet import Feet
from hexapods.domain.gait import PAPER_GAITS
from hexapods.domain.grid import FootGrid
from hexapods.domain.robot import robot
from hexapods.domain.types import Action
from hexapods.runs.lane import LaneConfig, lane_config
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.racing import record_race
from hexapods.runs.results import LaneResult, race_result
from tests.agents.walkers import kinematic_walker
from tests.promises.length import at_length, only_whole
from tests.quick_robot import HASTY

GRID = FootGrid()
PROBLEM = Problem(((1, 4), (2, 5), (3, 6)), GRID.cells)
HOME = np.zeros((3, 2))


def test_beforehand_the_model_is_the_kinematic_law() -> None:
    """Home, pair 2 to the front left: the body moves by a third of half the side."""
    model, landed = RewardModel(PROBLEM), Feet.at_home(3).landed(1, 1, GRID.places_m[1])
    advance_m = landed.mean_m((2, 2, 2))
    after = landed.shifted(advance_m)

    rewards, ends = model.predict(HOME, np.array([[1, 1]]))

    assert advance_m == pytest.approx(0.02 / 3)
    assert rewards.tolist() == pytest.approx([advance_m])
    assert ends[0, :, 0].tolist() == pytest.approx(after.lateral_m)
    assert ends[0, :, 1].tolist() == pytest.approx(after.forward_m)


def test_pair_may_not_stay_in_the_best_next_step() -> None:
    """All pairs are at the front left: what is left is the front right, which gains nothing."""
    front = np.array([[GRID.cells[1]] * 3])

    assert RewardModel(PROBLEM).best_rewards(front).tolist() == pytest.approx([0.02])
    assert RewardModel(PROBLEM).best_rewards(front - [0, 0.02]).tolist() == pytest.approx(
        [0.02 / 3]
    )


def test_model_learns_what_the_law_does_not_know() -> None:
    """Pair 1 slips on one cell: half of the law's reward there, and no other cell is affected."""
    model = RewardModel(PROBLEM)
    slips, holds = Action(0, 1), Action(2, 1)
    law = 0.02 / 3
    for _ in range(20):
        model.learn(HOME, np.array([slips, holds]), np.array([law / 2, law]))

    rewards, _ = model.predict(HOME, np.array([slips, holds]))
    assert rewards.tolist() == pytest.approx([law / 2, law], rel=0.05)


def test_prediction_does_not_depend_on_how_many_are_made_at_once() -> None:
    model, rng = RewardModel(PROBLEM), np.random.default_rng(0)
    actions = np.array([[pair, cell] for pair in range(3) for cell in range(5)])
    offsets = rng.uniform(-0.02, 0.02, (3, 2))
    model.learn(offsets, actions, rng.normal(0, 0.01, len(actions)))
    together, _ = model.predict(offsets, actions)

    assert together.tolist() == [model.predict(offsets, action[None])[0][0] for action in actions]


@pytest.mark.parametrize(
    ("budget", "shares"),
    [(1, [1]), (3, [3]), (19, [19]), (20, [8, 12]), (40, [10, 15, 15]), (1000, [250, 375, 375])],
)
def test_budget_is_shared_by_at_most_three_layers(budget: int, shares: list[int]) -> None:
    assert shares_of(budget) == shares


@pytest.mark.parametrize("budget", [1, 3, 25, 40, 500])
def test_no_more_than_the_budget_is_simulated(budget: int) -> None:
    walker, expand = kinematic_walker(lambda expand: Informed(expand, PROBLEM, budget=budget))
    for step in range(1, 4):
        walker.carry_out(walker.decide())
        assert expand.transitions <= budget * step
    assert expand.transitions == 3 * budget or budget > 12


@pytest.mark.parametrize("gait", PAPER_GAITS)
def test_three_transitions_are_as_good_as_all_where_the_law_holds(gait: str) -> None:
    walker, expand = kinematic_walker(lambda expand: Informed(expand, PROBLEM, budget=3), gait)
    for _ in range(50):
        walker.carry_out(walker.decide())

    assert walker.state.distance_m == pytest.approx(24.833 * 0.02, rel=0.01)
    assert expand.transitions == 150


def raced(preset: str, gait: str, *lanes: LaneConfig, threads: int = 1) -> Sequence[LaneResult]:
    """Return the results of the lanes of a race over MuJoCo."""
    config = RaceConfig(gait=gait, robot=robot(preset), lanes=lanes)
    walkers = build_walkers(config, [None] * len(lanes), threads=threads)
    *_, recorded = record_race(walkers, config, lambda: 0.0)
    return race_result(recorded, config).lanes


GAITS = at_length(["left-right-vertical"], [*PAPER_GAITS])


@pytest.mark.test
@pytest.mark.parametrize("gait", GAITS)
def test_informed_search_overtakes_greedy_on_the_stiff_robot(gait: str) -> None:
    informed, greedy = raced("stiff", gait, lane_config("informed"), lane_config("greedy"))

    assert (informed.total_distance_m or 0) >= 0.98 * (greedy.total_distance_m or 0)
    assert informed.simulated_transitions <= 3 * 50
    at_time_out = [lane.clocks.paper.finished_distance_m or 0 for lane in (informed, greedy)]
    assert at_time_out[0] > at_time_out[1]


TWO_STEP_M = {"slippery": 0.617, "compliant": 0.447}
"""Distances of two-step in left-right-vertical, which the soak measures again."""
LANES = ("informed", "two-step")


@only_whole  # the budget and its layers are shown above, by the kinematic law
@pytest.mark.parametrize("preset", [*TWO_STEP_M])
def test_forty_transitions_are_worth_two_steps_of_look_ahead(preset: str) -> None:
    chosen = {"informed": lane_config("informed", budget=40), "two-step": lane_config("two-step")}
    lanes = [chosen[agent] for agent in LANES]
    informed, *two_step = raced(preset, "left-right-vertical", *lanes, threads=0)

    assert (informed.total_distance_m or 0) >= TWO_STEP_M[preset]
    assert informed.simulated_transitions <= 40 * 50
    for lane in two_step:
        assert (lane.total_distance_m or 0) == pytest.approx(TWO_STEP_M[preset], abs=0.0006)
        assert (informed.total_distance_m or 0) >= (lane.total_distance_m or 0)


@pytest.mark.parametrize("agent", ["informed", "mcts", "beam"])
def test_results_do_not_depend_on_the_number_of_threads(agent: str) -> None:
    def states(threads: int) -> list[bytes]:
        config = RaceConfig(gait="left-right-vertical", robot=HASTY, lanes=(lane_config(agent),))
        (walker,) = build_walkers(config, [None], threads=threads)
        poses = []
        for _ in range(2):
            walker.carry_out(walker.decide())
            poses.append(walker.simulator.pose(walker.state).tobytes())
        return poses

    assert states(1) == states(2)
