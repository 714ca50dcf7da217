"""Building of simulators, learners and walkers from configs."""

from dataclasses import replace
from typing import Any

import pytest

from hexapods.agents.lookahead import Greedy, TwoStep
from hexapods.agents.protocol import Transition
from hexapods.agents.q_learning import QLearning
from hexapods.assembly import build_learner, build_simulator, build_walkers
from hexapods.domain.errors import InvalidInput, TableMismatch, UnknownName, Unreachable
from hexapods.domain.gait import GaitSpec
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.observation import OBSERVATIONS, Observation, observe
from hexapods.domain.robot import Robot, robot
from hexapods.domain.settings import SettingValues
from hexapods.physics.mujoco_simulator import MujocoSimulator
from hexapods.runs.config import WalkingProblem, training_config
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.tables import Checkpoint, snapshot
from hexapods.runs.training import train
from hexapods.runs.walker import FutureNode
from tests import own_agents

CONFIG = training_config(
    gait="left-right-origin", simulator="kinematic", steps=150, evaluate_every=0
)
RACE = RaceConfig(
    gait="left-right-origin",
    simulator="kinematic",
    lanes=(
        LaneConfig(agent="q-learning"),
        LaneConfig(agent="greedy"),
        LaneConfig(agent="two-step"),
    ),
)


@pytest.fixture(scope="module")
def table() -> Checkpoint:
    learner = build_learner(CONFIG)
    for _ in train(learner, CONFIG):
        pass
    return snapshot(learner, CONFIG)


def test_simulator_is_that_of_the_config() -> None:
    eight_legs = robot({"n_legs": 8})
    walk = WalkingProblem(
        gait="front-back-vertical", robot=eight_legs, divisions=3, grid_side_m=0.03
    )
    physics, law = build_simulator(walk), build_simulator(replace(walk, simulator="kinematic"))

    assert isinstance(physics, MujocoSimulator)
    assert isinstance(law, KinematicSimulator)
    for simulator in (physics, law):
        assert simulator.robot is eight_legs
        assert len(simulator.grid) == 9
        assert simulator.grid.side_m == 0.03
        assert simulator.gait.groups == ((1, 3), (8, 4), (7, 5), (2, 6))


@pytest.mark.parametrize("simulator", ["mujoco", "kinematic"])
def test_unreachable_grid_is_refused_with_leg_and_cell(simulator: Any) -> None:
    with pytest.raises(Unreachable, match=r"leg 2 cannot reach cell 1 \(front left\)"):
        build_simulator(
            WalkingProblem(gait="left-right-origin", grid_side_m=0.2, simulator=simulator)
        )


def test_learner_has_the_rates_of_the_config() -> None:
    learner = build_learner(
        replace(
            CONFIG, settings=CONFIG.settings | {"alpha": 0.2, "gamma": 0.5, "epsilon_start": 0.7}
        )
    )

    assert learner.walker.agent.state()["rates"][:2].tolist() == [0.2, 0.5]
    assert learner.epsilon == 0.7


def test_learning_evaluation_and_racing_have_independent_generators(
    table: Checkpoint,
) -> None:
    learner, *_ = build_walkers(RACE, [table, None, None])
    racing = [a.action for a in _walk(learner)]

    assert racing == [a.action for a in _walk(build_walkers(RACE, [table, None, None])[0])]


def _walk(walker: Any) -> list[Any]:
    class Taken:
        def __init__(self) -> None:
            self.action = walker.decide()
            walker.carry_out(self.action)

    return [Taken() for _ in range(10)]


def test_walkers_are_in_lane_order_and_at_rest(table: Checkpoint) -> None:
    walkers = build_walkers(RACE, [table, None, None])

    assert [type(walker.agent) for walker in walkers] == [QLearning, Greedy, TwoStep]
    assert [walker.state.distance_m for walker in walkers] == [0, 0, 0]
    assert [walker.transitions for walker in walkers] == [0, 0, 0]


def test_trained_lane_races_without_exploring(table: Checkpoint) -> None:
    learner = build_walkers(RACE, [table, None, None])[0]
    agent = learner.agent

    assert isinstance(agent, QLearning)
    assert agent.epsilon == 0
    assert agent.table.dump()["n"].astype(int).sum() == 150


def test_table_of_another_walking_problem_is_refused(table: Checkpoint) -> None:
    with pytest.raises(TableMismatch, match="for divisions 2, this run has 3"):
        build_walkers(replace(RACE, divisions=3), [table, None, None])
    commanded = replace(
        RACE, lanes=(LaneConfig(agent="q-learning", observation="commanded"), *RACE.lanes[1:])
    )
    with pytest.raises(TableMismatch, match="for observation measured, this run has commanded"):
        build_walkers(commanded, [table, None, None])


def test_table_of_another_agent_is_refused(table: Checkpoint) -> None:
    lanes = (LaneConfig(agent="tests.own_agents:Restless"),)
    with pytest.raises(TableMismatch, match="Restless cannot load what q-learning has learned"):
        build_walkers(replace(RACE, lanes=lanes), [table])


def test_number_of_tables_must_equal_the_number_of_lanes(table: Checkpoint) -> None:
    with pytest.raises(ValueError, match="zip"):
        build_walkers(RACE, [table])


def test_user_supplied_agent_trains_and_races() -> None:
    config = replace(CONFIG, agent="tests.own_agents:Restless", settings=SettingValues({}))
    learner = build_learner(config)
    race = replace(RACE, lanes=(LaneConfig(agent="tests.own_agents:Restless"),))
    (walker,) = build_walkers(race, [None])

    assert isinstance(learner.walker.agent, own_agents.Restless)
    assert isinstance(walker.agent, own_agents.Restless)
    assert walker.agent.problem.groups == ((1, 4), (2, 5), (3, 6))
    assert walker.agent.problem.cells_m.shape == (5, 2)


def test_user_supplied_look_ahead_agent_gets_a_simulator_that_counts() -> None:
    race = replace(RACE, lanes=(LaneConfig(agent="tests.own_agents:ThreeStep"),))
    (walker,) = build_walkers(race, [None])
    walker.decide()

    assert walker.transitions == 12 + 144 + 1728


def test_unusable_agent_is_refused_with_the_reason() -> None:
    with pytest.raises(InvalidInput, match=r"asks for crystal_ball; on offer: .*problem.*rng"):
        build_learner(replace(CONFIG, agent="tests.own_agents:Needy", settings=SettingValues({})))
    with pytest.raises(UnknownName, match="unknown agent 'dijkstra'"):
        build_learner(replace(CONFIG, agent="dijkstra"))


def test_user_defined_gait_walks() -> None:
    """Explicit leg pairs; the forward direction is between legs 6 and 1."""
    gait = GaitSpec(6, 1, pairs=((6, 1), (5, 2), (4, 3)))
    race = replace(RACE, gait=gait, simulator="mujoco", lanes=(LaneConfig(agent="greedy"),))
    (walker,) = build_walkers(race, [None], threads=1)
    for _ in range(6):
        walker.carry_out(walker.decide())

    assert 0.03 < walker.state.distance_m < 0.07
    assert abs(walker.simulator.pose(walker.state)[0]) < 0.01


@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_agent_may_read_the_current_state_in_every_way(observation: Observation) -> None:
    config = training_config(
        gait="left-right-vertical", agent="tests.own_agents:Attentive", observation=observation
    )
    learner = build_learner(config)
    walker, simulator = learner.walker, learner.walker.simulator
    assert isinstance(walker.agent, own_agents.Attentive)
    expected = []
    for _ in range(30):
        expected.append({how: observe(simulator, walker.state, how) for how in OBSERVATIONS})
        before, action = walker.observed, walker.decide()
        step = walker.carry_out(action)
        walker.agent.learn(Transition(before, action, step.reward_m, walker.observed, walker.legal))
        expected.append({how: observe(simulator, walker.state, how) for how in OBSERVATIONS})

    assert walker.agent.read == expected
    assert any(len(set(read.values())) > 1 for read in walker.agent.read)


def test_a_seed_draws_the_robot_that_all_lanes_walk_with() -> None:
    lanes = (
        LaneConfig(agent="greedy"),
        LaneConfig(agent="informed"),
        LaneConfig(agent="greedy", plans_with="nominal"),
    )
    config = RaceConfig(gait="left-right-origin", lanes=lanes, tolerance=0.1, seed=4)
    walkers = build_walkers(config, [None, None, None], threads=1)
    action = walkers[0].legal[0]
    foreseen = []
    for walker in walkers:
        assert walker.expand is not None
        (node,), _ = walker.expand([walker.expand.here], [action])
        assert isinstance(node, FutureNode)
        foreseen.append(node.state.distance_m)
    ends = [walker.carry_out(action).state for walker in walkers]

    assert len({end.row.tobytes() for end in ends}) == 1
    assert foreseen[0] == foreseen[1] == ends[0].distance_m
    assert foreseen[2] != ends[2].distance_m  # it plans with the robot as designed
    assert replace(config, seed=5).built_robot != config.built_robot != Robot()


def test_training_and_race_of_a_seed_walk_with_the_same_robot() -> None:
    training = training_config(gait="left-right-origin", tolerance=0.05, seed=3)
    race = RaceConfig(
        gait="left-right-origin", lanes=(LaneConfig(agent="greedy"),), tolerance=0.05, seed=3
    )

    assert training.built_robot == race.built_robot != Robot()
    assert replace(training, tolerance=0.0).built_robot == Robot()


def test_kinematic_simulator_knows_no_tolerance() -> None:
    with pytest.raises(InvalidInput, match="knows no build tolerance"):
        WalkingProblem(gait="left-right-origin", simulator="kinematic", tolerance=0.03)
