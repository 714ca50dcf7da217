"""Finds the foot at the end of a chain: its place, its radius and what it is called."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from hexapods.domain.types import FloatArray
from hexapods.imports.compiling import Compiled
from hexapods.imports.surfaces import kind_of, triangles_of

_FOOT = re.compile(r"foot|feet|toe|tip|sole|paw|tarsus", re.IGNORECASE)
_RADIUS_SHARE = 0.04
"""Radius of a foot without a round shape, as a share of its last link's length."""
_LEAST_RADIUS_M, _MOST_RADIUS_M = 0.003, 0.1


@dataclass(frozen=True)
class Foot:
    """A foot.

    Attributes:
        body: id of the body that has it.
        at_m: its centre in the frame of the body.
        radius_m: its radius.
        name: what it is called in the file.
        is_guessed: whether no round shape says its place and radius.
    """

    body: int
    at_m: FloatArray
    radius_m: float
    name: str
    is_guessed: bool

    def in_world(self, data: mujoco.MjData) -> FloatArray:
        """Return its centre in the world, (3,)."""
        rotation = data.xmat[self.body].reshape(3, 3)
        centre: FloatArray = data.xpos[self.body] + rotation @ self.at_m
        return centre


@dataclass(frozen=True)
class FoundLeg:
    """A leg.

    Attributes:
        joints: ids of its hinges, from the torso to the foot.
        foot: its foot.
    """

    joints: tuple[int, ...]
    foot: Foot


def find_foot(
    compiled: Compiled,
    data: mujoco.MjData,
    bodies: Sequence[int],
    last_joint: int,
    wheels: Collection[int] = (),
) -> Foot:
    """Find the foot among bodies that move together.

    It is the outermost ball that touches the ground, or an end of a capsule; otherwise the point
    farthest from the last joint.

    Args:
        compiled: the model.
        data: its state, for the distances.
        bodies: that move with the last link.
        last_joint: id of the joint by which they turn.
        wheels: ids of joints that are locked wheels.
    """
    model = compiled.model
    from_m = np.array(data.xanchor[last_joint])
    for wheel in wheels:
        body = int(model.jnt_bodyid[wheel])
        if body in bodies:
            return _wheel(compiled, body, wheel)
    balls = list(_round_ends(compiled, bodies))
    colliding = [foot for foot, collides in balls if collides]
    for feet in (colliding, [foot for foot, _ in balls]):
        named = [foot for foot in feet if _is_called_foot(compiled, foot)]
        if named or feet:
            best = max(
                named or feet, key=lambda foot: float(np.linalg.norm(foot.in_world(data) - from_m))
            )
            # A ball at the joint is its cover, not the foot.
            if named or _is_outermost(compiled, data, bodies, best, from_m):
                return best
    return _tip(compiled, data, bodies, from_m)


def chosen_foot(
    compiled: Compiled,
    data: mujoco.MjData,
    name: str,
    bodies: Sequence[int],
    hinges: Collection[int],
) -> Foot | None:
    """Return the foot that a person named by a geom, a site or a body; None if there is none."""
    model = compiled.model
    geom = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name)
    if geom >= 0 and int(model.geom_bodyid[geom]) in bodies:
        return _foot_of_geom(compiled, data, geom, hinges)
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name)
    if site >= 0 and int(model.site_bodyid[site]) in bodies:
        body, at_m = int(model.site_bodyid[site]), np.array(model.site_pos[site])
        return Foot(body, at_m, _radius(compiled, data, body, at_m, hinges), name, True)
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    return _foot_of_body(compiled, data, body, hinges) if body in bodies else None


def _foot_of_geom(
    compiled: Compiled, data: mujoco.MjData, geom: int, hinges: Collection[int]
) -> Foot:
    body = int(compiled.model.geom_bodyid[geom])
    ends = [foot for foot, _ in _round_ends(compiled, [body], [geom])]
    from_m = _above(compiled, data, body, hinges)
    if ends:
        return max(ends, key=lambda foot: float(np.linalg.norm(foot.in_world(data) - from_m)))
    return _tip(compiled, data, [body], from_m, [geom])


def _foot_of_body(
    compiled: Compiled, data: mujoco.MjData, body: int, hinges: Collection[int]
) -> Foot:
    name = compiled.body_name(body)
    joint = _joint_above(compiled, body, hinges)
    if joint is None or not any(compiled.model.geom_bodyid == body):
        at_m = np.zeros(3)
        return Foot(body, at_m, _radius(compiled, data, body, at_m, hinges), name, True)
    foot = find_foot(compiled, data, [body], joint)
    return Foot(body, foot.at_m, foot.radius_m, name, foot.is_guessed)


def _joint_above(compiled: Compiled, body: int, hinges: Collection[int]) -> int | None:
    model = compiled.model
    while body:
        joints = [joint for joint in hinges if int(model.jnt_bodyid[joint]) == body]
        if joints:
            return joints[-1]
        body = int(model.body_parentid[body])
    return None


def _above(
    compiled: Compiled, data: mujoco.MjData, body: int, hinges: Collection[int]
) -> FloatArray:
    """Return the place of the joint that moves a body, or of the body itself."""
    joint = _joint_above(compiled, body, hinges)
    return np.array(data.xpos[body] if joint is None else data.xanchor[joint])


def _radius(
    compiled: Compiled, data: mujoco.MjData, body: int, at_m: FloatArray, hinges: Collection[int]
) -> float:
    centre = data.xpos[body] + data.xmat[body].reshape(3, 3) @ at_m
    return _guessed_radius(float(np.linalg.norm(centre - _above(compiled, data, body, hinges))))


def _guessed_radius(length_m: float) -> float:
    return min(max(_RADIUS_SHARE * length_m, _LEAST_RADIUS_M), _MOST_RADIUS_M)


def _name(compiled: Compiled, body: int, geom: int | None = None) -> str:
    name = "" if geom is None else compiled.geom_name(geom)
    return name if name in compiled.named_geoms else compiled.body_name(body)


def _is_called_foot(compiled: Compiled, foot: Foot) -> bool:
    return any(map(_FOOT.search, (foot.name, compiled.body_name(foot.body))))


def _round_ends(
    compiled: Compiled, bodies: Sequence[int], geoms: Sequence[int] | None = None
) -> list[tuple[Foot, bool]]:
    """Return the balls and the ends of capsules, and whether each touches the ground."""
    model = compiled.model
    ends = []
    for geom in range(model.ngeom) if geoms is None else geoms:
        body, kind = int(model.geom_bodyid[geom]), kind_of(model, geom)
        if body not in bodies or kind not in ("sphere", "capsule"):
            continue
        centre, radius_m = np.array(model.geom_pos[geom]), float(model.geom_size[geom][0])
        half_m = float(model.geom_size[geom][1]) if kind == "capsule" else 0.0
        axis = _rotation(model.geom_quat[geom])[:, 2]
        for sign in (1, -1) if half_m else (0,):
            at_m = centre + sign * half_m * axis
            foot = Foot(body, at_m, radius_m, _name(compiled, body, geom), False)
            ends.append((foot, compiled.collides[geom]))
    return ends


def _wheel(compiled: Compiled, body: int, joint: int) -> Foot:
    """Return a ball as large as a wheel."""
    model = compiled.model
    centre, axis = np.array(model.jnt_pos[joint]), np.array(model.jnt_axis[joint])
    radius_m = 0.0
    for geom in range(model.ngeom):
        if int(model.geom_bodyid[geom]) == body:
            out = _points(model, geom) - centre
            out = out - np.outer(out @ axis, axis)
            radius_m = max(radius_m, float(np.linalg.norm(out, axis=1).max(initial=0)))
    return Foot(body, centre, radius_m or _LEAST_RADIUS_M, _name(compiled, body), radius_m == 0)


def _points(model: mujoco.MjModel, geom: int) -> FloatArray:
    """Return points on a geom in the frame of its body, (n, 3)."""
    vertices, _ = triangles_of(model, geom)
    points: FloatArray = vertices @ _rotation(model.geom_quat[geom]).T + model.geom_pos[geom]
    return points


def _is_outermost(
    compiled: Compiled,
    data: mujoco.MjData,
    bodies: Sequence[int],
    foot: Foot,
    from_m: FloatArray,
) -> bool:
    """Whether hardly anything of the last link is farther from its joint than a ball."""
    farthest, _ = _farthest(compiled, data, bodies, from_m, None)
    reach = float(np.linalg.norm(foot.in_world(data) - from_m)) + foot.radius_m
    return reach >= 0.85 * float(np.linalg.norm(farthest - from_m))


def _tip(
    compiled: Compiled,
    data: mujoco.MjData,
    bodies: Sequence[int],
    from_m: FloatArray,
    geoms: Sequence[int] | None = None,
) -> Foot:
    """Return a small ball in the point that is farthest from the last joint."""
    # A link that is called a foot has its frame there, even if nothing is drawn of it.
    for body in bodies:
        is_bare = not any(compiled.model.geom_bodyid == body)
        length_m = float(np.linalg.norm(data.xpos[body] - from_m))
        if is_bare and length_m > 0 and _FOOT.search(compiled.body_name(body)) and geoms is None:
            name = compiled.body_name(body)
            return Foot(body, np.zeros(3), _guessed_radius(length_m), name, True)
    farthest, geom = _farthest(compiled, data, bodies, from_m, geoms)
    body = bodies[-1] if geom is None else int(compiled.model.geom_bodyid[geom])
    length_m = float(np.linalg.norm(farthest - from_m))
    radius_m = _guessed_radius(length_m)
    centre = farthest + (from_m - farthest) * (radius_m / max(length_m, 1e-9))
    at_m = data.xmat[body].reshape(3, 3).T @ (centre - data.xpos[body])
    return Foot(body, at_m, radius_m, _name(compiled, body, geom), True)


def _farthest(
    compiled: Compiled,
    data: mujoco.MjData,
    bodies: Sequence[int],
    from_m: FloatArray,
    geoms: Sequence[int] | None,
) -> tuple[FloatArray, int | None]:
    """Return the farthest point of some bodies in the world, and the geom that has it."""
    best: FloatArray = max(
        (np.array(data.xpos[body]) for body in bodies),
        key=lambda place: float(np.linalg.norm(place - from_m)),
    )
    of_geom: int | None = None
    farthest_m = 0.0
    model = compiled.model
    for geom in range(model.ngeom) if geoms is None else geoms:
        body = int(model.geom_bodyid[geom])
        if body not in bodies:
            continue
        points = _points(model, geom) @ data.xmat[body].reshape(3, 3).T + data.xpos[body]
        distances = np.linalg.norm(points - from_m, axis=1)
        if len(distances) and distances.max() > farthest_m:
            farthest_m, of_geom = float(distances.max()), geom
            best = points[int(distances.argmax())]
    return best, of_geom


def _rotation(quaternion: FloatArray) -> FloatArray:
    """Return the matrix of a quaternion (wxyz), (3, 3)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array(quaternion, dtype=np.float64))
    return matrix.reshape(3, 3)
