"""The foot grid under a learner's feet (paper, Figure 1), as a map of what it expects."""

import math

import numpy as np
import viser
from numpy.typing import NDArray

from app.domain.types import FloatArray
from app.services.attitude import yaw_rad
from app.services.frames import Cast, KnowledgeView, LaneView
from app.viewer.colormap import Rgb, batched, rgb, value_colors
from app.viewer.shapes import Shape, disc, ring

_HOME: Rgb = rgb("#e5484d")
_OTHER: Rgb = rgb("#4c8dff")
_BLANK: Rgb = (70, 78, 92)
_ABOVE_GROUND_M = 0.003
_LAYER = np.array([0.0, 0.0, 0.0006])
"""What lies over something else, so that it is not hidden by it [m]."""


class FootGridDrawing:
    """The cells of one lane, centred on each foot's home in the body's frame.

    Rims are red at home and blue elsewhere, as in the paper; the fill is the value of moving the
    pair there now. The cell where a pair is has a white ring and no value: it is no choice.
    """

    def __init__(self, server: viser.ViserServer, root: str, cast: Cast, x_m: float) -> None:
        self._cast, self._x_m = cast, x_m
        self._forward_rad = math.radians(90 - cast.gait.forward_deg)
        self._places = _places(cast)  # (legs, cells, 3)
        legs, cells = self._places.shape[:2]
        radius = 0.47 * _spacing(cast.grid.cells)
        self._frame = server.scene.add_frame(root, show_axes=False)
        flat = self._places.reshape(-1, 3)
        is_home = np.arange(len(flat)) % cells == 0
        self._figure = np.where(is_home[:, None], _HOME, _OTHER).astype(np.uint8)
        _add(server, f"{root}/rims", disc(radius), flat, self._figure)
        lifted = flat + _LAYER
        self._fills = _add(server, f"{root}/fills", disc(0.8 * radius), lifted, self._figure)
        homes, white = lifted[::cells] + _LAYER, np.full((legs, 3), 255, np.uint8)
        self._here = _add(server, f"{root}/here", ring(0.72 * radius, radius), homes, white)
        self._here.visible = False
        self._known: KnowledgeView | None = None
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
        self._fills.batched_colors = batched(self._fill_colors(known))
        at = [known.current[pair] for pair in self._pair_of_leg]
        self._here.batched_positions = self._places[np.arange(len(at)), at] + 2 * _LAYER
        self._here.visible = True

    @property
    def _pair_of_leg(self) -> list[int]:
        pairs = self._cast.gait.pairs
        legs = range(1, len(self._places) + 1)
        return [next(p for p, both in enumerate(pairs) if leg in both) for leg in legs]

    def _fill_colors(self, known: KnowledgeView) -> NDArray[np.uint8]:
        """Of every cell of every leg, (legs · cells, 3)."""
        values = known.values_m[self._pair_of_leg]  # (legs, cells)
        colors = value_colors(values, known.low_m, known.high_m)
        colors[np.isnan(values)] = _BLANK
        return colors.reshape(-1, 3)


def _places(cast: Cast) -> FloatArray:
    """Every cell of every leg in the robot frame, x right and y forward, (legs, cells, 3)."""
    azimuth = np.radians(cast.gait.azimuths_deg)
    homes = cast.robot.home_radius_m * np.stack([-np.sin(azimuth), np.cos(azimuth)], axis=1)
    cells = np.tile(cast.grid.cells, (len(homes), 1, 1))  # (legs, cells, 2)
    partners = [partner - 1 for _, partner in cast.gait.pairs]
    cells[partners, :, 0] *= -1
    places = np.zeros((*cells.shape[:2], 3))
    places[..., :2] = homes[:, None] + cells
    return places


def _spacing(cells: FloatArray) -> float:
    """Distance between the two cells that are nearest to each other [m]."""
    apart = np.hypot(*(cells[:, None] - cells[None]).transpose(2, 0, 1))
    return float(apart[apart > 0].min())


def _same(known: KnowledgeView, before: KnowledgeView | None) -> bool:
    if before is None:
        return False
    scale = (known.low_m, known.high_m) == (before.low_m, before.high_m)
    return scale and known.values_m is before.values_m


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
        batched_colors=batched(colors),
        lod="off",
        cast_shadow=False,
        receive_shadow=False,
    )
