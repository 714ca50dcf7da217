"""Name label over a robot, with its distance and activity, and the flag of a finished lane."""

import numpy as np
import viser

from app.stage.stage_frame import LaneSpec, LaneView
from app.viewer.colormap import rgb
from app.viewer.robot_mesh import ANTENNA_M
from app.viewer.shapes import flag

_FLAG_M = 0.22
TEXT_SCALE = 1.35
"""Font size relative to 12 px, in screen space."""


def label_text(lane_spec: LaneSpec, lane: LaneView) -> str:
    """Return name, distance and activity, in lines so short that three labels fit on a phone."""
    if lane.failure is not None:
        return f"{lane_spec.name}\ncannot go on"
    if lane.step == 0:
        return lane_spec.name
    distance = f"{lane.distance_m:.2f} m".replace("-0.00", "0.00")
    lines = [lane_spec.name, f"{distance}, {'done' if lane.done else f'step {lane.step}'}"]
    if lane.thinking:
        futures = f" {lane.futures}/{lane.futures_total}" if lane.futures else "…"
        lines.append(f"thinking{futures}")
    elif lane.marching:
        lines.append("on the spot")
    return "\n".join(lines)


class NameLabel:
    """Name label and flag of one lane.

    Args:
        server: where to draw.
        root: scene node of the lane.
        lane_spec: name and colour.
        x_m: centre of the lane [m].
    """

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
        self._position: tuple[float, float, float] | None = None

    def draw(self, lane: LaneView) -> None:
        """Move the label with the robot and update its text and flag."""
        # Rounded to the millimetre, so that a trembling robot causes no messages for its label.
        x, y, z = lane.qpos[:3].round(3).tolist()
        position = (x + self._x_m, y, z + ANTENNA_M + 0.03)
        if position != self._position:
            self._label.position = self._position = position
        text = label_text(self._lane_spec, lane)
        if text != self._label.text:
            self._label.text = text
        finished = lane.done and lane.failure is None
        if finished != self._flag.visible:
            self._flag.position = np.array([position[0] + 0.17, y + 0.05, 0.0])
            self._flag.visible = finished
