"""The robots on stage, their name labels, and the flags of those that crossed the finish line."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from hexapods.domain.text import metres, whole
from hexapods.domain.types import IntArray
from hexapods.domain.world import UNDISTURBED, World
from hexapods.drawing.colormap import Rgb, mix, rgb
from hexapods.drawing.contact_shadows import add_robot_shadows
from hexapods.drawing.robot_mesh import Part, RobotMesh
from hexapods.drawing.shapes import flag
from hexapods.drawing.viser_internals.batches import move_instances
from hexapods.drawing.viser_internals.client import batch_colors
from hexapods.runs.clocks import FINISH_LINE_M
from hexapods.shows.stage_frame import LaneFrame, LaneSpec, SceneSpec

_UNPAINTED: Rgb = (92, 99, 113)
_SHADE = 0.14
"""Share of the agent's colour in the colour of unpainted parts."""
GHOST_OPACITY = 0.4
_FLAG_M = 0.22
_TEXT_SCALE = 1.35
"""Font size relative to 12 px, in screen space."""


class Robots:
    """The robots of a scene, each on its lane: one batched mesh per distinct shape, across lanes.

    Args:
        server: where to draw.
        root: scene node of the robots.
        spec: the scene.
        mesh: the robot.
        xs: centres of the lanes [m].
        is_ghost: whether they are translucent, each all in its agent's colour.
        has_shadows: whether they darken the ground below them.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        root: str,
        spec: SceneSpec,
        mesh: RobotMesh,
        xs: Sequence[float],
        *,
        is_ghost: bool = False,
        has_shadows: bool = True,
    ) -> None:
        self._mesh, self._xs = mesh, xs
        self._lane_colors = [lane_spec.color for lane_spec in spec.lane_specs]
        self._is_ghost = is_ghost
        self._conditions: list[World | None] = [UNDISTURBED for _ in xs]
        """Conditions of each lane as drawn; None where no robot is drawn."""
        self._poses: list[NDArray[np.floating[Any]]] = [mesh.default_qpos for _ in xs]
        self._body_poses = [mesh.body_poses(mesh.default_qpos).moved(x) for x in xs]
        self._batches: list[viser.BatchedMeshHandle] = []
        self._drawn = [self._instances(part.links) for part in mesh.parts]
        for number, part in enumerate(mesh.parts):
            colors, _ = self._looks(part)
            positions, wxyzs = self._drawn[number]
            handle = server.scene.add_batched_meshes_simple(
                f"{root}/{mesh.part_name(number, is_ghost=is_ghost)}",
                part.shape.vertices,
                part.shape.faces,
                batched_positions=positions,
                batched_wxyzs=wxyzs,
                batched_colors=batch_colors(colors),
                opacity=GHOST_OPACITY if is_ghost else None,
                lod="off",
            )
            self._batches.append(handle)
        if has_shadows:
            add_robot_shadows(server, root, len(xs), len(spec.robot.legs), is_ghost=is_ghost)

    def draw(self, views: Sequence[LaneFrame | None]) -> None:
        """Update poses and legs from the views of the lanes.

        Where a view is None, no robot is drawn.
        """
        moved = False
        for lane, (view, x) in enumerate(zip(views, self._xs, strict=True)):
            if view is not None and not np.array_equal(view.qpos, self._poses[lane]):
                self._poses[lane], moved = view.qpos, True
                self._body_poses[lane] = self._mesh.body_poses(view.qpos).moved(x)
        if moved:
            self._move_batches()
        conditions = [None if view is None else view.conditions for view in views]
        if conditions != self._conditions:
            self._conditions = conditions
            for part, batch in zip(self._mesh.parts, self._batches, strict=True):
                colors, scales = self._looks(part)
                batch.batched_colors = batch_colors(colors)
                if batch.batched_scales is not None or not scales.all():
                    batch.batched_scales = scales

    def _looks(self, part: Part) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Return colours (lanes · links, 3), 0–255, and scales (lanes · links,), 0 if hidden."""
        colors: list[Rgb | None] = []
        for color, conditions in zip(self._lane_colors, self._conditions, strict=True):
            lane_color = rgb(color) if self._is_ghost else part_color(part, rgb(color))
            if conditions is None:
                colors += [None] * len(part.links)
            else:
                colors += self._mesh.link_colors(part, lane_color, conditions)
        scales = np.array([color is not None for color in colors], np.float32)
        return np.array([color or (0, 0, 0) for color in colors], np.uint8), scales

    def _move_batches(self) -> None:
        instances: dict[bytes, _Instances] = {}
        """By links, which several parts share: painted ones and others."""
        for number, (part, batch) in enumerate(zip(self._mesh.parts, self._batches, strict=True)):
            key = part.links.tobytes()
            if key not in instances:
                instances[key] = self._instances(part.links)
            before, self._drawn[number] = self._drawn[number], instances[key]
            for name, old, new in zip(_Instances._fields, before, instances[key], strict=True):
                if not np.array_equal(old, new):
                    move_instances(batch, name, new)

    def _instances(self, links: IntArray) -> "_Instances":
        positions = np.concatenate([body_poses.positions[links] for body_poses in self._body_poses])
        wxyzs = np.concatenate([body_poses.rotations[links] for body_poses in self._body_poses])
        return _Instances(positions.astype(np.float32), wxyzs.astype(np.float32))


class _Instances(NamedTuple):
    """Poses of the instances of a batched mesh, by viser's names."""

    batched_positions: NDArray[np.float32]
    """(lanes · links, 3) [m]."""
    batched_wxyzs: NDArray[np.float32]
    """Quaternions, (lanes · links, 4)."""


def part_color(part: Part, color: Rgb) -> Rgb:
    """Return the colour of a part of a robot whose agent has a colour."""
    return color if part.painted else mix(_UNPAINTED, color, _SHADE)


def label_text(
    lane_spec: LaneSpec,
    lane: LaneFrame,
    ghost: LaneFrame | None = None,
    ghost_name: str = "ghost",
    *,
    is_ranked: bool = False,
) -> str:
    """Return name, distance and activity, in lines so short that three labels fit on a phone.

    From its crossing on a robot has the time of that in place of its activity.

    Args:
        lane_spec: name of the lane.
        lane: the lane.
        ghost: what another run's ghost does on it, if there is one.
        ghost_name: what the ghost is, in a word.
        is_ranked: whether it is the photo finish, which tells places in place of activities.
    """
    crossing = [] if lane.crossed_s is None else [f"crossed at {lane.crossed_s:.1f}\u00a0s"]
    of_ghost = [] if ghost is None else [f"{ghost_name} {metres(ghost.distance_m)}"]
    if is_ranked:
        ranked = [f"{lane.rank}. {lane_spec.name}", metres(lane.distance_m)]
        return "\n".join([*ranked, *of_ghost, *crossing])
    if lane.failure is not None:
        return f"{lane_spec.name}\ncannot go on"
    if lane.step == 0:
        return lane_spec.name
    lines = [lane_spec.name, f"{metres(lane.distance_m)}, {_progress(lane)}", *of_ghost]
    if crossing:
        lines += crossing
    elif lane.thinking:
        futures = f" {lane.futures}/{lane.futures_total}" if lane.futures else "…"
        lines.append(f"thinking{futures}")
    elif lane.marching and lane.fell_at_step is None:
        lines.append("on the spot")
    return "\n".join(lines)


def _progress(lane: LaneFrame) -> str:
    if lane.fell_at_step is not None:
        return f"fell at step {whole(lane.fell_at_step + 1)}"
    if lane.halted:
        return f"stopped at step {whole(lane.step)}"
    return "done" if lane.done else f"step {whole(lane.step)}"


class NameLabel:
    """Name label and flag of one lane.

    Args:
        server: where to draw.
        root: scene node of the lane.
        lane_spec: name and colour.
        x_m: centre of the lane [m].
        antenna_m: height of the robot's antenna over its torso [m].
    """

    def __init__(
        self,
        server: viser.ViserServer,
        root: str,
        lane_spec: LaneSpec,
        x_m: float,
        antenna_m: float,
    ) -> None:
        self._lane_spec, self._x_m, self._over_m = lane_spec, x_m, antenna_m + 0.03
        self._label = server.scene.add_label(
            f"{root}/label", lane_spec.name, anchor="bottom-center", font_screen_scale=_TEXT_SCALE
        )
        shape = flag(_FLAG_M)
        self._flag = server.scene.add_mesh_simple(
            f"{root}/flag",
            shape.vertices,
            shape.faces,
            color=rgb(lane_spec.color),
            side="double",
            position=(x_m + 0.17, FINISH_LINE_M, 0.0),
            visible=False,
        )
        self._position: tuple[float, float, float] | None = None

    def draw(
        self, lane: LaneFrame, ghost: LaneFrame | None, ghost_name: str, *, is_ranked: bool
    ) -> None:
        """Move the label with the robot and update its text and flag.

        Args:
            lane: the lane.
            ghost: what another run's ghost does on it, if there is one.
            ghost_name: what the ghost is, in a word.
            is_ranked: whether it is the photo finish.
        """
        # Rounded to the millimetre, so that a trembling robot causes no messages for its label.
        x, y, z = lane.qpos[:3].round(3).tolist()
        position = (x + self._x_m, y, z + self._over_m)
        if position != self._position:
            self._label.position = self._position = position
        text = label_text(self._lane_spec, lane, ghost, ghost_name, is_ranked=is_ranked)
        if text != self._label.text:
            self._label.text = text
        has_crossed = lane.crossed_s is not None
        if has_crossed != self._flag.visible:
            self._flag.visible = has_crossed
