"""Loads on a robot from outside: the payload on its torso, and the arrow of a push."""

import math

import mujoco
import numpy as np
import viser

from hexapods.domain.disturbances import Payload
from hexapods.drawing.condition_colors import PAYLOAD, RED
from hexapods.drawing.shapes import arrow
from hexapods.drawing.temporary import Temporary
from hexapods.physics.conditions import direction, payload_center_m, payload_half_side_m
from hexapods.shows.stage_frame import LaneFrame, SceneSpec

_ARROW_M = 0.2
_GAP_M = 0.03
"""Between the torso and the point of the arrow."""


class PayloadCube(Temporary):
    """A cube on the torso of one robot, as large as steel of its mass.

    Args:
        server: where to draw.
        root: scene node of the cube.
        spec: the scene.
        x_m: centre of the lane [m].
    """

    def __init__(self, server: viser.ViserServer, root: str, spec: SceneSpec, x_m: float) -> None:
        super().__init__(server, root, x_m)
        self._spec = spec
        self._center_m = np.zeros(3)
        self._box: viser.BoxHandle | None = None

    def draw(self, lane: LaneFrame) -> None:
        """Move the cube with the torso, if there is a payload."""
        payload = lane.conditions.one_of(Payload)
        is_loaded = payload is not None and payload.kg > 0
        if self._begin((payload,) if is_loaded else ()) and payload is not None:
            gait, side = self._spec.gait, 2 * payload_half_side_m(payload.kg)
            self._center_m = payload_center_m(payload, self._spec.robot, gait.forward_deg)
            self._box = self._server.scene.add_box(
                f"{self._root}/cube", color=PAYLOAD, dimensions=(side, side, side)
            )
        if is_loaded and self._box is not None:
            torso, offset = lane.qpos[:7].astype(float), np.empty(3)
            mujoco.mju_rotVecQuat(offset, self._center_m, torso[3:])
            self._box.position, self._box.wxyz = torso[:3] + offset, torso[3:]


class PushArrows(Temporary):
    """An arrow towards the torso of one robot for each push, during its step.

    Args:
        server: where to draw.
        root: scene node of the arrows.
        spec: the scene.
        x_m: centre of the lane [m].
    """

    def __init__(self, server: viser.ViserServer, root: str, spec: SceneSpec, x_m: float) -> None:
        super().__init__(server, root, x_m)
        self._radius_m = max(spec.robot.torso_half_sides_m)

    def draw(self, lane: LaneFrame) -> None:
        """Show the pushes of the step, where the robot is when they are first seen."""
        pushes = tuple(push for push in lane.pushes if push.impulse_ns > 0)
        if not self._begin((*pushes, lane.step) if pushes else ()):
            return
        shape = arrow(_ARROW_M)
        turn_rad = lane.origin.turn_rad
        for number, push in enumerate(pushes):
            towards_deg = push.direction_deg - math.degrees(turn_rad)
            away_m = self._radius_m + _GAP_M + _ARROW_M / 2
            x, y = lane.qpos[:2] - away_m * direction(towards_deg)
            half = math.radians(towards_deg) / 2
            self._server.scene.add_mesh_simple(
                f"{self._root}/arrow{number}",
                shape.vertices,
                shape.faces,
                color=RED,
                side="double",
                position=(float(x), float(y), float(lane.qpos[2])),
                wxyz=(math.cos(half), 0.0, 0.0, math.sin(half)),
            )
