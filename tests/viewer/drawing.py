"""Test set-up: frames of robots at rest, and the scene graph that a new client receives."""

from typing import Any

import numpy as np

from app.viewer.snapshot import Snapshot
from hexapods.domain.robot import Robot
from hexapods.drawing.viser_internals import stream
from hexapods.drawing.viser_internals.server import InProcessViser
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.shows.scene_spec import race_scene, rest_pose
from hexapods.shows.stage_frame import LaneFrame, SceneSpec, StageFrame
from tests.viewer.serving import Reader

GAIT = "left-right-vertical"


def scene_nodes(server: InProcessViser) -> dict[str, dict[str, Any]]:
    """Return all nodes of the scene with their properties, as a new client receives them."""
    snapshot = Snapshot()
    with Reader(server) as reader:
        while not snapshot.complete:
            snapshot.apply(reader.frame())
    frame, nodes = snapshot.pack(), dict[str, dict[str, Any]]()
    for message in frame.messages:
        if not message.get("name", "").startswith("/world"):
            continue
        node = nodes.setdefault(message["name"], {})
        properties = message.get("props") or message.get("updates") or message
        node.update({name: resolved(value, frame) for name, value in properties.items()})
    return nodes


def resolved(value: Any, frame: stream.Frame) -> Any:
    """Return a property with an array reference resolved."""
    if isinstance(value, dict) and "__binary_index" in value:
        return np.frombuffer(frame.buffers[value["__binary_index"]], value["dtype"])
    return value


def race_of(lanes: int, robot: Robot | None = None) -> SceneSpec:
    agents = ("q-learning", "greedy", "two-step", "greedy", "greedy", "greedy")[:lanes]
    config = RaceConfig(
        gait=GAIT, robot=robot or Robot(), lanes=tuple(LaneConfig(agent=a) for a in agents)
    )
    return race_scene(config)


def frame_at_rest(spec: SceneSpec) -> StageFrame:
    lane = LaneFrame(rest_pose(spec), 3, 50, 0.0)
    return StageFrame(spec, "run", "race", "Race", (lane,) * len(spec.lane_specs))


def frame_of(spec: SceneSpec, *lanes: LaneFrame) -> StageFrame:
    """Return a frame of a race with these lanes."""
    return StageFrame(spec, "run", "race", "Race", lanes)
