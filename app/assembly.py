"""From a config to concrete parts: which simulator, which agents, put together.

The one place that knows all of them; loops and commands take what comes out of here.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from app.agents import registry
from app.agents.protocol import Problem, Tabular
from app.domain.kinematic import KinematicSimulator
from app.domain.observation import Observation
from app.domain.settings import complete
from app.domain.simulator import Simulator
from app.physics.mujoco_simulator import MujocoSimulator
from app.runs.config import RaceConfig, TrainingConfig, WalkingProblem, agent_settings
from app.runs.seeding import LEARNING, RACING, generator
from app.runs.tables import Checkpoint, check_fits, continue_from, load_agent
from app.runs.training import Learner, evaluate, measure_baseline
from app.runs.walker import SimulatorExpand, Walker


def build_simulator(walk: WalkingProblem, threads: int = 1) -> Simulator[Any]:
    """The simulator that a config names.

    Args:
        walk: the walking problem.
        threads: of look-ahead in MuJoCo; 0 is one for each core.

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
    """A learner at rest, with what `table` holds if one is given.

    Raises:
        UnknownName, InvalidInput: if the agent cannot be had.
        TableMismatch: if the table is of another problem, or of another agent.
        Unreachable: if the robot's legs cannot reach the grid.
    """
    simulator = build_simulator(config, threads)
    declared = agent_settings(config.agent)
    # Earlier versions kept those of Q-learning with every agent.
    own = {name: value for name, value in config.settings.items() if name in declared}
    settings = complete(declared, own, config.agent)
    fields = {name: value for name, value in vars(config).items() if name != "settings"}
    offered = {**fields, **settings}
    rng = generator(config.seed, LEARNING)
    walker = _walker(
        simulator, config.agent, config.observation, rng=rng, offered=offered, explore=True
    )

    def evaluator(chance: np.random.Generator) -> Walker:
        copy = _walker(
            simulator,
            config.agent,
            config.observation,
            rng=chance,
            offered=offered,
            explore=False,
        )
        if isinstance(copy.agent, Tabular):
            # A large table, copied for every evaluation, would be most of the memory.
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
    """The lanes of a race, at rest.

    Args:
        config: the race.
        tables: for each lane what it has learned, or None.
        threads: of look-ahead in MuJoCo; 0 is one for each core.

    Raises:
        TableMismatch: if a table is of another problem than the race, or of another agent.
    """
    simulator = build_simulator(config, threads)
    walkers = []
    for number, (lane, table) in enumerate(zip(config.lanes, tables, strict=True)):
        practised: Mapping[str, Any] = {}
        if table is not None:
            check_fits(table, config, lane.observation)
            practised = table.meta["config"]
        rng = generator(config.seed, RACING, number)
        walker = _walker(
            simulator, lane.agent, lane.observation, rng=rng, offered=practised, explore=False
        )
        if table is not None:
            load_agent(walker.agent, table)
        walkers.append(walker)
    return walkers


def finish_training(
    learner: Learner, config: TrainingConfig, measure_reference: bool = True
) -> dict[str, Any]:
    """The result of a training, as it stands: how far it walks now, and the table's hash.

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
    """A walker whose agent gets what it asks for; one that does not ask for `expand` is blind."""
    agent_class = registry.find(agent_name)
    foresight = None
    if "expand" in registry.asks_for(agent_class):
        foresight = SimulatorExpand(simulator, observation)
    every = {
        **offered,
        "rng": rng,
        "problem": Problem(simulator.gait.pairs, simulator.grid.cells),
        "explore": explore,
        "expand": foresight,
    }
    return Walker(simulator, registry.build(agent_class, every), observation, foresight)
