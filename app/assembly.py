"""Composition root of runs: builds simulators, learners and walkers from configs.

The only module that imports the concrete simulators; loops and commands use what it builds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from app.agents import registry
from app.agents.protocol import Problem, Tabular
from app.domain.kinematic import KinematicSimulator
from app.domain.observation import Observation
from app.domain.settings import complete
from app.domain.simulator import Simulator
from app.physics.mujoco_simulator import MujocoSimulator
from app.runs.config import (
    LaneConfig,
    RaceConfig,
    TrainingConfig,
    WalkingProblem,
    agent_settings,
    check_lane,
)
from app.runs.seeding import LEARNING, RACING, generator
from app.runs.tables import Checkpoint, check_fits, continue_from, load_agent
from app.runs.training import Learner, evaluate, measure_baseline
from app.runs.walker import Readings, SimulatorExpand, Walker


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
        return KinematicSimulator(walk.robot, gait, grid)
    return MujocoSimulator(walk.robot, gait, grid, threads)


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
    simulator = build_simulator(config, threads)
    offered = _offered_by(config)
    rng = generator(config.seed, LEARNING)
    walker = _walker(
        simulator, config.agent, config.observation, rng=rng, offered=offered, explore=True
    )

    def evaluator(evaluation_rng: np.random.Generator) -> Walker:
        copy = _walker(
            simulator,
            config.agent,
            config.observation,
            rng=evaluation_rng,
            offered=offered,
            explore=False,
        )
        if isinstance(copy.agent, Tabular):
            # Copying a large table for each evaluation would double the memory use.
            copy.agent.share_table(walker.agent)
        else:
            copy.agent.load(walker.agent.state())
        return copy

    def baseline() -> Walker:
        return _walker(simulator, "greedy", "measured", rng=rng, offered={}, explore=False)

    learner = Learner(walker, rng, evaluator, baseline)
    if table is not None:
        check_fits(table, config, config.observation)
        continue_from(learner, table)
    return learner


def build_walkers(
    config: RaceConfig, tables: Sequence[Checkpoint | None], threads: int = 0
) -> list[Walker]:
    """Create the walkers of a race, one per lane, at rest.

    Args:
        config: the race.
        tables: checkpoint of the agent of each lane, or None.
        threads: number of threads of look-ahead in MuJoCo; 0 for one per core.

    Raises:
        UnknownName, InvalidInput: if a lane's agent or one of its settings is invalid.
        TableMismatch: if a table is of another walking problem or agent.
    """
    simulator = build_simulator(config, threads)
    walkers = []
    for number, (lane, table) in enumerate(zip(config.lanes, tables, strict=True)):
        check_lane(lane, has_training=table is not None)
        if table is None:
            offered = _offered_in(config, lane)
        else:
            check_fits(table, config, lane.observation)
            offered = table.meta["config"]
        walker = _walker(
            simulator,
            lane.agent,
            lane.observation,
            rng=generator(config.seed, RACING, number),
            offered=offered,
            explore=lane.keep_learning,
        )
        if table is not None:
            load_agent(walker.agent, table)
        walker.keeps_learning = lane.keep_learning
        walkers.append(walker)
    return walkers


def _offered_by(config: TrainingConfig) -> dict[str, Any]:
    """Return what a training offers to its agent's constructor: its fields and the settings."""
    declared = agent_settings(config.agent)
    # Earlier versions stored the settings of Q-learning with every agent.
    own = {name: value for name, value in config.settings.items() if name in declared}
    settings = complete(declared, own, config.agent)
    return {
        **{name: value for name, value in vars(config).items() if name != "settings"},
        **settings,
    }


def _offered_in(config: RaceConfig, lane: LaneConfig) -> Mapping[str, Any]:
    """Return what a race offers to the agent of a lane without a table.

    To one that keeps learning this is what a training of as many steps would offer.
    """
    if not lane.keep_learning:
        return complete(agent_settings(lane.agent), lane.settings, lane.agent)
    walk = {one.name: getattr(config, one.name) for one in fields(WalkingProblem)}
    training = TrainingConfig(
        **walk,
        steps=config.steps,
        seed=config.seed,
        observation=lane.observation,
        agent=lane.agent,
        settings=lane.settings,
    )
    return _offered_by(training)


def finish_training(
    learner: Learner, config: TrainingConfig, measure_reference: bool = True
) -> dict[str, Any]:
    """Return the result of a training: an evaluation, the baseline, and the hash of the Q-table.

    Without `measure_reference`, `greedy_distance_m` is None unless it was measured before.
    """
    distance = evaluate(learner, config, learner.epsilon).distance_m
    if learner.greedy_distance_m is None and measure_reference:
        measure_baseline(learner)
    agent = learner.walker.agent
    return {
        "distance_m": distance,
        "greedy_distance_m": learner.greedy_distance_m,
        "q_table_sha256": agent.table.sha256() if isinstance(agent, Tabular) else None,
    }


def _walker(
    simulator: Simulator[Any],
    agent_name: str,
    observation: Observation,
    *,
    rng: np.random.Generator,
    offered: Mapping[str, Any],
    explore: bool,
) -> Walker:
    """Create a walker; its agent gets a simulator only if its constructor has `expand`."""
    agent_class = registry.find(agent_name)
    expand = None
    if "expand" in registry.parameter_names(agent_class):
        expand = SimulatorExpand(simulator, observation)
    readings = Readings(simulator)
    arguments = {
        **offered,
        "rng": rng,
        "problem": Problem(simulator.gait.pairs, simulator.grid.cells),
        "explore": explore,
        "expand": expand,
        "observe": readings,
    }
    agent = registry.build(agent_class, arguments)
    return Walker(simulator, agent, observation, expand, readings)
