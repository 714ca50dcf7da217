"""Heat map of action values on the foot grid under a learner's feet (paper, Figure 1)."""

import math

import numpy as np
import viser
from numpy.typing import NDArray

from hexapods.domain.disturbances import Lost
from hexapods.domain.kinematics import legs_of
from hexapods.domain.posture import yaw_rad
from hexapods.domain.types import FloatArray, IntArray
from hexapods.drawing.colormap import Rgb, rgb, value_colors
from hexapods.drawing.shapes import Shape, outlined
from hexapods.drawing.viser_internals.client import batch_colors
from hexapods.shows.stage_frame import ActionValuesView, LaneFrame, SceneSpec

_HOME_RIM: Rgb = rgb("#e5484d")
_OTHER_RIM: Rgb = rgb("#4c8dff")
_CURRENT_FILL: Rgb = (38, 42, 50)
_UNTRIED_FILL: Rgb = rgb("#80868f")
_CURRENT_RIM: Rgb = (255, 255, 255)
ABOVE_GROUND_M = 0.003
"""Height of the grid over the ground."""
_LAYER_OFFSET = np.array([0.0, 0.0, 0.0006])
"""Offset of a layer over the one below, against z-fighting [m]."""


class FootGridDrawing:
    """The grid cells of one lane, around each foot's home position in the body's frame.

    A cell is drawn as its Voronoi region, as observations assign a foot to the nearest cell. Rims
    are red at home and blue elsewhere, as in the paper; the fill is the value of moving the
    leg's group there now, or grey if it was never moved there from here. The cell where it is has a
    white rim and no value, since it is no legal action. A leg that is lost has no cells.

    Args:
        server: where to draw.
        root: scene node of the grid.
        spec: the scene.
        x_m: centre of the lane [m].
    """

    def __init__(self, server: viser.ViserServer, root: str, spec: SceneSpec, x_m: float) -> None:
        self._x_m = x_m
        self._forward_rad = math.radians(90 - spec.gait.forward_deg)
        self._frame = server.scene.add_frame(root, show_axes=False)
        self._group_of_leg = list(spec.gait.group_of_leg)
        positions, side = _cell_positions(spec), spec.grid.side_m / (spec.grid.divisions - 1)
        home_is_between = spec.grid.divisions % 2 == 0
        away = np.arange(1, len(spec.grid))
        self._tiles = [
            _Tiles(server, f"{root}/others", _square(side), away, positions, rim=_OTHER_RIM),
            _Tiles(
                server,
                f"{root}/home",
                _diamond(side / 2) if home_is_between else _square(side),
                np.array([0]),
                positions + 3 * _LAYER_OFFSET,
                rim=_HOME_RIM,
            ),
        ]
        self._drawn: ActionValuesView | None = None
        self._lost: set[int] = set()
        self._pose: tuple[float, float, float, float] | None = None

    def draw(self, lane: LaneFrame) -> None:
        """Move the grid with the body, and colour its cells if the action values changed."""
        x, y = float(lane.qpos[0]) + self._x_m, float(lane.qpos[1])
        turn, z = yaw_rad(lane.qpos[3:7].tolist()) - self._forward_rad, lane.conditions.ground_m(0)
        pose = (x, y, z + ABOVE_GROUND_M, turn)
        if pose != self._pose:
            self._frame.position = pose[:3]
            self._frame.wxyz = (math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2))
            self._pose = pose
        lost = {leg for disturbance in lane.conditions.all_of(Lost) for leg in disturbance.legs}
        if lost != self._lost:
            self._lost = lost
            legs = range(1, len(self._group_of_leg) + 1)
            for tiles in self._tiles:
                tiles.show(np.array([leg not in lost for leg in legs]))
        action_values = lane.action_values
        if action_values is None or _is_unchanged(action_values, self._drawn):
            return
        self._drawn = action_values
        values = action_values.values_m[self._group_of_leg]  # (legs, cells)
        fills = value_colors(values, action_values.low_m, action_values.high_m)
        is_current = np.array(action_values.current)[self._group_of_leg][:, None] == np.arange(
            values.shape[1]
        )
        fills[action_values.visits[self._group_of_leg] == 0] = _UNTRIED_FILL
        fills[is_current] = _CURRENT_FILL
        for tiles in self._tiles:
            tiles.draw(fills, is_current)


class _Tiles:
    """All cells of one shape, of all feet: one batch of rims and one of fills.

    Args:
        server: where to draw.
        root: scene node of the batches.
        outline: corners of a cell, (4, 2) [m].
        cells: indices of the cells of this shape, (n,).
        positions: of all cells, (legs, cells, 3) [m].
        rim: colour of the rims.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        root: str,
        outline: FloatArray,
        cells: IntArray,
        positions: FloatArray,
        *,
        rim: Rgb,
    ) -> None:
        self._cells, self._rim = cells, rim
        positions = positions[:, cells].reshape(-1, 3)
        colors = np.tile(np.array(rim, np.uint8), (len(positions), 1))
        self._rims = _add(server, f"{root}/rims", outlined(0.96 * outline), positions, colors)
        self._fills = _add(
            server, f"{root}/fills", outlined(0.84 * outline), positions + _LAYER_OFFSET, colors
        )

    def draw(self, fills: NDArray[np.uint8], is_current: NDArray[np.bool_]) -> None:
        """Colour the cells.

        Args:
            fills: colours of every cell of every leg, (legs, cells, 3), 0–255.
            is_current: whether a leg's group is in the cell, (legs, cells).
        """
        tile_is_current = is_current[:, self._cells].reshape(-1, 1)
        self._rims.batched_colors = _flat_colors(
            np.where(tile_is_current, _CURRENT_RIM, self._rim).astype(np.uint8)
        )
        self._fills.batched_colors = _flat_colors(fills[:, self._cells].reshape(-1, 3))

    def show(self, is_shown: NDArray[np.bool_]) -> None:
        """Show the cells of some legs, (legs,), and hide the others."""
        scales = np.repeat(is_shown, len(self._cells)).astype(np.float32)
        self._rims.batched_scales = scales
        self._fills.batched_scales = scales


def _square(side: float) -> FloatArray:
    """Return the corners of a square around the origin, anticlockwise, (4, 2) [m]."""
    return side / 2 * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def _diamond(reach: float) -> FloatArray:
    """Return the corners of a square rotated by 45°, anticlockwise, (4, 2) [m]."""
    return reach * np.array([[0.0, -1], [1, 0], [0, 1], [-1, 0]])


def _cell_positions(spec: SceneSpec) -> FloatArray:
    """Return all cells of all legs in the robot frame, x right, y forward, (legs, cells, 3) [m]."""
    homes = legs_of(spec.robot).under(spec.gait).homes_m
    cells = np.tile(spec.grid.cells, (len(homes), 1, 1))  # (legs, cells, 2)
    cells[..., 0] *= np.array(spec.gait.mirror)[:, None]
    positions = np.zeros((*cells.shape[:2], 3))
    positions[..., :2] = homes[:, None] + cells
    return positions


def _is_unchanged(action_values: ActionValuesView, drawn: ActionValuesView | None) -> bool:
    if drawn is None:
        return False
    scale = (action_values.low_m, action_values.high_m) == (drawn.low_m, drawn.high_m)
    return scale and action_values.values_m is drawn.values_m


def _flat_colors(colors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return batch_colors(colors, brightness=0.75)


def _add(
    server: viser.ViserServer,
    name: str,
    shape: Shape,
    positions: FloatArray,
    colors: NDArray[np.uint8],
) -> viser.BatchedMeshHandle:
    """Add a batch of the same flat shape at many positions, (n, 3) [m]."""
    return server.scene.add_batched_meshes_simple(
        name,
        shape.vertices,
        shape.faces,
        batched_positions=positions,
        batched_wxyzs=np.tile((1.0, 0.0, 0.0, 0.0), (len(positions), 1)),
        batched_colors=_flat_colors(colors),
        lod="off",
    )
