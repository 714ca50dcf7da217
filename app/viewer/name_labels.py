"""What hangs over a robot: a pin in its agent's colour with a plate, and a flag at its end."""

import numpy as np
import viser

from app.stage.stage_frame import LaneSpec, LaneView
from app.viewer.colormap import rgb
from app.viewer.robot_mesh import ANTENNA_M
from app.viewer.shapes import flag

_FLAG_M = 0.22
TEXT_SCALE = 1.35
"""Of 12 px, on every screen."""


def plate_text(lane_spec: LaneSpec, lane: LaneView) -> str:
    """Who, how far, and what it does; lines so short that three plates fit on a phone."""
    if lane.failure is not None:
        return f"{lane_spec.name}\ncannot go on"
    if lane.step == 0:
        return lane_spec.name
    far = f"{lane.distance_m:.2f} m".replace("-0.00", "0.00")
    lines = [lane_spec.name, f"{far}, {'done' if lane.done else f'step {lane.step}'}"]
    if lane.thinking:
        futures = f" {lane.futures}/{lane.futures_total}" if lane.futures else "…"
        lines.append(f"thinking{futures}")
    elif lane.marching:
        lines.append("on the spot")
    return "\n".join(lines)


class Plate:
    """Of one lane."""

    def __init__(
        self, server: viser.ViserServer, root: str, lane_spec: LaneSpec, x_m: float
    ) -> None:
        self._lane_spec, self._x_m = lane_spec, x_m
        self._label = server.scene.add_label(
            f"{root}/plate", lane_spec.name, anchor="bottom-center", font_screen_scale=TEXT_SCALE
        )
        shape = flag(_FLAG_M)
        self._flag = server.scene.add_mesh_simple(
            f"{root}/flag",
            shape.vertices,
            shape.faces,
            color=rgb(lane_spec.color),
            side="double",
            receive_shadow=False,
            visible=False,
        )
        self._place: tuple[float, float, float] | None = None

    def draw(self, lane: LaneView) -> None:
        """Go along with the robot, and say what it does."""
        # To the millimetre, so that a robot that only trembles sends nothing for its plate.
        x, y, z = lane.qpos[:3].round(3).tolist()
        place = (x + self._x_m, y, z + ANTENNA_M + 0.03)
        if place != self._place:
            self._label.position = self._place = place
        text = plate_text(self._lane_spec, lane)
        if text != self._label.text:
            self._label.text = text
        finished = lane.done and lane.failure is None
        if finished != self._flag.visible:
            self._flag.position = np.array([place[0] + 0.17, y + 0.05, 0.0])
            self._flag.visible = finished
