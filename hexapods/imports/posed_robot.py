"""A robot with all joints of its legs at 0, in the body frame: x right, y forward, z up.

The origin is the centre of the legs' mounts. A link is the set of bodies that move with one joint;
its frame has the axes of the body frame, and its origin on the joint's axis.
"""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from hexapods.domain.types import FloatArray
from hexapods.imports.compiling import Compiled
from hexapods.imports.legs.feet import FoundLeg
from hexapods.imports.legs.skeleton import Skeleton
from hexapods.imports.surfaces import Triangles, kind_of, triangles_of

_MAX_KEYFRAMES = 50
_FREE = int(mujoco.mjtJoint.mjJNT_FREE)


class PosedRobot:
    """A robot in its reference pose.

    Attributes:
        compiled: the model.
        skeleton: torso and legs.
        legs: the legs, in no order until `order` is called.
        turn_deg: direction of forward, anticlockwise from x of the file.
    """

    def __init__(
        self,
        compiled: Compiled,
        skeleton: Skeleton,
        pose: FloatArray,
        *,
        keeps_frame: bool = False,
    ) -> None:
        """Pose a robot.

        Args:
            compiled: the model.
            skeleton: torso and legs.
            pose: `qpos`; its angles of legs are not used.
            keeps_frame: whether the torso's frame is the body frame.
        """
        self.compiled, self.skeleton = compiled, skeleton
        self.legs: Sequence[FoundLeg] = skeleton.legs
        self._data = mujoco.MjData(compiled.model)
        self._data.qpos[:] = pose
        for leg in skeleton.legs:
            for joint in leg.joints:
                self._data.qpos[compiled.model.jnt_qposadr[joint]] = 0
        mujoco.mj_kinematics(compiled.model, self._data)
        mounts = self._data.xanchor[[leg.joints[0] for leg in skeleton.legs]]
        self._origin: FloatArray = (mounts.min(axis=0) + mounts.max(axis=0)) / 2
        if keeps_frame:
            self._origin = np.array(self._data.xpos[skeleton.root])
        self._turn: FloatArray = np.eye(3)
        self.turn_deg = 0.0
        self._joint_of_body = self._joints_that_move()

    def turn(self, forward_deg: float) -> None:
        """Turn the body frame: forward is this direction, anticlockwise from x of the file [°]."""
        self.turn_deg = forward_deg
        self._turn = rotation_to_forward(forward_deg)

    def order(self, legs: Sequence[int]) -> None:
        """Number the legs."""
        self.legs = [self.skeleton.legs[leg] for leg in legs]

    def mounts(self) -> FloatArray:
        """Return the position of each leg's first joint, (legs, 3) [m]."""
        return np.array([self.anchor(leg.joints[0]) for leg in self.legs])

    def anchor(self, joint: int) -> FloatArray:
        """Return a point of a joint's axis, (3,) [m]."""
        return self._at(self._data.xanchor[joint])

    def axis(self, joint: int) -> FloatArray:
        """Return a joint's axis, a unit vector, (3,)."""
        axis = self._turn @ self._data.xaxis[joint]
        return np.asarray(axis / np.linalg.norm(axis))

    def foot(self, leg: FoundLeg) -> FloatArray:
        """Return the centre of a foot, (3,) [m]."""
        return self._at(leg.foot.in_world(self._data))

    def bodies_of(self, joint: int | None) -> list[int]:
        """Return the bodies that move with a joint of a leg; None for the torso's."""
        return [body for body in self.skeleton.bodies if self._joint_of_body[body] == joint]

    def geoms_of(self, bodies: Sequence[int]) -> list[int]:
        """Return the geoms of some bodies."""
        bodies_of_geoms = self.compiled.model.geom_bodyid.tolist()
        return [geom for geom, body in enumerate(bodies_of_geoms) if body in bodies]

    def center_of_mass(self, body: int) -> FloatArray:
        """Return the centre of mass of a body, (3,) [m]."""
        rotation = self._data.xmat[body].reshape(3, 3)
        return self._at(self._data.xpos[body] + rotation @ self.compiled.model.body_ipos[body])

    def inertia(self, body: int) -> FloatArray:
        """Return the inertia of a body about its centre of mass, (3, 3) [kg·m²]."""
        model = self.compiled.model
        principal = _matrix(model.body_iquat[body])
        rotation = self._turn @ self._data.xmat[body].reshape(3, 3) @ principal
        return np.asarray(rotation @ np.diag(model.body_inertia[body]) @ rotation.T)

    def geom_rotation(self, geom: int) -> FloatArray:
        """Return the rotation of a geom, (3, 3)."""
        model = self.compiled.model
        body = self._data.xmat[model.geom_bodyid[geom]].reshape(3, 3)
        return np.asarray(self._turn @ body @ _matrix(model.geom_quat[geom]))

    def geom_center(self, geom: int) -> FloatArray:
        """Return the origin of a geom's frame, (3,) [m]."""
        model = self.compiled.model
        body = int(model.geom_bodyid[geom])
        rotation = self._data.xmat[body].reshape(3, 3)
        return self._at(self._data.xpos[body] + rotation @ model.geom_pos[geom])

    def surface(self, geom: int) -> Triangles:
        """Return the surface of a geom: vertices, (n, 3) [m], and faces, (m, 3)."""
        return self.placed(geom, self.own_surface(geom))

    def own_surface(self, geom: int) -> Triangles:
        """Return the surface of a geom in its own frame."""
        return triangles_of(self.compiled.model, geom)

    def placed(self, geom: int, surface: Triangles) -> Triangles:
        """Return a surface in a geom's frame, moved to the body frame."""
        vertices, faces = surface
        return vertices @ self.geom_rotation(geom).T + self.geom_center(geom), faces

    def mesh_of(self, geom: int) -> int | None:
        """Return the id of a geom's mesh; None if it is a primitive."""
        mesh = int(self.compiled.model.geom_dataid[geom])
        return mesh if self.kind(geom) == "mesh" and mesh >= 0 else None

    def triangles(self, geom: int) -> int:
        """Return the number of triangles of a geom."""
        mesh = self.mesh_of(geom)
        if mesh is None:
            return len(self.own_surface(geom)[1])
        return int(self.compiled.model.mesh_facenum[mesh])

    def kind(self, geom: int) -> str:
        """Return the kind of a geom: `mesh`, or that of a primitive."""
        return kind_of(self.compiled.model, geom)

    def _at(self, place: FloatArray) -> FloatArray:
        return np.asarray(self._turn @ (place - self._origin))

    def _joints_that_move(self) -> dict[int, int | None]:
        """Return for each body the last joint of a leg above it."""
        model = self.compiled.model
        last: dict[int, int] = {}
        for leg in self.skeleton.legs:
            for joint in leg.joints:
                last[int(model.jnt_bodyid[joint])] = joint
        joint_of: dict[int, int | None] = {}
        for body in self.skeleton.bodies:  # parents come first
            above = joint_of.get(int(model.body_parentid[body]))
            joint_of[body] = last.get(body, above)
        return joint_of


def rotation_to_forward(forward_deg: float) -> FloatArray:
    """Return the rotation to the body frame, in which y is forward, (3, 3).

    Args:
        forward_deg: direction of forward, anticlockwise from x of the file [°].
    """
    cos, sin = math.cos(math.radians(forward_deg)), math.sin(math.radians(forward_deg))
    return np.round([[sin, -cos, 0], [cos, sin, 0], [0, 0, 1]], 15)


def keyframes_of(model: mujoco.MjModel) -> dict[str, FloatArray]:
    """Return `qpos` of each keyframe that is finite, by name; of very many the first."""
    keyframes = {}
    for key in range(min(model.nkey, _MAX_KEYFRAMES)):
        qpos = np.array(model.key_qpos[key])
        if np.isfinite(qpos).all():
            keyframes[model.key(key).name or f"keyframe {key + 1}"] = qpos
    return keyframes


def initial_pose(model: mujoco.MjModel) -> FloatArray:
    """Return `qpos` of the keyframe that is called home, else of the first, else of the file."""
    keyframes = keyframes_of(model)
    if not keyframes:
        return resting_pose(model, model.qpos0)
    home = next((name for name in keyframes if "home" in name.lower()), next(iter(keyframes)))
    return resting_pose(model, keyframes[home])


def resting_pose(model: mujoco.MjModel, like: FloatArray) -> FloatArray:
    """Return `qpos` with the initial pose of the base, and the joints of `like`, within limits."""
    pose = np.array(like)
    for joint in range(model.njnt):
        start = int(model.jnt_qposadr[joint])
        is_base = int(model.body_parentid[model.jnt_bodyid[joint]]) == 0
        if is_base or int(model.jnt_type[joint]) == _FREE:
            end = int(model.jnt_qposadr[joint + 1]) if joint + 1 < model.njnt else model.nq
            pose[start:end] = model.qpos0[start:end]
        elif model.jnt_limited[joint]:
            pose[start] = np.clip(pose[start], *model.jnt_range[joint])
    return pose


def _matrix(quaternion: FloatArray) -> FloatArray:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array(quaternion, dtype=np.float64))
    return matrix.reshape(3, 3)
