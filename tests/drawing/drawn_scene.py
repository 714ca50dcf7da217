"""Test set-up: frames of robots at rest, and the scene nodes that are drawn."""

from typing import Any

import numpy as np
import viser

from hexapods.domain.robot import Robot
from hexapods.drawing.viser_internals.messages import LIFECYCLES
from hexapods.drawing.viser_internals.recorder import recorder
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.shows.scene_spec import race_scene, rest_pose
from hexapods.shows.stage_frame import LaneFrame, SceneSpec, StageFrame

GAIT = "left-right-vertical"


def scene_nodes(server: viser.ViserServer) -> dict[str, dict[str, Any]]:
    """Return all nodes of the scene with their newest properties, by name."""
    with recorder(server) as recording:
        messages, arrays = recording.take()
    nodes = dict[str, dict[str, Any]]()
    for message in messages:
        name, (_, phase, _) = str(message.get("name", "")), LIFECYCLES[message["type"]]
        if not name.startswith("/world"):
            continue
        if phase == "remove":
            nodes = {node: nodes[node] for node in nodes if not f"{node}/".startswith(f"{name}/")}
            continue
        if phase == "create":
            nodes[name] = {}
        properties = message.get("props") or message.get("updates") or message
        nodes[name].update({key: resolved(item, arrays) for key, item in properties.items()})
    return nodes


def resolved(value: Any, arrays: list[memoryview]) -> Any:
    """Return a property with an array reference resolved."""
    if isinstance(value, dict) and "__binary_index" in value:
        return np.frombuffer(arrays[value["__binary_index"]], value["dtype"])
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
