"""Composition root of runs: builds simulators, learners and walkers from configs.

The only module that imports the concrete simulators; loops and commands use what it builds.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from hexapods.agents import registry
from hexapods.agents.protocol import Agent, Problem, Tabular
from hexapods.domain.errors import InvalidInput
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.observation import Observation
from hexapods.domain.settings import complete
from hexapods.domain.simulator import Simulator
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.config import TrainingConfig, WalkingProblem, agent_settings
from hexapods.runs.lane import LaneConfig, check_lane
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.rebuilding import LoggedSensors, RebuiltLearner
from hexapods.runs.seeding import EVALUATION, LEARNING, RACING, SENSING, generator
from hexapods.runs.tables import Checkpoint, check_fits, continue_from, load_agent
from hexapods.runs.training import Learner
from hexapods.runs.walker import Sensors, SimulatorExpand, Walker

_NOT_OFFERED = ("settings", "world", "tolerance")
"""Fields of a training that its agent's constructor does not get: no agent is told of the world."""


def build_simulator(walk: WalkingProblem, threads: int = 1) -> Simulator[Any]:
    """Create the simulator of a walking problem.

    Args:
        walk: the walking problem.
        threads: number of threads of look-ahead in MuJoCo; 0 for one per core.

    Raises:
        Unreachable: if the robot's legs cannot reach the grid.
    """
    gait, grid = walk.resolved_gait, walk.grid
    if walk.simulator == "kinematic":
        return KinematicSimulator(walk.robot, gait, grid, walk.world)
    # Only here: importing MuJoCo takes as long as a short kinematic training.
    from hexapods.physics.mujoco_simulator import MujocoSimulator  # noqa: PLC0415

    built = walk.built_robot
    return MujocoSimulator(
        walk.robot, gait, grid, threads, walk.world, built=built, reward=walk.reward
    )


def build_learner(
    config: TrainingConfig, table: Checkpoint | None = None, threads: int = 1
) -> Learner:
    """Create a learner at rest, initialised from a table if one is given.

    Args:
        config: the training.
        table: checkpoint whose values, visits and generator the learner continues from.
        threads: number of threads of look-ahead in MuJoCo; 0 for one per core.

    Raises:
        UnknownName, InvalidInput: if the agent or one of its settings is invalid.
        TableMismatch: if the table is of another walking problem or agent.
        Unreachable: if the robot's legs cannot reach the grid.
    """
    offered = _offered_by(config)
    rng = generator(config.seed, LEARNING)
    walker = _walker(
        build_simulator(config, threads),
        config.agent,
        config.observation,
        rng=rng,
        noise=sensor_noise(config.seed),
        offered=offered,
        explore=True,
    )
    simulators: dict[World, Simulator[Any]] = {}

    def simulator_of(world: World) -> Simulator[Any]:
        if world not in simulators:
            simulators.clear()  # only that of the world as it is stays in memory
            simulators[world] = build_simulator(replace(config, world=world), threads)
        return simulators[world]

    def evaluator(world: World, evaluation_rng: np.random.Generator) -> Walker:
        copy = _walker(
            simulator_of(world),
            config.agent,
            config.observation,
            rng=evaluation_rng,
            noise=sensor_noise(config.seed, EVALUATION),
            offered=offered,
            explore=False,
        )
        if isinstance(copy.agent, Tabular):
            # Copying a large table for each evaluation would double the memory use.
            copy.agent.share_table(walker.agent)
        else:
            copy.agent.load(walker.agent.state())
        return copy

    def baseline(world: World) -> Walker:
        return _walker(
            simulator_of(world),
            "greedy",
            "measured",
            rng=rng,
            noise=sensor_noise(config.seed, EVALUATION),
            offered={},
            explore=False,
        )

    learner = Learner(walker, rng, evaluator, baseline)
    if table is not None:
        check_fits(table, config, config.observation)
        continue_from(walker.agent, rng, table)
    return learner


def rebuild_learner(config: TrainingConfig, table: Checkpoint | None = None) -> RebuiltLearner:
    """Create the learner of a training without its robot, to be fed the training's log.

    Args:
        config: the training.
        table: checkpoint from which the training continued.

    Raises:
        UnknownName, InvalidInput: if the agent does not exist any more, or needs a simulator.
        TableMismatch: if the table is of another walking problem or agent.
    """
    rng, sensors = generator(config.seed, LEARNING), LoggedSensors(config, config.observation)
    agent = _agent_without_robot(
        config, config.agent, rng=rng, sensors=sensors, offered=_offered_by(config), explore=True
    )
    if table is not None:
        check_fits(table, config, config.observation)
        continue_from(agent, rng, table)
    return RebuiltLearner(agent, rng, sensors)


def rebuild_lane(
    config: RaceConfig, number: int, table: Checkpoint | None = None
) -> RebuiltLearner:
    """Create the learner of a lane without its robot, to be fed the lane's recording.

    Args:
        config: the race.
        number: number of the lane, counted from 0.
        table: checkpoint of its agent.

    Raises:
        UnknownName, InvalidInput, TableMismatch: as `rebuild_learner`.
    """
    lane = config.lanes[number]
    rng, sensors = generator(config.seed, RACING, number), LoggedSensors(config, lane.observation)
    offered = _offered_in(config, lane) if table is None else _offered_with(table)
    agent = _agent_without_robot(
        *(config, lane.agent),
        rng=rng,
        sensors=sensors,
        offered=offered,
        explore=lane.keep_learning,
    )
    if table is not None:
        check_fits(table, config, lane.observation)
        load_agent(agent, table)
    return RebuiltLearner(agent, rng, sensors, learns=lane.keep_learning)


def _agent_without_robot(
    walk: WalkingProblem,
    agent_name: str,
    *,
    rng: np.random.Generator,
    sensors: LoggedSensors,
    offered: Mapping[str, Any],
    explore: bool,
) -> Agent:
    agent_class = registry.find(agent_name)
    if registry.searches(agent_name):
        raise InvalidInput(
            f"{agent_name} plans with a simulator, and what it simulated was not recorded"
        )
    problem = Problem(walk.resolved_gait.groups, walk.grid.cells)
    arguments = {"rng": rng, "problem": problem, "explore": explore, "observe": sensors}
    return registry.build(agent_class, {**offered, **arguments})


def build_walkers(
    config: RaceConfig,
    tables: Sequence[Checkpoint | None],
    threads: int = 0,
    agents: Mapping[int, Agent] = MappingProxyType({}),
) -> list[Walker]:
    """Create the walkers of a race, one per lane, at rest.

    Args:
        config: the race.
        tables: checkpoint of the agent of each lane, or None.
        threads: number of threads of look-ahead in MuJoCo; 0 for one per core.
        agents: policies from outside, as agents that exist already, by the number of the lane.

    Raises:
        UnknownName, InvalidInput: if a lane's agent or one of its settings is invalid.
        TableMismatch: if a table is of another walking problem or agent.
    """
    simulator = build_simulator(config, threads)
    walkers = []
    for number, (lane, table) in enumerate(zip(config.lanes, tables, strict=True)):
        if number in agents:
            sensors = Sensors(simulator, sensor_noise(config.seed, RACING, number))
            walkers.append(Walker(simulator, agents[number], lane.observation, sensors=sensors))
            continue
        check_lane(lane, has_training=table is not None)
        if table is None:
            offered = _offered_in(config, lane)
        else:
            check_fits(table, config, lane.observation)
            offered = _offered_with(table)
        walker = _walker(
            simulator,
            lane.agent,
            lane.observation,
            rng=generator(config.seed, RACING, number),
            noise=sensor_noise(config.seed, RACING, number),
            offered=offered,
            explore=lane.keep_learning,
            planner=_planner(config, lane, simulator, threads),
        )
        if table is not None:
            load_agent(walker.agent, table)
        walker.keeps_learning = lane.keep_learning
        walkers.append(walker)
    return walkers


def _planner(
    config: RaceConfig, lane: LaneConfig, simulator: Simulator[Any], threads: int
) -> Simulator[Any]:
    """Return the simulator that a lane's search plans with; see `LaneConfig.plans_with`."""
    if lane.plans_with == "world":
        return simulator
    if lane.plans_with in (None, "start"):
        known_config = replace(config, world=config.world.at_start)
    else:
        known_config = replace(config, world=UNDISTURBED, tolerance=0.0)
    return simulator if known_config == config else build_simulator(known_config, threads)


def sensor_noise(seed: int, *key: int) -> Callable[[int], np.random.Generator]:
    """Return a factory of the sensor-noise generator for a step count.

    Args:
        seed: seed of the run.
        key: further part of the spawn key; none for a practice.
    """
    return lambda steps: generator(seed, SENSING, *key, steps)


def _offered_by(config: TrainingConfig) -> dict[str, Any]:
    """Return the arguments that an agent's constructor may take, from a training with settings."""
    return {
        **{name: value for name, value in vars(config).items() if name not in _NOT_OFFERED},
        **complete(agent_settings(config.agent), config.settings, config.agent),
    }


def _offered_with(table: Checkpoint) -> Mapping[str, Any]:
    """Return the arguments that an agent's constructor may take, from the training of a table."""
    config = table.meta["config"]
    return {**config, **config["settings"]}


def _offered_in(config: RaceConfig, lane: LaneConfig) -> Mapping[str, Any]:
    """Return the arguments that an agent's constructor may take in a lane without a table.

    For an agent that keeps learning they are those of a training of as many steps.
    """
    if not lane.keep_learning:
        return complete(agent_settings(lane.agent), lane.settings, lane.agent)
    walk = {field.name: getattr(config, field.name) for field in fields(WalkingProblem)}
    walk |= {"world": UNDISTURBED, "tolerance": 0.0}  # no agent is told of it
    training = TrainingConfig(
        **walk,
        steps=config.steps,
        seed=config.seed,
        observation=lane.observation,
        agent=lane.agent,
        settings=lane.settings,
    )
    return _offered_by(training)


def _walker(
    simulator: Simulator[Any],
    agent_name: str,
    observation: Observation,
    *,
    rng: np.random.Generator,
    noise: Callable[[int], np.random.Generator],
    offered: Mapping[str, Any],
    explore: bool,
    planner: Simulator[Any] | None = None,
) -> Walker:
    """Create a walker; its agent gets a simulator only if its constructor has `expand`.

    That is `planner`, by default the simulator of the walk itself.
    """
    agent_class = registry.find(agent_name)
    expand = None
    if "expand" in registry.parameter_names(agent_class):
        expand = SimulatorExpand(planner or simulator, observation)
    sensors = Sensors(simulator, noise)
    arguments = {
        **offered,
        "rng": rng,
        "problem": Problem(
            simulator.gait.groups, simulator.grid.cells, simulator.gait.azimuths_deg
        ),
        "explore": explore,
        "expand": expand,
        "observe": sensors,
    }
    agent = registry.build(agent_class, arguments)
    return Walker(simulator, agent, observation, expand, sensors)
