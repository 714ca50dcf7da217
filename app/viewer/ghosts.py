"""Temporary parts of the scene: distances in a photo finish, and ghosts of evaluations."""

from collections.abc import Sequence

import numpy as np
import viser

from app.domain.text import metres, whole
from app.stage.scene_spec import rest_pose
from app.stage.stage_frame import Ghost, SceneSpec, StageFrame
from app.viewer.colormap import rgb
from app.viewer.robot_mesh import RobotMesh
from app.viewer.shapes import strip
from app.viewer.viser_internals.client import batch_colors

_BAR_M = 0.05
_TEXT_SCALE = 1.7


class _Temporary:
    """Scene nodes under one frame, which are all drawn anew when what they show changes."""

    def __init__(self, server: viser.ViserServer, root: str, x_m: float = 0.0) -> None:
        self._server, self._root, self._x_m = server, root, x_m
        self._shown: tuple[object, ...] = ()
        self._frame: viser.FrameHandle | None = None

    def _begin(self, content: tuple[object, ...]) -> bool:
        """Remove what was drawn if the content has changed; True if it is to be drawn anew."""
        if content == self._shown:
            return False
        if self._frame is not None:
            self._frame.remove()
            self._frame = None
        self._shown = content
        if content:
            self._frame = self._server.scene.add_frame(
                self._root, show_axes=False, position=(self._x_m, 0.0, 0.0)
            )
        return bool(content)


class PhotoFinish(_Temporary):
    """A bar from the start line to each robot with its distance, shown during the photo finish.

    Args:
        server: where to draw.
        root: scene node of the bars.
        spec: the scene.
        xs: centres of the lanes [m].
    """

    def __init__(
        self, server: viser.ViserServer, root: str, spec: SceneSpec, xs: Sequence[float]
    ) -> None:
        super().__init__(server, root)
        self._spec, self._xs = spec, xs

    def draw(self, frame: StageFrame) -> None:
        """Show or hide the bars as the frame says; redraw them if ranks or distances changed."""
        frozen = frame.phase == "photo-finish"
        ranking = tuple((lane.rank, lane.distance_m) for lane in frame.lanes) if frozen else ()
        if not self._begin(ranking):
            return
        for number, ((rank, distance_m), x) in enumerate(zip(ranking, self._xs, strict=True)):
            bar = strip(_BAR_M, max(abs(distance_m), 0.002))
            color = rgb(self._spec.lane_specs[number].color)
            self._server.scene.add_mesh_simple(
                f"{self._root}/bar{number}",
                bar.vertices,
                bar.faces,
                color=color,
                position=(x, distance_m / 2, 0.004),
                cast_shadow=False,
                receive_shadow=False,
            )
            self._server.scene.add_label(
                f"{self._root}/far{number}",
                f"{rank}.  {metres(distance_m)}",
                position=(x, -0.02, 0.0),
                anchor="top-center",
                font_screen_scale=_TEXT_SCALE,
            )


class Ghosts(_Temporary):
    """Evaluations on a lane of their own: a line for each, a translucent robot for the newest.

    Args:
        server: where to draw.
        root: scene node of the ghosts.
        spec: the scene.
        mesh: the robot.
        x_m: centre of the lane [m].
    """

    def __init__(
        self, server: viser.ViserServer, root: str, spec: SceneSpec, mesh: RobotMesh, x_m: float
    ) -> None:
        super().__init__(server, root, x_m)
        self._mesh = mesh
        self._width = 2 * spec.robot.home_radius_m
        self._color, self._rest = rgb(spec.lane_specs[0].color), rest_pose(spec)

    def draw(self, ghosts: tuple[Ghost, ...]) -> None:
        """Show these ghosts, ordered from the oldest to the newest."""
        if not self._begin(ghosts):
            return
        for number, ghost in enumerate(ghosts):
            self._draw_line(number, ghost.distance_m, (number + 1) / len(ghosts))
        self._draw_robot(ghosts[-1])

    def _draw_line(self, number: int, distance_m: float, newness: float) -> None:
        line = strip(self._width, 0.008)
        self._server.scene.add_mesh_simple(
            f"{self._root}/line{number}",
            line.vertices,
            line.faces,
            color=self._color,
            opacity=0.15 + 0.75 * newness,
            position=(0.0, distance_m, 0.004),
            cast_shadow=False,
            receive_shadow=False,
        )

    def _draw_robot(self, ghost: Ghost) -> None:
        body_poses = self._mesh.body_poses(self._rest).moved(0.0, ghost.distance_m)
        for number, part in enumerate(self._mesh.parts):
            self._server.scene.add_batched_meshes_simple(
                f"{self._root}/robot/{number}",
                part.shape.vertices,
                part.shape.faces,
                batched_positions=body_poses.positions[part.links],
                batched_wxyzs=body_poses.rotations[part.links],
                batched_colors=batch_colors(np.array([self._color] * len(part.links), np.uint8)),
                opacity=0.4,
                lod="off",
                cast_shadow=False,
                receive_shadow=False,
            )
        self._server.scene.add_label(
            f"{self._root}/robot/label",
            f"{metres(ghost.distance_m)}\nafter {whole(ghost.step)} steps",
            position=(0.0, ghost.distance_m, 0.22),
            anchor="bottom-center",
            font_screen_scale=1.35,
        )
