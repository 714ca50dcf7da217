"""Who is on stage in a run, and how they stand before it begins."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from app.domain.errors import Unreachable
from app.domain.gait import Gait
from app.domain.grid import FootGrid
from app.domain.kinematic import KinematicSimulator
from app.domain.robot import Robot
from app.domain.types import FloatArray
from app.runs.config import LaneConfig, RaceConfig, TrainingConfig
from app.stage.palette import lane_colors
from app.stage.stage_frame import LaneSpec, SceneSpec

AGENT_TITLES = {"q-learning": "Q-learning", "greedy": "Greedy", "two-step": "Two-step"}
PAPERS_LANES = ("q-learning", "greedy", "two-step")


def race_scene(config: RaceConfig) -> SceneSpec:
    """A lane for each agent of the race, from left to right."""
    roles = _roles([lane.agent for lane in config.lanes])
    return SceneSpec("race", config.robot, config.resolved_gait, config.grid, roles)


def training_scene(config: TrainingConfig) -> SceneSpec:
    """The one that practises."""
    roles = _roles([config.agent])
    return SceneSpec("training", config.robot, config.resolved_gait, config.grid, roles)


@lru_cache(maxsize=1)
def idle_scene() -> SceneSpec:
    """The paper's three, before anyone has pressed a button."""
    lanes = tuple(LaneConfig(agent=agent) for agent in PAPERS_LANES)
    config = RaceConfig(gait="left-right-origin", lanes=lanes)
    return SceneSpec("idle", config.robot, config.resolved_gait, config.grid, _roles(PAPERS_LANES))


def rest_pose(cast: SceneSpec) -> FloatArray:
    """The robot on the start line, (7 + 3 · legs,)."""
    return _rest_pose(cast.robot, cast.gait, cast.grid)


@lru_cache(maxsize=8)
def _rest_pose(robot: Robot, gait: Gait, grid: FootGrid) -> FloatArray:
    try:
        simulator = KinematicSimulator(robot, gait, grid)
        pose = simulator.pose(simulator.rest())
    except Unreachable:
        # A run of such a robot has failed before its first step; it is shown all the same.
        pose = np.zeros(7 + 3 * len(robot.legs))
        pose[2], pose[3] = robot.body_height_m + robot.foot_radius_m, 1.0
    pose.flags.writeable = False
    return pose


def _roles(agents: Sequence[str]) -> tuple[LaneSpec, ...]:
    names = [AGENT_TITLES.get(agent, agent.rpartition(":")[2]) for agent in agents]
    roles = []
    for lane, (agent, color) in enumerate(zip(agents, lane_colors(agents), strict=True)):
        name, before = names[lane], names[:lane].count(names[lane])
        roles.append(LaneSpec(agent, f"{name} {before + 1}" if before else name, color))
    return tuple(roles)
