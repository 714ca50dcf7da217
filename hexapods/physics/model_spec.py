"""The MuJoCo model of a robot from a file, built from its numbers."""

import hashlib
from dataclasses import replace
from itertools import count

import mujoco
import numpy as np

from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.robot_model import ModelGeom, ModelJoint, ModelLink, ModelMesh, Vector
from hexapods.physics.conditions import set_servo

_UNSEEN_GROUP = 3
"""The group of geoms that are not drawn; see models/leg.xml."""
_SEEN_GROUP = 1
_ROLLING = (0.005, 0.0001)
"""Torsional and rolling friction."""
_SOLREF, _SOLIMP = (0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0)
"""MuJoCo's defaults, set for every geom: those of the robot's file do not apply."""


def model_spec(robot: ModelRobot, spec: mujoco.MjSpec) -> mujoco.MjSpec:
    """Return the specification of a robot from a file.

    Links that a joint moves have its label, those without one a number, and names of geoms begin
    with that of their link. Links are as heavy as the file says, whatever their geoms are.

    Args:
        robot: the robot.
        spec: specification of models/torso.xml, whose ground and options remain.
    """
    spec.option.timestep = robot.dt_s
    bodies = [spec.body("torso")]
    torso = bodies[0]
    links = [
        link if link.mesh is None or is_drawable(link.mesh) else replace(link, mesh=None)
        for link in robot.model.links
    ]
    torso.pos = [0, 0, robot.body_height_m + robot.foot_radius_m]
    for geom in list(torso.geoms):
        spec.delete(geom)
    numbers = count(1)
    for link in links:
        if link.parent < 0:
            name = "torso"
        else:
            label = f"part{next(numbers)}" if link.joint is None else link.joint.name
            name = f"leg{link.leg}_{label}" if link.leg else f"torso_{label}"
            bodies.append(bodies[link.parent].add_body(name=name, pos=link.at_m, quat=link.wxyz))
        _add_link(spec, robot, bodies[-1], name, link)
        if link.mesh is not None:
            _add_mesh(spec, bodies[-1], name, link.mesh)
    for leg, foot in enumerate(robot.model.feet, start=1):
        _add_geom(
            bodies[foot.link],
            f"leg{leg}_foot",
            ModelGeom("sphere", (foot.radius_m, 0.0, 0.0), foot.at_m, (1.0, 0.0, 0.0, 0.0)),
            robot.friction,
            is_seen=links[foot.link].mesh is None,
        )
    return spec


def _add_link(
    spec: mujoco.MjSpec, robot: ModelRobot, body: mujoco.MjsBody, name: str, link: ModelLink
) -> None:
    body.explicitinertial = True
    body.mass, body.ipos = link.mass_kg, link.center_m
    body.inertia, body.iquat = _principal(link.inertia)
    if link.joint is not None:
        _add_joint(body, name, link.joint)
        servo = spec.add_actuator(
            name=name,
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            forcelimited=True,
        )
        set_servo(servo, robot.servo_of(link.leg, link.joint.name))
    for number, geom in enumerate(link.geoms):
        _add_geom(
            body,
            name if number == 0 else f"{name}_{number}",
            geom,
            robot.friction,
            is_seen=link.mesh is None,
        )


def _add_mesh(spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, mesh: ModelMesh) -> None:
    """Add the drawn mesh of a link; equal meshes are one asset."""
    content = hashlib.sha256(f"{mesh.vertices} {mesh.faces}".encode()).hexdigest()[:16]
    if spec.mesh(content) is None:
        vertices, faces = mesh.arrays()
        asset = spec.add_mesh(name=content, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
        asset.uservert, asset.userface = vertices.ravel(), faces.astype(np.int32).ravel()
    body.add_geom(
        name=f"{name}_mesh",
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=content,
        mass=0,
        group=_SEEN_GROUP,
        contype=0,
        conaffinity=0,
    )


def is_drawable(mesh: ModelMesh) -> bool:
    """Return whether a mesh has a surface: MuJoCo refuses others."""
    vertices, faces = mesh.arrays()
    return len(vertices) > 3 and len(faces) > 0 and bool((np.ptp(vertices, axis=0) > 1e-6).all())


def _principal(inertia: tuple[float, ...]) -> tuple[list[float], list[float]]:
    """Return the principal moments of inertia and their rotation, wxyz, that a body may have."""
    xx, yy, zz, xy, xz, yz = inertia
    moments, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    least, middle, largest = np.maximum(moments, 1e-9).tolist()
    # MuJoCo refuses a body that no mass distribution could have.
    largest = min(largest, least + middle)
    wxyz = np.empty(4)
    mujoco.mju_mat2Quat(wxyz, np.ascontiguousarray(axes).ravel())
    return [least, middle, largest], wxyz.tolist()


def _add_joint(body: mujoco.MjsBody, name: str, joint: ModelJoint) -> None:
    added = body.add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=joint.axis,
        pos=joint.anchor_m,
        range=joint.limits_rad,
        limited=True,
        armature=joint.armature,
        frictionloss=joint.friction_nm,
    )
    added.damping = np.array([joint.damping, 0, 0])[: np.size(added.damping)]


def _add_geom(
    body: mujoco.MjsBody, name: str, geom: ModelGeom, friction: float, *, is_seen: bool
) -> None:
    body.add_geom(
        name=name,
        type=getattr(mujoco.mjtGeom, f"mjGEOM_{geom.kind.upper()}"),
        size=_size(geom),
        pos=geom.at_m,
        quat=geom.wxyz,
        mass=0,
        group=_SEEN_GROUP if is_seen else _UNSEEN_GROUP,
        priority=1,
        contype=1,
        conaffinity=0,
        condim=3,
        margin=0,
        gap=0,
        friction=[friction, *_ROLLING],
        solref=_SOLREF,
        solimp=_SOLIMP,
    )


def _size(geom: ModelGeom) -> Vector:
    """Return the size as MuJoCo takes it: numbers that the kind needs are not 0."""
    needed = {"sphere": 1, "capsule": 2, "cylinder": 2}.get(geom.kind, 3)
    first, second, third = (
        max(half_m, 1e-4) if number < needed else 0.0 for number, half_m in enumerate(geom.size_m)
    )
    return first, second, third
