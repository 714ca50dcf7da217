"""The stage in viser: one immutable frame in, messages out, all of them in one window."""

import math
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.domain.types import FloatArray
from app.services.frames import Cast, StageFrame
from app.viewer.colormap import batched, mixed, rgb
from app.viewer.extras import Ghosts, PhotoFinish
from app.viewer.footgrid import FootGridDrawing
from app.viewer.plates import Plate
from app.viewer.robot_mesh import RobotMesh, robot_mesh
from app.viewer.track import WORLD, draw_ground, draw_lanes

CAST = f"{WORLD}/cast"
_DARK = (88, 96, 110)
_SHADE = 0.25
_EASE_S = 0.25
_ALONE_NEARER_M = 0.3
"""A single lane leaves room to come closer to it."""

Position = tuple[float, float, float]


class StageScene:
    """Draws on one viser server. Used by one thread; `follow_position` by any."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._drawn: _Drawing | None = None
        self._followed: dict[str, Position] = {}
        self._eased: tuple[float, float] | None = None
        with server.atomic():
            self._world = draw_ground(server)

    def draw(self, frame: StageFrame, now: float = math.inf) -> bool:
        """Show this frame.

        Args:
            frame: what is on stage.
            now: time of the drawing [s], by which the camera's way is eased.

        Returns:
            Whether anything moved.
        """
        with self._server.atomic():
            if self._drawn is None or self._drawn.cast != frame.cast:
                if self._drawn is not None:
                    self._drawn.remove()
                self._drawn, self._eased = _Drawing(self._server, frame.cast), None
            moved = self._drawn.draw(frame)
            moved |= self._follow(frame, self._drawn.xs, now)
        self._server.flush()
        return moved

    def follow_position(self, view: str) -> Position | None:
        """Where what a view follows is on the track [m]: `leader`, or a lane from `1`."""
        return self._followed.get(view)

    def centre(self, view: str) -> None:
        """Move the whole world so that what a view follows comes to the middle, for everyone.

        On stage the hub does this for each viewer; a film has but one.
        """
        x, y, _ = self._followed[view]
        self._world.position = (-x, -y, 0.0)

    def _follow(self, frame: StageFrame, xs: list[float], now: float) -> bool:
        """The leader's view goes along in the middle of the track, so that all stay in sight."""
        leader = max(lane.distance_m for lane in frame.lanes)
        lead = next(lane for lane in frame.lanes if lane.distance_m == leader)
        aim = float(lead.qpos[1])
        before = self._eased
        y = aim
        if before is not None and now > before[0]:
            y = aim + (before[1] - aim) * math.exp((before[0] - now) / _EASE_S)
        self._eased = (now, y)
        nearer = _ALONE_NEARER_M if len(frame.lanes) == 1 else 0.0
        followed = {"leader": (0.0, y + nearer, 0.0)}
        for number, (lane, x) in enumerate(zip(frame.lanes, xs, strict=True), start=1):
            followed[str(number)] = (x + float(lane.qpos[0]), float(lane.qpos[1]), 0.0)
        self._followed = followed
        return abs(y - aim) > 1e-4


class _Drawing:
    """Everything that belongs to one cast."""

    def __init__(self, server: viser.ViserServer, cast: Cast) -> None:
        self.cast = cast
        self._root = server.scene.add_frame(CAST, show_axes=False)
        width = 2 * cast.robot.home_radius_m + cast.grid.side_m + 0.08
        # Beside who practises there is a lane for the ghosts of its evaluations.
        lanes = len(cast.roles) + (cast.kind == "training")
        xs = [width * (lane - (lanes - 1) / 2) for lane in range(lanes)]
        draw_lanes(server, f"{CAST}/track", xs, width)
        self.xs = xs[: len(cast.roles)]
        mesh = robot_mesh(cast.robot)
        self._robots = _Robots(server, cast, mesh, self.xs)
        pairs = list(zip(cast.roles, self.xs, strict=True))
        self._plates = [
            Plate(server, f"{CAST}/lane{n}", role, x) for n, (role, x) in enumerate(pairs)
        ]
        self._grids: dict[int, FootGridDrawing] = {}
        self._photo = PhotoFinish(server, f"{CAST}/photo", cast, self.xs)
        ghosts = cast.kind == "training"
        self._ghosts = Ghosts(server, f"{CAST}/ghosts", cast, mesh, xs[-1]) if ghosts else None
        self._server = server

    def draw(self, frame: StageFrame) -> bool:
        """Show the frame; whether a robot moved."""
        moved = self._robots.draw(frame)
        for plate, lane in zip(self._plates, frame.lanes, strict=True):
            plate.draw(lane)
        for number, lane in enumerate(frame.lanes):
            if lane.knowledge is not None and number not in self._grids:
                root = f"{CAST}/lane{number}/grid"
                x = self.xs[number]
                self._grids[number] = FootGridDrawing(self._server, root, self.cast, x)
            if number in self._grids:
                self._grids[number].draw(lane)
        self._photo.draw(frame)
        if self._ghosts is not None:
            self._ghosts.draw(frame.ghosts)
        return moved

    def remove(self) -> None:
        """Take it all off the stage."""
        self._root.remove()


class _Robots:
    """All robots: one batched mesh for each distinct shape, across lanes."""

    def __init__(
        self, server: viser.ViserServer, cast: Cast, mesh: RobotMesh, xs: list[float]
    ) -> None:
        self._mesh, self._xs = mesh, xs
        self._poses: list[NDArray[np.floating[Any]]] = [np.empty(0)] * len(xs)
        self._placed: list[tuple[FloatArray, FloatArray]] = [mesh.place(mesh.standing) for _ in xs]
        self._batches: list[viser.BatchedMeshHandle] = []
        for number, part in enumerate(mesh.parts):
            colors = [_color(role.color, part.painted) for role in cast.roles]
            positions, wxyzs = self._instances(number)
            handle = server.scene.add_batched_meshes_simple(
                f"{CAST}/robots/{number}",
                part.shape.vertices,
                part.shape.faces,
                batched_positions=positions,
                batched_wxyzs=wxyzs,
                batched_colors=batched(np.repeat(np.array(colors), len(part.links), axis=0)),
                lod="off",
            )
            self._batches.append(handle)

    def draw(self, frame: StageFrame) -> bool:
        moved = False
        for lane, (view, x) in enumerate(zip(frame.lanes, self._xs, strict=True)):
            if np.array_equal(view.qpos, self._poses[lane]):
                continue
            self._poses[lane], moved = view.qpos, True
            places, attitudes = self._mesh.place(view.qpos)
            places[:, 0] += x
            self._placed[lane] = (places, attitudes)
        if moved:
            for number, batch in enumerate(self._batches):
                batch.batched_positions, batch.batched_wxyzs = self._instances(number)
        return moved

    def _instances(self, part: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(lanes · links, 3) and (lanes · links, 4)."""
        links = self._mesh.parts[part].links
        positions = np.concatenate([places[links] for places, _ in self._placed])
        wxyzs = np.concatenate([attitudes[links] for _, attitudes in self._placed])
        return positions.astype(np.float32), wxyzs.astype(np.float32)


def _color(color: str, painted: bool) -> tuple[int, int, int]:
    return rgb(color) if painted else mixed(_DARK, rgb(color), _SHADE)
