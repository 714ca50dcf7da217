"""The ground of one lane where a disturbance has changed it: bumps, patches, a slope."""

import math

import numpy as np
import viser

from hexapods.domain.disturbances import Disturbance, Friction, Patch, Rough, Slope
from hexapods.domain.terrain import rough_heights_at
from hexapods.domain.types import FloatArray
from hexapods.domain.world import World
from hexapods.drawing.colormap import Rgb, mix
from hexapods.drawing.condition_colors import HOLLOW, TOP, UPHILL, ground_color
from hexapods.drawing.lane_marks import BEFORE_M, BEYOND_M, BORDER_M
from hexapods.drawing.shapes import Shape, arrow, outlined, surface
from hexapods.drawing.temporary import Temporary
from hexapods.drawing.track import SQUARE_M
from hexapods.drawing.viser_internals.client import batch_colors
from hexapods.shows.stage_frame import Origin

_CELL_M = 0.04
"""Width of a cell of the drawn bumps; half the distance between independent heights."""
_BANDS = 6
_OPACITY = 0.75
"""Opacity of patches and of ground with another friction, so that its grid stays visible."""
_ARROW_M = 0.14
_LAYER_M = 0.0006
"""Height of what lies on the ground over what is below, against z-fighting."""
_KINDS = (Rough, Friction, Patch, Slope)


class LaneGround(Temporary):
    """Drawing of a lane's ground while conditions change it; without any of them nothing is drawn.

    Args:
        server: viser server to draw on.
        root: scene node of the ground.
        x_m: centre of the lane [m].
        width_m: width of the lane, at whose borders its own ground stays visible.
        friction: friction of ground that no disturbance has changed.
        is_labelled: whether a slope is labelled here.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        root: str,
        x_m: float,
        width_m: float,
        *,
        friction: float,
        is_labelled: bool,
    ) -> None:
        super().__init__(server, root, x_m)
        self._half_m, self._friction = width_m / 2 - BORDER_M, friction
        self._is_labelled = is_labelled

    def draw(self, conditions: World, origin: Origin) -> None:
        """Draw the changed ground of these conditions, with the lane's frame at `origin`."""
        shown: list[Disturbance] = [d for d in conditions.disturbances if isinstance(d, _KINDS)]
        if not self._begin((origin, *shown) if shown else ()):
            return
        friction, color = self._friction, None
        grip = conditions.one_of(Friction)
        if grip is not None:
            friction, color = grip.value, ground_color(grip, self._friction)
        rough = conditions.one_of(Rough)
        if rough is not None and rough.amplitude_m > 0:
            self._draw_bumps(rough, origin, color or TOP)
        elif color is not None:
            self._draw_shape("friction", outlined(self._corners()), color, opacity=_OPACITY)
        for number, patch in enumerate(conditions.all_of(Patch)):
            outline = _between(self._corners(), patch.from_m, patch.to_m, origin)
            if len(outline) > 2:
                height = (1 + number % 2) * _LAYER_M
                color = ground_color(patch, friction)
                self._draw_shape(
                    f"patch{number}", outlined(outline), color, height, opacity=_OPACITY
                )
        slope = conditions.one_of(Slope)
        if slope is not None and slope.degrees > 0:
            self._draw_slope(slope, origin, conditions.ground_m(0))

    def _corners(self) -> FloatArray:
        """Return the corners of the lane, anticlockwise, (4, 2) [m]."""
        half = self._half_m
        ends = [[-half, BEFORE_M], [half, BEFORE_M], [half, BEYOND_M], [-half, BEYOND_M]]
        return np.array(ends)

    def _bumps(self, rough: Rough, origin: Origin) -> Shape:
        """Return the surface of rough ground, by bilinear interpolation of its heights."""
        xs = np.linspace(-self._half_m, self._half_m, 1 + math.ceil(2 * self._half_m / _CELL_M))
        ys = np.linspace(BEFORE_M, BEYOND_M, 1 + math.ceil((BEYOND_M - BEFORE_M) / _CELL_M))
        x, y = np.meshgrid(xs, ys)
        z = rough_heights_at(rough, _on_ground(np.stack([x, y], axis=-1), origin))
        return surface(np.stack([x, y, z], axis=-1))

    def _draw_bumps(self, rough: Rough, origin: Origin, top: Rgb) -> None:
        """Draw rough ground in bands of height: bumps alone are too low to see their shading."""
        vertices, faces = self._bumps(rough, origin)
        share = vertices[faces.reshape(2, -1, 3), 2].mean(axis=(0, 2)) / rough.amplitude_m
        share = np.tile(share, 2)  # both triangles of a cell are in one band
        bands = np.minimum((share * _BANDS).astype(int), _BANDS - 1)
        for band in range(_BANDS):
            used, index = np.unique(faces[bands == band], return_inverse=True)
            if len(used):
                shape = Shape(vertices[used], index.reshape(-1, 3).astype(np.uint32))
                color = mix(HOLLOW, top, (band + 0.5) / _BANDS)
                self._draw_shape(f"bumps{band}", shape, color)

    def _draw_shape(
        self,
        name: str,
        shape: Shape,
        color: Rgb,
        height: float = 0.0,
        opacity: float | None = None,
    ) -> None:
        self._server.scene.add_mesh_simple(
            f"{self._root}/{name}",
            shape.vertices,
            shape.faces,
            color=color,
            opacity=opacity,
            position=(0.0, 0.0, _LAYER_M + height),
        )

    def _draw_slope(self, slope: Slope, origin: Origin, top_m: float) -> None:
        """Draw arrows that point uphill, between the lines of the ground's grid."""
        uphill = math.radians(slope.direction_deg) - origin.turn_rad
        ys = np.arange(BEFORE_M + SQUARE_M / 2, BEYOND_M, SQUARE_M)
        shape = arrow(_ARROW_M)
        turned = (math.cos(uphill / 2), 0.0, 0.0, math.sin(uphill / 2))
        self._server.scene.add_batched_meshes_simple(
            f"{self._root}/slope",
            shape.vertices,
            shape.faces,
            batched_positions=np.array([(0.0, y, top_m + 4 * _LAYER_M) for y in ys]),
            batched_wxyzs=np.tile(turned, (len(ys), 1)),
            batched_colors=batch_colors(np.tile(np.array(UPHILL, np.uint8), (len(ys), 1))),
            lod="off",
        )
        for number, y in enumerate(ys[::4] if self._is_labelled else ()):
            self._server.scene.add_label(
                f"{self._root}/degrees{number}",
                f"{slope.degrees:g}° uphill",
                position=(self._half_m + BORDER_M, y, top_m),
                anchor="center-center",
            )


def _on_ground(points: FloatArray, origin: Origin) -> FloatArray:
    """Transform points, (..., 2) [m], from a lane's frame to the frame of the ground."""
    cos, sin = math.cos(origin.turn_rad), math.sin(origin.turn_rad)
    x, y = points[..., 0], points[..., 1]
    return np.stack([cos * x - sin * y + origin.x_m, sin * x + cos * y + origin.y_m], axis=-1)


def _between(corners: FloatArray, from_m: float, to_m: float, origin: Origin) -> FloatArray:
    """Return the part of a convex polygon that lies between two distances along the ground's track.

    Args:
        corners: corners of the polygon, (k, 2) [m].
        from_m: the nearer distance [m].
        to_m: the farther distance [m].
        origin: place and heading of the polygon's frame on the ground.
    """
    for sign, limit in ((1.0, from_m), (-1.0, -to_m)):
        inside = sign * _on_ground(corners, origin)[:, 1] - limit if len(corners) else corners
        clipped: list[FloatArray] = []
        for number in range(len(corners)):
            distance, next_distance = inside[number - 1], inside[number]
            if (distance < 0) != (next_distance < 0):
                share = distance / (distance - next_distance)
                clipped.append(
                    corners[number - 1] + share * (corners[number] - corners[number - 1])
                )
            if next_distance >= 0:
                clipped.append(corners[number])
        corners = np.array(clipped)
    return corners
