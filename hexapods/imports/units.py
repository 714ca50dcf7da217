"""Units and axes of a file where they are not metres, radians, and z up."""

from collections.abc import Callable, Mapping
from typing import get_args

import mujoco
import numpy as np

from hexapods.domain.robot_model import MAX_ANGLE_RAD, MAX_SIZE_M
from hexapods.domain.types import FloatArray
from hexapods.imports.choices import Axis, Choices
from hexapods.imports.notes import Notes, quoted

_UP: dict[Axis, FloatArray] = {
    "z": np.eye(3),
    "y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "-y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "x": np.array([[0, 1.0, 0], [0, 0, 1], [1, 0, 0]]),
    "-x": np.array([[0, 1.0, 0], [0, 0, -1], [-1, 0, 0]]),
    "-z": np.diag([1.0, -1, -1]),
}
"""The rotation of the file that turns each of its axes up, (3, 3)."""
_DIRECTIONS: dict[Axis, FloatArray] = {
    axis: (-1.0 if axis.startswith("-") else 1.0) * np.eye(3)["xyz".index(axis[-1])]
    for axis in get_args(Axis)
}
_HINGE, _SLIDE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
_FREE = int(mujoco.mjtJoint.mjJNT_FREE)
_MOST_SHARE, _LEAST_DEG = 0.75, 20.0
"""Limits are in degrees if so many are beyond a turn in radians, the largest more than this."""


def horizontal_axes(up: Axis | None) -> dict[Axis, float]:
    """Return the axes of the file that are horizontal, with their directions [°].

    Directions are anticlockwise from x seen from above; from y where x or -x is up.
    """
    angles: dict[Axis, float] = {}
    for axis in sorted(_DIRECTIONS, key=lambda axis: axis.startswith("-")):
        x, y, z = _UP[up or "z"] @ _DIRECTIONS[axis] + 0.0
        if abs(z) < 0.5:
            angles[axis] = float(np.degrees(np.arctan2(y, x)))
    return angles


def rescale(spec: mujoco.MjSpec, scale: float) -> None:
    """Multiply all lengths of a model by a factor.

    Masses that are given stay; those that the compiler computes by density follow the lengths, and
    inertias the square of them.
    """
    for body in spec.bodies[1:]:
        body.pos = body.pos * scale
        if body.explicitinertial:
            body.ipos = body.ipos * scale
            body.inertia, body.fullinertia = body.inertia * scale**2, body.fullinertia * scale**2
    for frame in spec.frames:
        frame.pos = frame.pos * scale
    for shape in (*spec.geoms, *spec.sites):
        shape.pos, shape.size = shape.pos * scale, shape.size * scale
        shape.fromto = shape.fromto * scale
    for mesh in spec.meshes:
        mesh.scale = mesh.scale * scale
    for joint in spec.joints:
        joint.pos = joint.pos * scale
        if int(joint.type) == _SLIDE:
            joint.range, joint.ref = joint.range * scale, joint.ref * scale


def scale_meshes_in_millimetres(
    spec: mujoco.MjSpec, sides: Mapping[str, float], notes: Notes
) -> None:
    """Scale meshes by 0.001 that are far larger than a robot can be, while its joints are not.

    All meshes with the same scale in the file were written by the same program, so that small ones
    of them are scaled as well.

    Args:
        spec: the model, which is changed.
        sides: longest side of each mesh file, by its name in the model.
        notes: gets the guess.
    """
    reach_m = max((float(np.abs(body.pos).max()) for body in spec.bodies), default=0.0)
    if reach_m > MAX_SIZE_M / 2:
        return
    largest: dict[tuple[float, ...], float] = {}
    for mesh in spec.meshes:
        scale = tuple(np.abs(mesh.scale).tolist())
        side_m = sides.get(mesh.file, 0.0) * max(scale)
        largest[scale] = max(largest.get(scale, 0.0), side_m)
    scales = {scale for scale, side_m in largest.items() if side_m > MAX_SIZE_M}
    scaled = set()
    for mesh in spec.meshes:
        if tuple(np.abs(mesh.scale).tolist()) in scales:
            mesh.scale = 0.001 * mesh.scale
            scaled.add(mesh.name)
    if scaled:
        bodies = [geom.parent.name for geom in spec.geoms if geom.meshname in scaled]
        side_m = max(largest[scale] for scale in scales)
        notes.guess(
            "size",
            f"meshes are up to {side_m:,.4g} m large, far more than from joint to joint "
            f"({reach_m:.2g} m), and were read in millimetres: "
            'scale="0.001 0.001 0.001" on <mesh> says so',
            parts=list(dict.fromkeys(bodies)),
        )


def rescale_keyframes(model: mujoco.MjModel, scale: float) -> None:
    """Multiply the positions of slides and free joints in keyframes by a factor."""
    for kind, start in zip(model.jnt_type.tolist(), model.jnt_qposadr.tolist(), strict=True):
        if kind in (_SLIDE, _FREE):
            model.key_qpos[:, start : start + (1 if kind == _SLIDE else 3)] *= scale


def turn_upright(model: mujoco.MjModel, up: Axis, before: Axis = "z") -> None:
    """Turn all that is in the world so that an axis of the file points up.

    Args:
        model: the model, which is changed.
        up: the axis.
        before: the axis that was turned up before.
    """
    matrix = _UP[up] @ _UP[before].T
    turn, quaternion = np.empty(4), np.empty(4)
    mujoco.mju_mat2Quat(turn, np.ascontiguousarray(matrix).ravel())

    def turn_pose(place: FloatArray, rotation: FloatArray) -> None:
        place[:] = matrix @ place
        mujoco.mju_mulQuat(quaternion, turn, np.array(rotation))
        rotation[:] = quaternion

    for body in np.flatnonzero(model.body_parentid == 0)[1:].tolist():
        turn_pose(model.body_pos[body], model.body_quat[body])
    for joint in np.flatnonzero(model.jnt_type == _FREE).tolist():
        start = int(model.jnt_qposadr[joint])
        turn_pose(model.qpos0[start : start + 3], model.qpos0[start + 3 : start + 7])


def read_limits(
    name_of: Callable[[int], str], model: mujoco.MjModel, choices: Choices, notes: Notes
) -> None:
    """Read the limits of hinges in degrees, if a person says so or they can be nothing else.

    Limits of which the lower is above the upper, which MuJoCo takes for none, are exchanged.

    Args:
        name_of: returns the name of a joint.
        model: the model, whose limits are changed.
        choices: what a person decided.
        notes: gets the guess.
    """
    _exchange_limits(name_of, model, notes)
    hinges = np.flatnonzero((model.jnt_type == _HINGE) & (model.jnt_limited != 0))
    widest = np.abs(model.jnt_range[hinges]).max(axis=1)
    beyond = hinges[widest > MAX_ANGLE_RAD]
    could_be = len(beyond) > 0 and _LEAST_DEG <= widest.max() <= 360
    must_be = could_be and len(beyond) >= _MOST_SHARE * len(hinges)
    is_chosen = choices.angle_unit is not None
    joints = [name_of(joint) for joint in beyond.tolist()]
    example = ""
    if could_be:
        low, high = model.jnt_range[beyond[0]]
        example = f"such as {low:.4g} to {high:.4g} of {quoted(joints[0])}"
    if choices.angle_unit == "deg" or (must_be and not is_chosen):
        model.jnt_range[hinges] = np.radians(model.jnt_range[hinges])
    if must_be and not is_chosen:
        notes.guess(
            "joints",
            f"limits of joints are in degrees, {example}",
            joints,
            Choices(angle_unit="rad"),
        )
    elif could_be and not is_chosen:
        notes.guess(
            "joints",
            f"limits of more than a turn are none, {example} rad: are all limits in degrees?",
            joints,
            Choices(angle_unit="deg"),
        )


def _exchange_limits(name_of: Callable[[int], str], model: mujoco.MjModel, notes: Notes) -> None:
    """Exchange limits of hinges of which the lower is above the upper."""
    reversed_limits = (model.jnt_type == _HINGE) & (model.jnt_range[:, 0] > model.jnt_range[:, 1])
    hinges = np.flatnonzero(reversed_limits).tolist()
    if not hinges:
        return
    names = [name_of(joint) for joint in hinges]
    low, high = model.jnt_range[hinges[0]]
    model.jnt_range[hinges] = model.jnt_range[hinges][:, ::-1]
    model.jnt_limited[hinges] = True
    notes.repair(
        "joints",
        f"lower limits above upper ones were exchanged, such as {low:.4g} and {high:.4g} of "
        f"{quoted(names[0])}",
        names,
    )
