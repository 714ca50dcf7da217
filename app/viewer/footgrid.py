"""The foot grid under a learner's feet (paper, Figure 1), as a map of what it expects."""

import math

import numpy as np
import viser
from numpy.typing import NDArray

from app.domain.types import FloatArray, IntArray
from app.stage.stage_frame import ActionValuesView, LaneView, SceneSpec, yaw_rad
from app.viewer.colormap import Rgb, batched, rgb, value_colors
from app.viewer.shapes import Shape

_HOME: Rgb = rgb("#e5484d")
_OTHER: Rgb = rgb("#4c8dff")
_BLANK: Rgb = (38, 42, 50)
_HERE: Rgb = (255, 255, 255)
_ABOVE_GROUND_M = 0.003
_LAYER = np.array([0.0, 0.0, 0.0006])
"""What lies over something else, so that it is not hidden by it [m]."""


class FootGridDrawing:
    """The cells of one lane, centred on each foot's home in the body's frame.

    A cell is drawn as the ground that is nearer to it than to the others: that is how a foot's
    place is read. Rims are red at home and blue elsewhere, as in the paper; the fill is the value
    of moving the pair there now. The cell where a pair is has a white rim and no value: it is no
    choice.
    """

    def __init__(self, server: viser.ViserServer, root: str, spec: SceneSpec, x_m: float) -> None:
        self._x_m = x_m
        self._forward_rad = math.radians(90 - spec.gait.forward_deg)
        self._frame = server.scene.add_frame(root, show_axes=False)
        pairs = spec.gait.pairs
        legs = range(1, len(spec.robot.legs) + 1)
        self._pair_of_leg = [next(p for p, both in enumerate(pairs) if leg in both) for leg in legs]
        places, side = _places(spec), spec.grid.side_m / (spec.grid.divisions - 1)
        home_is_between = spec.grid.divisions % 2 == 0
        others = np.arange(1, len(spec.grid))
        self._tiles = [
            _Tiles(server, f"{root}/others", _square(side), others, places, rim=_OTHER),
            _Tiles(
                server,
                f"{root}/home",
                _diamond(side / 2) if home_is_between else _square(side),
                np.array([0]),
                places + 3 * _LAYER,
                rim=_HOME,
            ),
        ]
        self._known: ActionValuesView | None = None
        self._pose: tuple[float, float, float] | None = None

    def draw(self, lane: LaneView) -> None:
        """Go along with the body, and take on the colours of what it knows now."""
        x, y = float(lane.qpos[0]) + self._x_m, float(lane.qpos[1])
        pose = (x, y, yaw_rad(lane.qpos[3:7]) - self._forward_rad)
        if pose != self._pose:
            self._frame.position = (x, y, _ABOVE_GROUND_M)
            self._frame.wxyz = (math.cos(pose[2] / 2), 0.0, 0.0, math.sin(pose[2] / 2))
            self._pose = pose
        known = lane.knowledge
        if known is None or _same(known, self._known):
            return
        self._known = known
        values = known.values_m[self._pair_of_leg]  # (legs, cells)
        fills = value_colors(values, known.low_m, known.high_m)
        here = np.array(known.current)[self._pair_of_leg][:, None] == np.arange(values.shape[1])
        fills[here] = _BLANK
        for tiles in self._tiles:
            tiles.draw(fills, here)


class _Tiles:
    """Cells of one shape, under all feet."""

    def __init__(
        self,
        server: viser.ViserServer,
        root: str,
        outline: FloatArray,
        cells: IntArray,
        places: FloatArray,
        *,
        rim: Rgb,
    ) -> None:
        self._cells, self._rim = cells, rim
        at = places[:, cells].reshape(-1, 3)
        colors = np.tile(np.array(rim, np.uint8), (len(at), 1))
        self._rims = _add(server, f"{root}/rims", _tile(0.96 * outline), at, colors)
        self._fills = _add(server, f"{root}/fills", _tile(0.84 * outline), at + _LAYER, colors)

    def draw(self, fills: NDArray[np.uint8], here: NDArray[np.bool_]) -> None:
        """Colour the cells.

        Args:
            fills: of every cell of every leg, (legs, cells, 3).
            here: where each leg's pair is, (legs, cells).
        """
        is_here = here[:, self._cells].reshape(-1, 1)
        self._rims.batched_colors = _flat(np.where(is_here, _HERE, self._rim).astype(np.uint8))
        self._fills.batched_colors = _flat(fills[:, self._cells].reshape(-1, 3))


def _square(side: float) -> FloatArray:
    """Corners of a square around the origin, anticlockwise."""
    return side / 2 * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def _diamond(reach: float) -> FloatArray:
    """Corners of a square that stands on one of them."""
    return reach * np.array([[0.0, -1], [1, 0], [0, 1], [-1, 0]])


def _tile(outline: FloatArray) -> Shape:
    """A flat quadrilateral, facing up."""
    corners = np.column_stack([outline, np.zeros(4)]).astype(np.float32)
    return Shape(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))


def _places(spec: SceneSpec) -> FloatArray:
    """Every cell of every leg in the robot frame, x right and y forward, (legs, cells, 3)."""
    azimuth = np.radians(spec.gait.azimuths_deg)
    homes = spec.robot.home_radius_m * np.stack([-np.sin(azimuth), np.cos(azimuth)], axis=1)
    cells = np.tile(spec.grid.cells, (len(homes), 1, 1))  # (legs, cells, 2)
    partners = [partner - 1 for _, partner in spec.gait.pairs]
    cells[partners, :, 0] *= -1
    places = np.zeros((*cells.shape[:2], 3))
    places[..., :2] = homes[:, None] + cells
    return places


def _same(known: ActionValuesView, before: ActionValuesView | None) -> bool:
    if before is None:
        return False
    scale = (known.low_m, known.high_m) == (before.low_m, before.high_m)
    return scale and known.values_m is before.values_m


def _flat(colors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return batched(colors, dimmed=0.75)


def _add(
    server: viser.ViserServer, name: str, shape: Shape, at: FloatArray, colors: NDArray[np.uint8]
) -> viser.BatchedMeshHandle:
    """The same flat shape at many places, (n, 3)."""
    return server.scene.add_batched_meshes_simple(
        name,
        shape.vertices,
        shape.faces,
        batched_positions=at,
        batched_wxyzs=np.tile((1.0, 0.0, 0.0, 0.0), (len(at), 1)),
        batched_colors=_flat(colors),
        lod="off",
        cast_shadow=False,
        receive_shadow=False,
    )
