"""Parts of a robot that touch the ground beside its feet: simple shapes in place of meshes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from hexapods.domain.robot_model import GeomKind, ModelGeom
from hexapods.domain.types import FloatArray
from hexapods.imports.notes import Notes
from hexapods.imports.posed_robot import PosedRobot

_MOST_OF_TORSO, _MOST_OF_LINK = 8, 6
_LEAST_M = 0.001
_SAME_END = 1e-4
"""Largest difference between the end of a cylinder and a sphere there, as a share of its radius."""


@dataclass(frozen=True, eq=False)
class GroundShape:
    """A simple shape in the body frame; as `ModelGeom`.

    Attributes:
        rotation: (3, 3).
    """

    kind: GeomKind
    size_m: FloatArray
    at_m: FloatArray
    rotation: FloatArray

    def lowest_m(self, turn: FloatArray, origin: FloatArray, moved: FloatArray) -> float:
        """Return the height of the shape's lowest point after a motion of its link [m].

        Args:
            turn: rotation about `origin`, (3, 3).
            origin: point that the rotation keeps in place before the motion, (3,) [m].
            moved: place of that point after the motion, (3,) [m].
        """
        center = moved + turn @ (self.at_m - origin)
        along = np.abs((turn @ self.rotation)[2])
        x, y, _z = self.size_m
        drop = {
            "sphere": x,
            "capsule": x + y * along[2],
            "cylinder": x * np.hypot(along[0], along[1]) + y * along[2],
            "ellipsoid": float(np.linalg.norm(along * self.size_m)),
            "box": float(along @ self.size_m),
        }[self.kind]
        return float(center[2] - drop)

    def as_geom(self, origin: FloatArray) -> ModelGeom:
        """Return the shape in the frame of a link whose origin is given in the body frame."""
        x, y, z = (float(value) for value in self.size_m)
        at = [float(value) + 0.0 for value in self.at_m - origin]
        return ModelGeom(self.kind, (x, y, z), (at[0], at[1], at[2]), quaternion(self.rotation))


def quaternion(rotation: FloatArray) -> tuple[float, float, float, float]:
    """Return the unit quaternion (wxyz) of a rotation, (3, 3)."""
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(rotation, dtype=np.float64).reshape(9))
    quat /= np.linalg.norm(quat)
    w, x, y, z = (float(value) + 0.0 for value in quat)
    return w, x, y, z


def torso_shapes(posed: PosedRobot, span_m: FloatArray) -> list[GroundShape]:
    """Return the torso's own shapes if they are simple and few, or a box around them.

    Args:
        posed: the robot.
        span_m: half sides of a box for a torso without shapes, (3,).
    """
    geoms = _touching(posed, posed.geoms_of(_of_torso(posed)))
    shapes = [_simple_shape(posed, geom) for geom in geoms if posed.compiled.collides[geom]]
    simple = [shape for shape in shapes if shape is not None]
    merged = _with_capsules(simple)
    if simple and len(simple) == len(geoms) and len(merged) <= _MOST_OF_TORSO:
        return merged
    points = [posed.surface(geom)[0] for geom in geoms]
    together = np.concatenate([*points, np.empty((0, 3))])
    if len(together) == 0:
        return [GroundShape("box", span_m, np.zeros(3), np.eye(3))]
    low, high = together.min(axis=0), together.max(axis=0)
    half = np.maximum((high - low) / 2, _LEAST_M)
    return [GroundShape("box", half, (low + high) / 2, np.eye(3))]


def link_shapes(
    posed: PosedRobot, joint: int, foot: tuple[FloatArray, float] | None
) -> list[GroundShape]:
    """Return the shapes of a link, without the ball of its foot.

    Args:
        posed: the robot.
        joint: joint that moves the link.
        foot: centre and radius of the foot, if the link has one.
    """
    shapes = []
    for geom in posed.geoms_of(posed.bodies_of(joint)):
        if not posed.compiled.collides[geom]:
            continue
        shape = _simple_shape(posed, geom) or _around(posed, geom)
        if shape is not None:
            shapes.append(shape)
    shapes = [
        shape for shape in _with_capsules(shapes) if foot is None or not _is_foot(shape, *foot)
    ]
    shapes.sort(key=lambda shape: -float(shape.size_m.max()))
    return shapes[:_MOST_OF_LINK]


def drop_touching(
    shapes: Sequence[GroundShape], lowest_m: Sequence[float], ground_m: float, notes: Notes
) -> list[GroundShape]:
    """Drop the shapes that would touch the ground at home, where only feet have contact."""
    clear = [shape for shape, low in zip(shapes, lowest_m, strict=True) if low > ground_m]
    if len(clear) < len(shapes):
        notes.repair(
            "shapes", "shapes of legs that would touch the ground before the feet were left out"
        )
    return clear


def _of_torso(posed: PosedRobot) -> list[int]:
    """Return the torso's bodies without those on locked joints, such as an arm."""
    model = posed.compiled.model
    locked = {int(model.jnt_bodyid[joint]) for joint in posed.skeleton.locked}
    away: set[int] = set()
    for body in posed.bodies_of(None):
        if body in locked or int(model.body_parentid[body]) in away:
            away.add(body)
    return [body for body in posed.bodies_of(None) if body not in away]


def _touching(posed: PosedRobot, geoms: Sequence[int]) -> list[int]:
    """Return the geoms that collide; all if none does."""
    colliding = [geom for geom in geoms if posed.compiled.collides[geom]]
    return colliding or list(geoms)


def _simple_shape(posed: PosedRobot, geom: int) -> GroundShape | None:
    """Return the shape of a primitive geom; None for a mesh."""
    kind = posed.kind(geom)
    if kind == "mesh":
        return None
    size = np.maximum(posed.compiled.model.geom_size[geom], 0)
    used = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}[kind]
    plain = np.array([*np.maximum(size[:used], _LEAST_M), 0, 0])[:3]
    return GroundShape(kind, plain, posed.geom_center(geom), posed.geom_rotation(geom))  # type: ignore[arg-type]  # of the primitives


def _around(posed: PosedRobot, geom: int) -> GroundShape | None:
    """Return a capsule along a mesh."""
    box = np.array(posed.compiled.model.geom_aabb[geom])
    center, half = box[:3], box[3:]
    if not np.isfinite(box).all() or half.max() <= 0:
        return None
    long = int(half.argmax())
    radius = max(float(np.delete(half, long).mean()), _LEAST_M)
    rotation = posed.geom_rotation(geom)
    # The axis of a capsule is z; a cyclic exchange of the axes keeps them right-handed.
    turned = rotation[:, [(long + 1) % 3, (long + 2) % 3, long]]
    size = np.array([radius, max(float(half[long]) - radius, _LEAST_M), 0])
    return GroundShape("capsule", size, posed.geom_center(geom) + rotation @ center, turned)


def _with_capsules(shapes: Sequence[GroundShape]) -> list[GroundShape]:
    """Return shapes with a capsule in place of each cylinder that has a sphere at both ends.

    URDF has no capsules, so files have these instead.
    """
    kept = list(shapes)
    for cylinder in [shape for shape in shapes if shape.kind == "cylinder"]:
        along = cylinder.rotation[:, 2] * cylinder.size_m[1]
        ends = [_sphere_at(kept, cylinder, cylinder.at_m + sign * along) for sign in (1, -1)]
        if None not in ends:
            place = kept.index(cylinder)
            kept[place] = replace(cylinder, kind="capsule")
            kept = [shape for shape in kept if shape not in ends]
    return kept


def _sphere_at(
    shapes: Sequence[GroundShape], cylinder: GroundShape, end_m: FloatArray
) -> GroundShape | None:
    """Return a sphere as wide as a cylinder at its end; None if there is none."""
    radius_m = float(cylinder.size_m[0])
    for shape in shapes:
        off_m = max(abs(float(shape.size_m[0]) - radius_m), float(np.abs(shape.at_m - end_m).max()))
        if shape.kind == "sphere" and off_m <= _SAME_END * radius_m:
            return shape
    return None


def _is_foot(shape: GroundShape, center: FloatArray, radius_m: float) -> bool:
    near = float(np.linalg.norm(shape.at_m - center)) < 0.5 * radius_m
    return near and shape.kind == "sphere"
