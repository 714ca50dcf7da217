"""The track: ground with a grid of 0.5 m, lights, lanes with marks, start and finish line."""

from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from hexapods.drawing.colormap import Rgb
from hexapods.drawing.lane_marks import distance_marks, distances, finish_line, start_line, tint
from hexapods.runs.clocks import FINISH_LINE_M

WORLD = "/world"
"""Root node of the scene, which the follow camera translates."""

Position = tuple[float, float, float]
"""Position of a scene node [m]: x across the track, y along it, z up."""

SQUARE_M = 0.5
_TINT_M = 0.0004
"""Height of the tint of a lane over the ground."""
_MARKS_M, _LINES_M = 0.0022, 0.0026
"""Heights of marks, and of start and finish line over the ground, above patches."""
_WORD_M = 0.08
"""From the border of the track to the word of a line, out of it: there are no robots."""
_LINE: Rgb = (128, 142, 164)


def draw_ground(server: viser.ViserServer) -> None:
    """Draw the parts that do not depend on the run: ground, lights, initial camera.

    The light or dark theme is a setting of each viewer, while the scene is shared by all: how
    bright lights are and in which colour the grid is, says `static/viewer/light.js`. The ground
    itself is the background of the page.
    """
    scene = server.scene
    scene.set_up_direction("+z")
    scene.world_axes.visible = False
    scene.add_frame(WORLD, show_axes=False)
    scene.add_grid(
        f"{WORLD}/ground",
        cell_size=SQUARE_M,
        section_size=SQUARE_M,
        cell_color=_LINE,
        section_color=_LINE,
        cell_thickness=0.0,
        section_thickness=1.0,
        infinite_grid=True,
        fade_distance=5.0,
        fade_strength=1.3,
        shadow_opacity=0.0,
    )
    _light(scene)
    camera = server.initial_camera
    camera.position, camera.look_at = (0.0, -1.52, 0.80), (0.0, 0.12, 0.05)
    camera.fov = np.deg2rad(42)


def _light(scene: viser.SceneApi) -> None:
    # A shadow map takes a machine without a GPU as long as the robots themselves; see
    # `contact_shadows`.
    scene.configure_default_lights(enabled=False)
    scene.configure_environment_map(None)
    # A directional light shines from its place to the origin. Under the root of the scene it would
    # turn when the camera follows a robot.
    scene.add_light_directional("/lamp", position=(-0.9, -0.8, 1.9), intensity=1.9)
    scene.add_light_directional("/rim", position=(0.4, 1.6, 0.9), intensity=0.7)
    scene.add_light_hemisphere(
        "/sky", sky_color=(255, 255, 255), ground_color=(213, 218, 226), intensity=1.9
    )


class Lines:
    """Marks, start and finish line, which are above the highest bumps of the ground."""

    def __init__(self, lines: list[tuple[viser.BatchedGlbHandle, float]]) -> None:
        self._lines, self._ground_m = lines, 0.0

    def raise_over(self, ground_m: float) -> None:
        """Move the lines over bumps of a height [m]."""
        if ground_m != self._ground_m:
            self._ground_m = ground_m
            for line, height_m in self._lines:
                x, y, _ = line.position
                line.position = (x, y, ground_m + height_m)


def draw_lanes(
    server: viser.ViserServer,
    root: str,
    xs: Sequence[float],
    width: float,
    colors: Sequence[Rgb],
) -> Lines:
    """Draw lanes of equal width with marks, start and finish line.

    Args:
        server: where to draw.
        root: scene node of the lanes.
        xs: centres of the lanes, ascending [m].
        width: width of each lane [m].
        colors: of the lanes' agents.
    """
    for number, (x, color) in enumerate(zip(xs, colors, strict=True)):
        server.scene.add_glb(
            f"{root}/tint{number}",
            tint(width, color),  # type: ignore[arg-type]
            position=(x, 0.0, _TINT_M),
        )
    lines = (
        ("start", "Start", start_line(width), 0.0),
        ("finish", "Finish", finish_line(width), FINISH_LINE_M),
    )
    marks = {
        "marks": distance_marks(width),
        # `static/viewer/light.js` shows those that can be read from where the camera is.
        "distances": distances(width),
        "distances-from-front": distances(width, from_front=True),
    }
    handles = [
        (_on_lanes(server, f"{root}/{name}", glb, xs, (0.0, 0.0, _MARKS_M)), _MARKS_M)
        for name, glb in marks.items()
    ]
    for name, word, shape, y in lines:
        handle = _on_lanes(server, f"{root}/{name}", shape, xs, (0.0, y, _LINES_M))
        handles.append((handle, _LINES_M))
        server.scene.add_label(
            f"{root}/{name}/word",
            word,
            position=(xs[0] - width / 2 - _WORD_M, 0.0, 0.0),
            anchor="center-center",
            font_screen_scale=1.15,
        )
    return Lines(handles)


def _on_lanes(
    server: viser.ViserServer,
    name: str,
    glb: NDArray[np.uint8],
    xs: Sequence[float],
    position: Position,
) -> viser.BatchedGlbHandle:
    """Draw a mesh on each lane."""
    return server.scene.add_batched_glb(
        name,
        glb,  # type: ignore[arg-type]
        batched_wxyzs=np.tile((1.0, 0.0, 0.0, 0.0), (len(xs), 1)),
        batched_positions=np.array([(x, 0.0, 0.0) for x in xs]),
        position=position,
        lod="off",
    )
