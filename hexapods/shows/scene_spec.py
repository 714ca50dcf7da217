"""Build the scene of a run: its lanes, and the pose of its robot at rest."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from hexapods.agents.appearance import colors_of, name_of, title_of
from hexapods.domain.errors import Unreachable
from hexapods.domain.gait import Gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.kinematic import KinematicSimulator
from hexapods.domain.kinematics import legs_of
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.shows.stage_frame import LaneSpec, SceneSpec

PAPERS_LANES = ("q-learning", "greedy", "two-step")


def race_scene(config: RaceConfig) -> SceneSpec:
    """Return the scene of a race: one lane per agent, from left to right."""
    lane_specs = _lane_specs(config.lanes)
    return SceneSpec("race", config.robot, config.resolved_gait, config.grid, lane_specs)


def training_scene(config: TrainingConfig) -> SceneSpec:
    """Return the scene of a training: one lane."""
    lane_specs = (LaneSpec(config.agent, title_of(config.agent), *colors_of([config.agent])),)
    return SceneSpec("training", config.robot, config.resolved_gait, config.grid, lane_specs)


@lru_cache(maxsize=1)
def idle_scene() -> SceneSpec:
    """Return the scene of the idle stage: the paper's three agents."""
    lanes = tuple(LaneConfig(agent=agent) for agent in PAPERS_LANES)
    config = RaceConfig(lanes=lanes)
    return SceneSpec("idle", config.robot, config.resolved_gait, config.grid, _lane_specs(lanes))


def rest_pose(spec: SceneSpec) -> FloatArray:
    """Return the qpos of the robot at rest on the start line, (7 + joints,), read-only."""
    return _rest_pose(spec.robot, spec.gait, spec.grid)


@lru_cache(maxsize=8)
def _rest_pose(robot: Robot, gait: Gait, grid: FootGrid) -> FloatArray:
    try:
        simulator = KinematicSimulator(robot, gait, grid)
        pose = simulator.pose(simulator.rest())
    except Unreachable:
        # A run with such a robot failed before its first step, but can still be shown.
        pose = np.zeros(legs_of(robot).pose_size)
        pose[2], pose[3] = robot.body_height_m + robot.foot_radius_m, 1.0
    pose.flags.writeable = False
    return pose


def _lane_specs(lanes: Sequence[LaneConfig]) -> tuple[LaneSpec, ...]:
    """Return the specs of lanes; equal names are numbered."""
    colors = colors_of([lane.agent for lane in lanes])
    names = [name_of(lane.agent, lane.settings, lane.keep_learning) for lane in lanes]
    lane_specs = []
    for number, (lane, color) in enumerate(zip(lanes, colors, strict=True)):
        name, before = names[number], names[:number].count(names[number])
        lane_specs.append(LaneSpec(lane.agent, f"{name} {before + 1}" if before else name, color))
    return tuple(lane_specs)
