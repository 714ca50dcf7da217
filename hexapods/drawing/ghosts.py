"""Distances in a photo finish as bars, and ghosts of evaluations."""

from collections.abc import Sequence

import viser

from hexapods.domain.text import metres, whole
from hexapods.drawing.colormap import rgb
from hexapods.drawing.robots import Robots
from hexapods.drawing.shapes import strip
from hexapods.drawing.temporary import Temporary
from hexapods.shows.scene_spec import rest_pose
from hexapods.shows.stage_frame import Ghost, LaneFrame, SceneSpec, StageFrame

_BAR_M = 0.05


class PhotoFinish(Temporary):
    """A bar from the start line to each robot, shown during the photo finish.

    The labels of the robots tell places and distances.

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
        """Show or hide the bars as the frame says; redraw them if distances changed."""
        frozen = frame.phase == "photo-finish"
        shown = tuple(
            (lane.distance_m, lane.conditions.ground_m(0)) for lane in frame.lanes if frozen
        )
        if not self._begin(shown):
            return
        for number, ((distance_m, ground_m), x) in enumerate(zip(shown, self._xs, strict=True)):
            bar = strip(_BAR_M, max(abs(distance_m), 0.002))
            color = rgb(self._spec.lane_specs[number].color)
            self._server.scene.add_mesh_simple(
                f"{self._root}/bar{number}",
                bar.vertices,
                bar.faces,
                color=color,
                position=(x, distance_m / 2, ground_m + 0.004),
            )


class Ghosts(Temporary):
    """Evaluations on a lane of their own: a line for each, a translucent robot for the newest.

    The robot is there from the start, hidden, so that its meshes are sent once and not in every
    frame that has an evaluation.

    Args:
        server: where to draw.
        root: scene node of the lines and the label.
        spec: the scene.
        robot: the robot, on one lane.
        x_m: centre of the lane [m].
    """

    def __init__(
        self, server: viser.ViserServer, root: str, spec: SceneSpec, robot: Robots, x_m: float
    ) -> None:
        super().__init__(server, root, x_m)
        self._robot = robot
        self._width = 2 * spec.robot.span_m
        self._color, self._rest = rgb(spec.lane_specs[0].color), rest_pose(spec)
        self._robot.draw([None])

    def draw(self, ghosts: tuple[Ghost, ...]) -> None:
        """Show these ghosts, ordered from the oldest to the newest."""
        if not ghosts:
            self._robot.draw([None])
        if not self._begin(ghosts):
            return
        for number, ghost in enumerate(ghosts):
            self._draw_line(number, ghost, (number + 1) / len(ghosts))
        self._draw_robot(ghosts[-1])

    def _draw_line(self, number: int, ghost: Ghost, newness: float) -> None:
        line = strip(self._width, 0.008)
        self._server.scene.add_mesh_simple(
            f"{self._root}/line{number}",
            line.vertices,
            line.faces,
            color=self._color,
            opacity=0.15 + 0.75 * newness,
            position=(0.0, ghost.distance_m, ghost.conditions.ground_m(0) + 0.004),
        )

    def _draw_robot(self, ghost: Ghost) -> None:
        pose = self._rest.copy()
        pose[1] += ghost.distance_m
        pose[2] += ghost.conditions.ground_m(0)
        self._robot.draw([LaneFrame(pose, 0, 0, 0.0, conditions=ghost.conditions)])
        self._server.scene.add_label(
            f"{self._root}/label",
            f"{metres(ghost.distance_m)}\nafter {whole(ghost.step)} steps",
            position=(0.0, ghost.distance_m, 0.22),
            anchor="bottom-center",
            font_screen_scale=1.35,
        )
