"""What a robot looks like: the visible geoms of its MJCF, joined to one mesh for each link."""

from collections.abc import Iterable
from functools import lru_cache
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from app.domain.robot import Robot
from app.domain.types import FloatArray, IntArray
from app.physics.mjcf import VISIBLE_GROUP, compile_model
from app.viewer.shapes import Shape, antenna, geom_shape, joined

_DARK = ("servo", "hip", "knee", "belly", "deck", "foot", "bracket")
"""Words in the names of geoms that are not painted in the agent's colour."""


ANTENNA_M = 0.15
"""Height of the top over the torso's centre."""


class Part(NamedTuple):
    """One shape, and all the links of the robot that look so."""

    shape: Shape
    """In the frame of the link."""
    painted: bool
    """Whether it has the agent's colour."""
    links: IntArray
    """Bodies of the model."""


class Placed(NamedTuple):
    """A robot in one pose."""

    places: FloatArray
    """Of all bodies of the model, (bodies, 3) [m]."""
    attitudes: FloatArray
    """Of all bodies, (bodies, 4) wxyz."""

    def moved(self, x_m: float, y_m: float = 0.0) -> "Placed":
        """The same, elsewhere on the track."""
        return Placed(self.places + np.array([x_m, y_m, 0.0]), self.attitudes)


class RobotMesh:
    """Draws robots of one kind: from joint positions to where each part is.

    Its scratch space is its own, so each thread has its own mesh.
    """

    def __init__(self, robot: Robot) -> None:
        self._model = compile_model(robot)
        self._data = mujoco.MjData(self._model)
        self.parts = _parts(robot)

    @property
    def standing(self) -> FloatArray:
        """The pose in which the model is written down, (7 + joints,)."""
        pose: FloatArray = self._model.qpos0
        return pose

    def place(self, qpos: NDArray[np.floating[Any]]) -> Placed:
        """Where everything is in this pose."""
        data = self._data
        data.qpos[:] = qpos
        mujoco.mj_kinematics(self._model, data)
        return Placed(data.xpos.copy(), data.xquat.copy())


@lru_cache(maxsize=8)
def _parts(robot: Robot) -> tuple[Part, ...]:
    """Links that look alike become one part, however many legs there are."""
    model = compile_model(robot)
    links: dict[tuple[int, bool], list[Shape]] = {}
    for geom in np.flatnonzero(model.geom_group == VISIBLE_GROUP):
        link, shape = _on_link(model, int(geom))
        name = model.geom(geom).name
        painted = not any(word in name for word in _DARK)
        links.setdefault((link, painted), []).append(shape)
    alike: dict[tuple[bytes, bool], tuple[Shape, list[int]]] = {}
    for (link, painted), shapes in links.items():
        shape = joined(shapes)
        key = ((shape.vertices.round(5) + 0.0).tobytes(), painted)  # + 0.0, since −0 is not 0 here
        alike.setdefault(key, (shape, []))[1].append(link)
    parts = [Part(shape, painted, np.array(on)) for (_, painted), (shape, on) in alike.items()]
    return (*parts, _antenna(model))


def _antenna(model: mujoco.MjModel) -> Part:
    """What carries the name plate, in the agent's colour; it is drawn only."""
    torso = model.body("torso").id
    return Part(antenna(ANTENNA_M), True, np.array([torso]))


def _on_link(model: mujoco.MjModel, geom: int) -> tuple[int, Shape]:
    """The body that moves a geom, and the geom's shape in that body's frame."""
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
