"""The stage in viser: one immutable frame in, messages out, all of them in one window."""

import math

import viser

from app.stage.stage_frame import SceneSpec, StageFrame
from app.viewer.footgrid import FootGridDrawing
from app.viewer.ghosts import Ghosts, PhotoFinish
from app.viewer.name_labels import Plate
from app.viewer.robot_mesh import RobotMesh
from app.viewer.robots import Robots
from app.viewer.track import LAMP, SQUARE_M, WORLD, draw_ground, draw_lanes

CAST = f"{WORLD}/cast"
_EASE_S = 0.25
_NEARER_M = 0.45
"""One robot leaves room to come closer to it."""
_WIDE, _FARTHER_M = 3, 0.5
"""More lanes than these do not fit side by side, but for each a step back."""

Position = tuple[float, float, float]


class StageScene:
    """Draws on one viser server. Used by one thread; `follow_position` by any."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._drawn: _Drawing | None = None
        self._followed: dict[str, Position] = {}
        self._eased: tuple[float, float] | None = None
        self._lit_y_m = 0.0
        with server.atomic():
            self._ground = draw_ground(server)

    def draw(self, frame: StageFrame, now: float = math.inf) -> bool:
        """Show this frame.

        Args:
            frame: what is on stage.
            now: time of the drawing [s], by which the camera's way is eased.

        Returns:
            Whether anything moved.
        """
        with self._server.atomic():
            if self._drawn is None or self._drawn.spec != frame.spec:
                if self._drawn is not None:
                    self._drawn.remove()
                self._drawn, self._eased = _Drawing(self._server, frame.spec), None
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
        self._ground.world.position = (-x, -y, 0.0)

    def _light(self, y_m: float) -> None:
        """Hang the lamp over robots that are about so far along the track."""
        if y_m != self._lit_y_m:
            self._lit_y_m = y_m
            x, y, z = LAMP
            self._ground.lamp.position = (x, y + y_m, z)

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
        self._light(round(aim / SQUARE_M) * SQUARE_M)
        nearer = _NEARER_M if len(frame.lanes) == 1 else -_FARTHER_M * max(0, len(xs) - _WIDE)
        followed = {"leader": (0.0, y + nearer, 0.0)}
        for number, (lane, x) in enumerate(zip(frame.lanes, xs, strict=True), start=1):
            followed[str(number)] = (x + float(lane.qpos[0]), float(lane.qpos[1]) + _NEARER_M, 0.0)
        self._followed = followed
        return abs(y - aim) > 1e-4


class _Drawing:
    """Everything that belongs to one cast."""

    def __init__(self, server: viser.ViserServer, spec: SceneSpec) -> None:
        self.spec = spec
        self._root = server.scene.add_frame(CAST, show_axes=False)
        width = 2 * spec.robot.home_radius_m + spec.grid.side_m + 0.08
        # Beside who practises there is a lane for the ghosts of its evaluations.
        lanes = len(spec.lane_specs) + (spec.kind == "training")
        xs = [width * (lane - (lanes - 1) / 2) for lane in range(lanes)]
        draw_lanes(server, f"{CAST}/track", xs, width)
        self.xs = xs[: len(spec.lane_specs)]
        mesh = RobotMesh(spec.robot)
        self._robots = Robots(server, f"{CAST}/robots", spec, mesh, self.xs)
        pairs = list(zip(spec.lane_specs, self.xs, strict=True))
        self._plates = [
            Plate(server, f"{CAST}/lane{n}", lane_spec, x) for n, (lane_spec, x) in enumerate(pairs)
        ]
        self._grids: dict[int, FootGridDrawing] = {}
        self._photo = PhotoFinish(server, f"{CAST}/photo", spec, self.xs)
        ghosts = spec.kind == "training"
        self._ghosts = Ghosts(server, f"{CAST}/ghosts", spec, mesh, xs[-1]) if ghosts else None
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
                self._grids[number] = FootGridDrawing(self._server, root, self.spec, x)
            if number in self._grids:
                self._grids[number].draw(lane)
        self._photo.draw(frame)
        if self._ghosts is not None:
            self._ghosts.draw(frame.ghosts)
        return moved

    def remove(self) -> None:
        """Take it all off the stage."""
        self._root.remove()
