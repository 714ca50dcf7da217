"""A picture of the bodies in a file, for a person who confirms or corrects what was guessed.

It is drawn from the compiled file, so that a file whose legs are not understood is seen as well.
"""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from hexapods.domain.model_geometry import home_angles, leg_chains
from hexapods.domain.robot_model import MIN_JOINTS, Vector
from hexapods.domain.types import FloatArray
from hexapods.imports.compiling import Compiled
from hexapods.imports.drawing import drawn_geoms, merged_mesh
from hexapods.imports.imported import ImportedRobot, Sketch, SketchFoot, SketchPart
from hexapods.imports.legs.feet import Foot, find_foot
from hexapods.imports.meshes.decimation import cluster
from hexapods.imports.posed_robot import initial_pose, rotation_to_forward
from hexapods.imports.surfaces import Triangles, triangles_of

MAX_TRIANGLES = 40_000
"""Triangles of all parts together."""
_MIN_TRIANGLES = 60
"""Triangles of a shape, however many there are."""
_ROD_WIDTH = 0.06
"""Half the width of a rod, as a share of its length."""
_HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)


def sketch_robot(compiled: Compiled, robot: ImportedRobot | None) -> Sketch:
    """Return the bodies of a file: as the robot stands, or as the file begins if there is none.

    Without a robot, x of the file is taken for forward.
    """
    return _Sketcher(compiled, robot).sketch()


class _Sketcher:
    def __init__(self, compiled: Compiled, robot: ImportedRobot | None) -> None:
        self._compiled, self._model, self._robot = compiled, compiled.model, robot
        self._parents: list[int] = self._model.body_parentid.tolist()
        self._leg_of_joint = self._legs_of_joints()
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:] = initial_pose(self._model)
        if robot is not None:
            for number, angles in home_angles(robot.model).items():
                for name, angle in zip(robot.legs[number - 1].joints, angles, strict=True):
                    self._data.qpos[self._model.joint(name).qposadr[0]] = angle
        mujoco.mj_kinematics(self._model, self._data)
        self._rotation = rotation_to_forward(0.0 if robot is None else robot.forward_deg)
        self._origin: FloatArray = np.zeros(3)
        if robot is not None:
            first = [int(self._model.joint(leg.joints[0]).id) for leg in robot.legs]
            mounts = self._data.xanchor[first]
            self._origin = (mounts.min(axis=0) + mounts.max(axis=0)) / 2

    def sketch(self) -> Sketch:
        bodies = [body for body in range(1, self._model.nbody) if self._is_of_robot(body)]
        feet = self._feet_of_robot() if self._robot else self._possible_feet(bodies)
        surfaces = self._surfaces(bodies, feet)
        self._stand([*surfaces.values()], feet)
        moved_feet = [
            SketchFoot(name, leg, self._vector(at_m), radius_m)
            for name, leg, at_m, radius_m in feet
        ]
        parts = [self._part(body, surfaces[body]) for body in bodies]
        return Sketch(tuple(parts), tuple(moved_feet))

    def _legs_of_joints(self) -> dict[int, int]:
        legs = () if self._robot is None else self._robot.legs
        return {
            int(self._model.joint(name).id): number
            for number, leg in enumerate(legs, start=1)
            for name in leg.joints
        }

    def _is_of_robot(self, body: int) -> bool:
        """Whether a body has the root of the robot above it; all bodies where there is none."""
        if self._robot is None:
            return True
        first_leg_body = int(self._model.jnt_bodyid[next(iter(self._leg_of_joint))])
        return int(self._model.body_rootid[body]) == int(self._model.body_rootid[first_leg_body])

    def _surfaces(self, bodies: Sequence[int], feet: Sequence["_Foot"]) -> dict[int, Triangles]:
        """Return what is drawn of each body, in the frame of the file.

        Bodies without shapes are drawn as rods to the next bodies and to their foot.
        """
        geoms = {body: drawn_geoms(self._compiled, body) for body in bodies}
        shapes = {
            geom: triangles_of(self._model, geom) for listed in geoms.values() for geom in listed
        }
        count = sum(len(faces) for _, faces in shapes.values())  # whole numbers
        share = min(1.0, MAX_TRIANGLES / max(count, 1))
        surfaces = {
            body: self._surface([(geom, shapes[geom]) for geom in geoms[body]], share)
            for body in bodies
        }
        bare = [body for body in bodies if not len(surfaces[body][0])]
        return surfaces | {body: self._rods(body, bodies, feet) for body in bare}

    def _rods(self, body: int, bodies: Sequence[int], feet: Sequence["_Foot"]) -> Triangles:
        """Return rods from a body to the bodies below it, and to its foot."""
        start = self._data.xpos[body]
        ends = [self._data.xpos[below] for below in bodies if self._parents[below] == body]
        ends += [at_m for name, _, at_m, _ in feet if name == self._compiled.body_name(body)]
        rods = [_rod(start, end) for end in ends]
        return _joined([rod for rod in rods if len(rod[0])])

    def _surface(self, shapes: Sequence[tuple[int, Triangles]], share: float) -> Triangles:
        surfaces = []
        for geom, (vertices, faces) in shapes:
            most = max(int(share * len(faces)), _MIN_TRIANGLES)
            shown, corners = cluster(vertices, faces, most) if share < 1 else (vertices, faces)
            rotation = self._data.geom_xmat[geom].reshape(3, 3)
            placed = shown @ rotation.T + self._data.geom_xpos[geom]
            if len(corners) and np.isfinite(placed).all():
                surfaces.append((placed, corners))
        return _joined(surfaces)

    def _stand(self, surfaces: Sequence[Triangles], feet: Sequence["_Foot"]) -> None:
        """Move the origin so that the lowest foot touches the ground, or else the lowest point."""
        lows = [
            float((self._rotation @ (at - self._origin))[2]) - radius for *_, at, radius in feet
        ]
        if self._robot is None:
            points = [
                self._placed(vertices)[:, 2].min() for vertices, _ in surfaces if len(vertices)
            ]
            lows += map(float, points)
        self._origin = self._origin + self._rotation.T @ np.array([0, 0, min(lows, default=0.0)])

    def _feet_of_robot(self) -> list["_Foot"]:
        """Return the feet of the legs, in the frame of the file."""
        if self._robot is None:
            return []
        chains = leg_chains(self._robot.model, home_angles(self._robot.model))
        return [
            (leg.foot, number, self._origin + self._rotation.T @ chain.foot_m, foot.radius_m)
            for number, (leg, chain, foot) in enumerate(
                zip(self._robot.legs, chains, self._robot.model.feet, strict=True), start=1
            )
        ]

    def _possible_feet(self, bodies: Sequence[int]) -> list["_Foot"]:
        """Return the ends of chains that are long enough for a leg, in the frame of the file."""
        feet = []
        with_hinges = [body for body in bodies if self._hinges(body)]
        inner = {above for body in with_hinges for above in self._above(body)}
        for body in with_hinges:
            if body in inner or len(self._chain(body)) < MIN_JOINTS:
                continue
            rigid = [other for other in bodies if body in (other, *self._above(other))]
            foot: Foot = find_foot(self._compiled, self._data, rigid, self._chain(body)[-1])
            feet.append((foot.name, 0, foot.in_world(self._data), float(foot.radius_m)))
        return feet

    def _above(self, body: int) -> list[int]:
        """Return the bodies above a body, below the world."""
        above = []
        while (body := self._parents[body]) != 0:
            above.append(body)
        return above

    def _hinges(self, body: int) -> list[int]:
        start, count = int(self._model.body_jntadr[body]), int(self._model.body_jntnum[body])
        joints = range(start, start + count)
        return [joint for joint in joints if int(self._model.jnt_type[joint]) == _HINGE]

    def _chain(self, body: int) -> list[int]:
        """Return the hinges between a body and the root below which it is."""
        moving = [above for above in (body, *self._above(body)) if self._parents[above] != 0]
        return [joint for above in reversed(moving) for joint in self._hinges(above)]

    def _part(self, body: int, surface: Triangles) -> SketchPart:
        vertices, faces = self._placed(surface[0]), surface[1]
        if len(vertices):
            at_m = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
            low_m = vertices[int(vertices[:, 2].argmin())]
        else:
            at_m = low_m = self._placed(self._data.xpos[body][None])[0]
        leg = self._leg_of(body)
        return SketchPart(
            self._compiled.body_name(body),
            leg,
            self._foot_name(body, leg),
            _vector(at_m),
            _vector(low_m),
            merged_mesh([(vertices, faces)], np.zeros(3)),
        )

    def _leg_of(self, body: int) -> int:
        """Return the leg whose joint moves a body; 0 if it is of none."""
        for above in (body, *self._above(body)):
            for joint in self._hinges(above):
                if joint in self._leg_of_joint:
                    return self._leg_of_joint[joint]
        return 0

    def _foot_name(self, body: int, leg: int) -> str | None:
        if len(self._chain(body)) < MIN_JOINTS:
            return None
        if self._robot is not None and leg:
            joints = self._robot.legs[leg - 1].joints
            last = int(self._model.jnt_bodyid[self._model.joint(joints[-1]).id])
            # Its last link is the foot, by whatever name.
            if last in (body, *self._above(body)):
                return self._robot.legs[leg - 1].foot
        return self._compiled.body_name(body)

    def _placed(self, points: FloatArray) -> FloatArray:
        moved: FloatArray = (points - self._origin) @ self._rotation.T
        return moved

    def _vector(self, at_m: FloatArray) -> Vector:
        return _vector(self._placed(at_m[None])[0])


def _joined(surfaces: Sequence[Triangles]) -> Triangles:
    """Return several surfaces as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    faces = [faces + start for (_, faces), start in zip(surfaces, starts, strict=False)]
    return (
        np.concatenate([np.empty((0, 3)), *(vertices for vertices, _ in surfaces)]),
        np.concatenate([np.empty((0, 3), np.int64), *faces]),
    )


def _rod(start: FloatArray, end: FloatArray) -> Triangles:
    """Return a thin rod between two points; empty where they coincide."""
    along = end - start
    length_m = float(np.linalg.norm(along))
    if not 1e-6 < length_m < math.inf:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    along = along / length_m
    across = np.cross(along, np.eye(3)[int(np.abs(along).argmin())])
    across *= _ROD_WIDTH * length_m / np.linalg.norm(across)
    other = np.cross(along, across)
    corners = [across, other, -across, -other]
    vertices = np.array([point + corner for point in (start, end) for corner in corners])
    sides = [((n, (n + 1) % 4, n + 4), ((n + 1) % 4, (n + 1) % 4 + 4, n + 4)) for n in range(4)]
    caps = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)]
    return vertices, np.array([*(face for side in sides for face in side), *caps])


_Foot = tuple[str, int, FloatArray, float]
"""Name, leg, centre in the frame of the file (3,) [m], and radius [m]."""


def _vector(point: FloatArray) -> Vector:
    x, y, z = (round(float(value), 6) + 0.0 if math.isfinite(value) else 0.0 for value in point)
    return x, y, z
