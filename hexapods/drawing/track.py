"""The track: ground with a grid of 0.5 m, lights, lanes with ticks, start and finish line."""

import numpy as np
import viser

from hexapods.drawing.colormap import Rgb
from hexapods.drawing.shapes import strip
from hexapods.runs.clocks import FINISH_LINE_M

WORLD = "/world"
"""Root node of the scene, which the follow camera translates."""

Position = tuple[float, float, float]
"""Position of a scene node [m]: x across the track, y along it, z up."""

SQUARE_M, TICK_M = 0.5, 0.05
LAMP = (-0.7, -0.5, 3.2)
"""Position of the lamp for robots on the start line [m]."""
BEFORE_M, BEYOND_M = -0.5, 2.0
"""Start and end of the lanes along the track."""
TICKS_M = 0.03
"""Width of the ticks at the borders of a lane."""
_LINES_M = 0.002
"""Height of start and finish line over the ground."""
_WORD_M = 0.18
"""From a line to its word, out of the track: the middle legs of a robot on the line end there."""
_GROUND: Rgb = (112, 128, 150)
_LINE: Rgb = (120, 138, 164)
_TICK: Rgb = (150, 165, 188)
_GREEN: Rgb = (12, 110, 36)
_RED: Rgb = (176, 16, 20)
"""Darker than intended, since the lamp brightens them."""


def draw_ground(server: viser.ViserServer) -> viser.SpotLightHandle:
    """Draw the parts that do not depend on the run: ground, lights, initial camera.

    The ground is translucent and fades out into the page's background, since the light or dark
    theme is a setting of each viewer, while the scene is shared by all.

    Returns:
        the lamp, which moves with the robots.
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
        section_thickness=1.2,
        infinite_grid=True,
        fade_distance=9.0,
        fade_strength=1.3,
        plane_color=_GROUND,
        plane_opacity=0.28,
        shadow_opacity=0.4,
    )
    lamp = _light(scene)
    camera = server.initial_camera
    camera.position, camera.look_at = (0.0, -1.52, 0.80), (0.0, 0.12, 0.05)
    camera.fov = np.deg2rad(42)
    return lamp


def _light(scene: viser.SceneApi) -> viser.SpotLightHandle:
    # viser's default directional light has three shadow maps, which render three times slower on
    # a machine without a GPU than this spot light with one.
    scene.configure_default_lights(enabled=False)
    lamp = scene.add_light_spot(
        f"{WORLD}/lamp",
        position=LAMP,
        direction=(0.19, 0.19, -1.0),
        intensity=2.6,
        decay=0.0,
        angle=0.75,
        penumbra=0.6,
        cast_shadow=True,
    )
    scene.configure_environment_map(None)
    scene.add_light_hemisphere(
        f"{WORLD}/sky", sky_color=(255, 255, 255), ground_color=(150, 160, 175), intensity=1.6
    )
    return lamp


class Lines:
    """Start and finish line, which are above the highest bumps of the ground."""

    def __init__(self, lines: list[viser.MeshHandle]) -> None:
        self._lines, self._ground_m = lines, 0.0

    def raise_over(self, ground_m: float) -> None:
        """Move the lines over bumps of a height [m]."""
        if ground_m != self._ground_m:
            self._ground_m = ground_m
            for line in self._lines:
                x, y, _ = line.position
                line.position = (x, y, ground_m + _LINES_M)


def draw_lanes(server: viser.ViserServer, root: str, xs: list[float], width: float) -> Lines:
    """Draw lanes of equal width with ticks, start and finish line.

    Args:
        server: where to draw.
        root: scene node of the lanes.
        xs: centres of the lanes, ascending [m].
        width: width of each lane [m].
    """
    scene, left, right = server.scene, xs[0] - width / 2, xs[-1] + width / 2
    borders = [x - width / 2 for x in xs] + [right]
    scene.add_line_segments(
        f"{root}/borders",
        np.array([[(x, BEFORE_M, 0.001), (x, BEYOND_M, 0.001)] for x in borders]),
        _TICK,
        thickness=0.006,
    )
    marks = np.arange(BEFORE_M, BEYOND_M + TICK_M / 2, TICK_M)
    ticks = [[(x, y, 0.001), (x + TICKS_M, y, 0.001)] for x in borders[:-1] for y in marks]
    ticks += [[(right - TICKS_M, y, 0.001), (right, y, 0.001)] for y in marks]
    scene.add_line_segments(f"{root}/ticks", np.array(ticks), _TICK, thickness=0.003)
    middle, across = (left + right) / 2, right - left
    lines = (
        ("start", "Start", 0.0, -_WORD_M, _GREEN),
        ("finish", "Finish", FINISH_LINE_M, _WORD_M, _RED),
    )
    handles = []
    for name, word, y, word_y, color in lines:
        line = strip(across, 0.022)
        handle = scene.add_mesh_simple(
            f"{root}/{name}",
            line.vertices,
            line.faces,
            color=color,
            cast_shadow=False,
            receive_shadow=False,
            position=(middle, y, _LINES_M),
        )
        handles.append(handle)
        scene.add_label(
            f"{root}/{name}/word",
            word,
            position=(borders[1] - middle, word_y, 0.0),
            anchor="center-center",
            font_screen_scale=1.15,
        )
    return Lines(handles)
