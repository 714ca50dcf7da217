"""Draw the stage in viser: each immutable frame becomes the messages by which it differs."""

from collections.abc import Sequence
from itertools import zip_longest

import viser

from hexapods.drawing.colormap import rgb
from hexapods.drawing.footgrid import FootGridDrawing
from hexapods.drawing.ghosts import Ghosts, PhotoFinish
from hexapods.drawing.lane_ground import LaneGround
from hexapods.drawing.payload_and_push import PayloadCube, PushArrows
from hexapods.drawing.robot_mesh import RobotMesh, antenna_m
from hexapods.drawing.robots import NameLabel, Robots
from hexapods.drawing.track import WORLD, Position, draw_ground, draw_lanes
from hexapods.shows.stage_frame import AT_ORIGIN, LaneFrame, SceneSpec, StageFrame

SCENE_ROOT = f"{WORLD}/run"
ROBOT_ROOTS = (f"{SCENE_ROOT}/robots", f"{SCENE_ROOT}/robots2")
"""Scene nodes of the robots, in turn: where one is removed and made again at once, viser's client
keeps its batched meshes, and draws those of another kind of robot with buffers that do not fit."""
_STEP_FORWARD_M = 0.45
"""Shift of the follow point that brings the camera nearer to a single robot [m]."""
_LANES_IN_VIEW, _STEP_BACK_M = 3, 0.5
"""Lanes that fit into view, and the shift that moves the camera back for each further one [m]."""


def grid_root(lane: int) -> str:
    """Return the scene node of the foot grid of a lane, counted from 0, which follows the robot."""
    return f"{SCENE_ROOT}/lane{lane}/grid"


class StageScene:
    """The stage's scene graph on one viser server."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._run_scene: _RunScene | None = None
        self._scenes = -1
        self._follow_positions: dict[str, Position] = {}
        draw_ground(server)

    def draw(self, frame: StageFrame) -> None:
        """Draw a frame of the stage."""
        if self._run_scene is None or self._run_scene.spec != frame.spec:
            if self._run_scene is not None:
                self._run_scene.remove()
            self._scenes += 1
            root = ROBOT_ROOTS[self._scenes % len(ROBOT_ROOTS)]
            self._run_scene = _RunScene(self._server, frame.spec, root)
        self._run_scene.draw(frame)
        self._update_follow_positions(frame, self._run_scene.xs)

    def follow_position(self, view: str) -> Position | None:
        """Return the follow point of a view on the track [m]: `leader`, or a lane from `1`."""
        return self._follow_positions.get(view)

    def _update_follow_positions(self, frame: StageFrame, xs: list[float]) -> None:
        """Update the follow points.

        The leader's is on the centre line of the track, so that all lanes stay in view.
        """
        leader = max(frame.lanes, key=lambda lane: lane.distance_m)
        y_m = float(leader.qpos[1])
        offset_m = (
            _STEP_FORWARD_M
            if len(frame.lanes) == 1
            else -_STEP_BACK_M * max(0, len(xs) - _LANES_IN_VIEW)
        )
        follow_positions = {"leader": (0.0, y_m + offset_m, 0.0)}
        for number, (lane, x) in enumerate(zip(frame.lanes, xs, strict=True), start=1):
            follow_positions[str(number)] = (
                x + float(lane.qpos[0]),
                float(lane.qpos[1]) + _STEP_FORWARD_M,
                0.0,
            )
        self._follow_positions = follow_positions


def lane_width_m(spec: SceneSpec) -> float:
    """Return the width of each lane [m], in which a robot has room to step aside."""
    return 2 * spec.robot.span_m + spec.grid.side_m + 0.08


class _RunScene:
    """The part of the scene graph that depends on the run: lanes, robots, labels and grids."""

    def __init__(self, server: viser.ViserServer, spec: SceneSpec, robots: str) -> None:
        self.spec = spec
        self._root = server.scene.add_frame(SCENE_ROOT, show_axes=False)
        self._ghost_spec = ghost_spec = spec.ghosts or spec
        width = max(lane_width_m(s) for s in (spec, ghost_spec))
        lane_specs = [*spec.lane_specs, *ghost_spec.lane_specs[len(spec.lane_specs) :]]
        # A training has a last lane for the ghosts of its evaluations.
        lanes = len(lane_specs) + (spec.kind == "training")
        xs = [width * (lane - (lanes - 1) / 2) for lane in range(lanes)]
        # Of the lane of ghosts, whose are those of the first.
        colors = [rgb(lane_spec.color) for lane_spec in (*lane_specs, lane_specs[0])[:lanes]]
        self._lines = draw_lanes(server, f"{SCENE_ROOT}/track", xs, width, colors)
        self._grounds = [
            LaneGround(
                server,
                f"{SCENE_ROOT}/lane{n}/ground",
                x,
                width,
                friction=spec.robot.friction,
                is_labelled=n == 0,
            )
            for n, x in enumerate(xs)
        ]
        self.xs = xs[: len(spec.lane_specs)]
        self._mesh = mesh = RobotMesh(spec.robot)
        self._robots = Robots(server, robots, spec, mesh, self.xs)
        self._ghost_xs = xs[: len(ghost_spec.lane_specs)]
        self._ghost_robots: Robots | None = None
        self._labels = [
            NameLabel(server, f"{SCENE_ROOT}/lane{n}", lane_spec, xs[n], antenna_m(spec.robot))
            for n, lane_spec in enumerate(lane_specs)
        ]
        self._payloads = [
            PayloadCube(server, f"{SCENE_ROOT}/lane{n}/payload", spec, x)
            for n, x in enumerate(self.xs)
        ]
        self._pushes = [
            PushArrows(server, f"{SCENE_ROOT}/lane{n}/push", spec, x) for n, x in enumerate(self.xs)
        ]
        self._grids: dict[int, FootGridDrawing] = {}
        self._photo = PhotoFinish(server, f"{SCENE_ROOT}/photo", spec, self.xs)
        self._ghosts: Ghosts | None = None
        if spec.kind == "training":
            evaluated = f"{robots}-evaluated"
            robot = Robots(server, evaluated, spec, mesh, xs[-1:], is_ghost=True)
            self._ghosts = Ghosts(server, f"{SCENE_ROOT}/ghosts", spec, robot, xs[-1])
        self._server = server

    def draw(self, frame: StageFrame) -> None:
        """Draw a frame."""
        # Ghosts on lanes beyond those of the run.
        alone = [ghost for ghost in frame.ghost_lanes[len(frame.lanes) :] if ghost is not None]
        self._draw_grounds(frame, alone)
        self._robots.draw(frame.lanes)
        self._draw_ghost_robots(frame.ghost_lanes)
        labelled = [*zip_longest(frame.lanes, frame.ghost_lanes[: len(frame.lanes)])]
        labelled += [(ghost, None) for ghost in alone]
        for number, (lane, ghost) in enumerate(labelled):
            self._labels[number].draw(
                lane, ghost, self._ghost_name(number), is_ranked=frame.phase == "photo-finish"
            )
        for number, lane in enumerate(frame.lanes):
            self._payloads[number].draw(lane)
            self._pushes[number].draw(lane)
        for number, lane in enumerate(frame.lanes):
            if lane.action_values is not None and number not in self._grids:
                root, x = grid_root(number), self.xs[number]
                self._grids[number] = FootGridDrawing(self._server, root, self.spec, x)
            if number in self._grids:
                self._grids[number].draw(lane)
        self._photo.draw(frame)
        if self._ghosts is not None:
            self._ghosts.draw(frame.ghosts)

    def _ghost_name(self, number: int) -> str:
        """Return the name of the ghost on a lane, for the label of the lane."""
        if self.spec.ghosts is None:
            return "original"
        names = [
            lane_spec.name
            for spec in (self.spec, self.spec.ghosts)
            for lane_spec in spec.lane_specs[number : number + 1]
        ]
        return "ghost" if len(set(names)) == 1 else f"ghost {names[-1]}"

    def _draw_grounds(self, frame: StageFrame, alone: Sequence[LaneFrame]) -> None:
        """Draw each lane's ground, and that of evaluations as it was in the newest one."""
        grounds = [(lane.conditions, lane.origin) for lane in (*frame.lanes, *alone)]
        if self._ghosts is not None:
            newest = frame.ghosts[-1].conditions if frame.ghosts else frame.lanes[0].conditions
            grounds.append((newest, AT_ORIGIN))
        for ground, (conditions, origin) in zip(self._grounds, grounds, strict=True):
            ground.draw(conditions, origin)
        self._lines.raise_over(max(conditions.ground_m(0) for conditions, _ in grounds))

    def _draw_ghost_robots(self, ghosts: Sequence[LaneFrame | None]) -> None:
        """Draw the robots of the other run, over those on the lanes of the same number."""
        if self._ghost_robots is None:
            # Also before a branch parts from its original, so that meshes are sent with the scene.
            if not ghosts:
                return
            spec, root = self._ghost_spec, f"{SCENE_ROOT}/ghost-robots"
            mesh = self._mesh if spec.robot == self.spec.robot else RobotMesh(spec.robot)
            self._ghost_robots = Robots(
                self._server, root, spec, mesh, self._ghost_xs, is_ghost=True
            )
        self._ghost_robots.draw(ghosts or [None] * len(self._ghost_xs))

    def remove(self) -> None:
        """Remove the nodes of the run from viser's scene."""
        self._root.remove()
