"""Meshes of a robot: the visible geoms of its MJCF, merged into one mesh per link."""

from collections.abc import Iterable
from functools import lru_cache
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from hexapods.domain.kinematics import legs_of
from hexapods.domain.legs import Joint
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray, IntArray
from hexapods.domain.world import World
from hexapods.drawing.colormap import Rgb
from hexapods.drawing.condition_colors import link_color
from hexapods.drawing.shapes import Shape, antenna, geom_shape, joined
from hexapods.physics.mjcf import VISIBLE_GROUP, compile_visual_model, is_painted

_ANTENNA_M = 0.15
_OVER_TORSO_M = 0.1
"""Least height of the antenna's top over the top of the torso [m]."""


class Part(NamedTuple):
    """A mesh, and all links of the robot that have this shape (instances of one batch)."""

    shape: Shape
    """In the frame of the link."""
    painted: bool
    """Whether it has the agent's colour."""
    links: IntArray
    """Body ids in the MuJoCo model, (n,)."""


def antenna_m(robot: Robot) -> float:
    """Return the height of the antenna's top over the torso's centre [m]."""
    return max(_ANTENNA_M, robot.torso_half_height_m + _OVER_TORSO_M)


class BodyPoses(NamedTuple):
    """World poses of all bodies of the model in one configuration."""

    positions: FloatArray
    """(bodies, 3) [m]."""
    rotations: FloatArray
    """Unit quaternions wxyz, (bodies, 4)."""

    def moved(self, x_m: float, y_m: float = 0.0, z_m: float = 0.0) -> "BodyPoses":
        """Return the poses translated [m]."""
        return BodyPoses(self.positions + np.array([x_m, y_m, z_m]), self.rotations)


class RobotMesh:
    """Meshes and forward kinematics of one kind of robot.

    Not thread-safe: `body_poses` uses one `MjData`, so each thread needs its own instance.
    """

    def __init__(self, robot: Robot) -> None:
        self._model = compile_visual_model(robot)
        self._data = mujoco.MjData(self._model)
        self.parts = _parts(robot)
        self._joint_of_link = {
            self._model.body(joint.label).id: joint for joint in legs_of(robot).joints
        }
        """The joint that moves a link, by the link's body id."""

    @property
    def body_parts(self) -> tuple[Part, ...]:
        """The parts without the antenna."""
        return self.parts[:-1]

    def joint_of(self, link: int) -> Joint | None:
        """Return the joint that moves a link, by the link's body id; None for the torso."""
        return self._joint_of_link.get(link)

    def part_name(self, number: int, *, is_ghost: bool = False) -> str:
        """Return the name of a part's scene node: whose links its instances are.

        `1/legs-1-2-3` has the links of these legs, in this order, of each lane; by it
        `static/viewer/legs.js` finds which leg was clicked, and `static/viewer/shadows.js` what is
        near the ground. Those of a ghost, which cannot be clicked, are `1/ghost-legs-1-2-3`.
        """
        kind = f"{number}/{'ghost-' if is_ghost else ''}"
        joints = [self._joint_of_link.get(link) for link in self.parts[number].links.tolist()]
        if None in joints:
            return f"{kind}torso"
        return f"{kind}legs-{'-'.join(str(joint.leg) for joint in joints if joint)}"

    @property
    def default_qpos(self) -> FloatArray:
        """The model's reference configuration `qpos0`, (7 + joints,)."""
        pose: FloatArray = self._model.qpos0
        return pose

    def body_poses(self, qpos: NDArray[np.floating[Any]]) -> BodyPoses:
        """Return the poses of all bodies by forward kinematics of qpos, (7 + joints,)."""
        data = self._data
        data.qpos[:] = qpos
        mujoco.mj_kinematics(self._model, data)
        return BodyPoses(data.xpos.copy(), data.xquat.copy())

    def link_colors(self, part: Part, color: Rgb, conditions: World) -> list[Rgb | None]:
        """Return the colour of each link of a part, None for those of lost legs.

        Args:
            part: one of `parts`.
            color: the part's colour while nothing has happened to the robot.
            conditions: what holds, a result of `World.as_of`.
        """
        joints = [self._joint_of_link.get(link) for link in part.links.tolist()]
        return [link_color(color, conditions, joint) if joint else color for joint in joints]


@lru_cache(maxsize=8)
def _parts(robot: Robot) -> tuple[Part, ...]:
    """Return the parts of a robot; links of equal shape share one, whatever the number of legs."""
    model = compile_visual_model(robot)
    links: dict[tuple[int, bool], list[Shape]] = {}
    for geom in np.flatnonzero(model.geom_group == VISIBLE_GROUP):
        link, shape = _on_link(model, int(geom))
        name = model.geom(geom).name
        painted = is_painted(robot, name)
        links.setdefault((link, painted), []).append(shape)
    by_shape: dict[tuple[bytes, bool], tuple[Shape, list[int]]] = {}
    for (link, painted), shapes in links.items():
        shape = joined(shapes)
        key = ((shape.vertices.round(5) + 0.0).tobytes(), painted)  # + 0.0, since −0 is not 0 here
        by_shape.setdefault(key, (shape, []))[1].append(link)
    parts = [
        Part(shape, painted, np.array(bodies)) for (_, painted), (shape, bodies) in by_shape.items()
    ]
    return (*parts, _antenna(robot, model))


def _antenna(robot: Robot, model: mujoco.MjModel) -> Part:
    """Return the antenna under the name label, in the agent's colour; not part of the physics."""
    torso = model.body("torso").id
    return Part(antenna(antenna_m(robot)), True, np.array([torso]))


def _on_link(model: mujoco.MjModel, geom: int) -> tuple[int, Shape]:
    """Return the moving body that a geom is welded to, and the geom's shape in its frame."""
    body, shape = int(model.geom_bodyid[geom]), geom_shape(model, geom)
    shape = shape.moved(_matrix(model.geom_quat[geom]), model.geom_pos[geom])
    while body != model.body_weldid[body]:
        shape = shape.moved(_matrix(model.body_quat[body]), model.body_pos[body])
        body = int(model.body_parentid[body])
    return body, shape


def _matrix(wxyz: Iterable[float]) -> FloatArray:
    flat = np.empty(9)
    mujoco.mju_quat2Mat(flat, np.array(wxyz, float))
    return flat.reshape(3, 3)
