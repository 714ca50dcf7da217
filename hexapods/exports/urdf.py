"""Write a robot as URDF, alone or in a zip with its meshes.

Links and joints have the names of the MuJoCo model's bodies, such as `leg1_femur`; the frame of
each link is its joint's, and all joints at 0 are as in MJCF and in logs. URDF has no capsules and
no ellipsoids: a capsule is a cylinder and two spheres, an ellipsoid a cylinder of the same volume.
What URDF has no place for, such as the stance and the gains of servos, is in the element
`<hexapods>`, which other readers skip.
"""

import io
import math
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
from numpy.typing import NDArray

from hexapods.domain.kinematics import legs_of
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.robot import Robot
from hexapods.domain.types import FloatArray
from hexapods.exports.exported_settings import exported_settings
from hexapods.exports.robot_model import home_angles_rad
from hexapods.exports.xml_text import add, document, name_of, numbers
from hexapods.physics.mjcf import VISIBLE_GROUP, compile_visual_model

_FASTEST_RAD_S = 100.0
"""Largest speed of a joint that is written."""
_HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)
_GEOM = mujoco.mjtGeom
_ELLIPSOID_SHARE = 2 / 3
"""Length of a cylinder of the volume of an ellipsoid with the same radius, as a share of that."""
_NOISE = 1e-15
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)
"""Equal robots are equal files."""


class _Shape(NamedTuple):
    """A shape of URDF: its tag and attributes, its centre and rotation in its geom's frame."""

    tag: str
    attributes: Mapping[str, str]
    at_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn: FloatArray = np.eye(3)


def robot_urdf(robot: Robot, *, prefix: str = "", meshes: Mapping[str, str] | None = None) -> str:
    """Return a robot as URDF.

    Args:
        robot: the robot.
        prefix: what the names of links begin with; those of joints do not.
        meshes: path of the file of each mesh, by the name of its geom; links whose meshes are left
            out are drawn as the shapes that touch the ground.
    """
    return document(_UrdfWriter(robot, prefix, meshes or {}).root())


def robot_urdf_zip(robot: Robot) -> bytes:
    """Return a zip of a robot's URDF and its meshes, as binary STL in the folder `meshes`."""
    files = _mesh_files(robot)
    paths = {geom: f"meshes/{geom.removesuffix('_mesh')}.stl" for geom in files}
    contents = {f"{name_of(robot.name)}.urdf": robot_urdf(robot, meshes=paths).encode()}
    contents |= {paths[geom]: content for geom, content in files.items()}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for path, content in contents.items():
            member = zipfile.ZipInfo(path, _ZIP_TIME)
            member.compress_type = zipfile.ZIP_DEFLATED
            member.external_attr = 0o644 << 16
            archive.writestr(member, content)
    return buffer.getvalue()


def _mesh_files(robot: Robot) -> dict[str, bytes]:
    """Return the drawn meshes of a robot from a file as binary STL, by the names of their geoms."""
    if not isinstance(robot, ModelRobot):
        return {}
    model = compile_visual_model(robot)
    files = {}
    # Bodies but the world are the links, in their order.
    for body, link in enumerate(robot.model.links, start=1):
        name = f"{model.body(body).name}_mesh"
        if link.mesh is not None and mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name) >= 0:
            vertices, faces = link.mesh.arrays()
            anchor = (0.0, 0.0, 0.0) if link.joint is None else link.joint.anchor_m
            files[name] = _stl((vertices - np.array(anchor, np.float32))[faces])
    return files


def _stl(triangles: NDArray[np.float32]) -> bytes:
    """Return triangles, (n, 3, 3), as binary STL."""
    facets = np.zeros(
        len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("", "<u2")]
    )
    first, second, third = np.moveaxis(triangles, 1, 0)
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    facets["corners"] = triangles
    return bytes(80) + len(triangles).to_bytes(4, "little") + facets.tobytes()


class _UrdfWriter:
    def __init__(self, robot: Robot, prefix: str, meshes: Mapping[str, str]) -> None:
        self._robot, self._prefix, self._meshes = robot, prefix, meshes
        self._model = compile_visual_model(robot)
        self._root = Element("robot", {"name": name_of(robot.name)})
        self._feet = {
            geom: int(self._model.geom_bodyid[geom])
            for leg in range(1, len(robot.legs) + 1)
            for geom in [self._model.geom(f"leg{leg}_foot").id]
            if self._model.body(self._model.geom_bodyid[geom]).name != f"leg{leg}_foot"
        }
        """Feet without a body of their own, with the body that has each."""
        self._anchors = np.zeros((self._model.nbody, 3))
        """Of each body the point that is the origin of its link."""
        for body in range(1, self._model.nbody):
            joint = self._hinge(body)
            if joint is not None:
                self._anchors[body] = self._model.jnt_pos[joint]

    def root(self) -> Element:
        # MuJoCo drops fixed links, what is only drawn, and folders of meshes by default.
        kept = {"fusestatic": "false", "discardvisual": "false", "strippath": "false"}
        add(add(self._root, "mujoco", {}), "compiler", kept)
        for body in range(1, self._model.nbody):
            self._add_link(body)
        for geom in self._feet:
            name = f"{self._prefix}{self._model.geom(geom).name}"
            link = add(self._root, "link", {"name": name})
            # Readers such as PyBullet give a link that says nothing of its mass 1 kg.
            _add_inertial(link, np.zeros(3), 0.0, np.zeros((3, 3)))
            self._add_shapes(link, [geom], is_foot=True)
        for body in range(2, self._model.nbody):
            self._add_joint(body)
        for geom, body in self._feet.items():
            name, place = self._model.geom(geom).name, self._model.geom_pos[geom]
            joint = add(self._root, "joint", {"name": name, "type": "fixed"})
            add(joint, "origin", _origin(place - self._anchors[body], np.eye(3)))
            add(joint, "parent", {"link": self._name(body)})
            add(joint, "child", {"link": f"{self._prefix}{name}"})
        self._add_settings()
        return self._root

    def _name(self, body: int) -> str:
        return f"{self._prefix}{self._model.body(body).name}"

    def _hinge(self, body: int) -> int | None:
        """Return the hinge that moves a body; None for the torso, and for what is fixed."""
        model, first = self._model, int(self._model.body_jntadr[body])
        moves = model.body_jntnum[body] and int(model.jnt_type[first]) == _HINGE
        return first if moves else None

    def _add_link(self, body: int) -> None:
        model = self._model
        link = add(self._root, "link", {"name": self._name(body)})
        turn = _matrix(model.body_iquat[body])
        inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
        center = model.body_ipos[body] - self._anchors[body]
        _add_inertial(link, center, float(model.body_mass[body]), inertia)
        first = int(model.body_geomadr[body])
        geoms = range(first, first + int(model.body_geomnum[body]))
        self._add_shapes(link, [geom for geom in geoms if geom not in self._feet])

    def _add_shapes(self, link: Element, geoms: Sequence[int], *, is_foot: bool = False) -> None:
        """Add what is drawn and what touches the ground; a foot is in its own frame."""
        model = self._model
        touching = [
            geom for geom in geoms if model.geom_contype[geom] or model.geom_conaffinity[geom]
        ]
        seen = [geom for geom in geoms if model.geom_group[geom] == VISIBLE_GROUP]
        if any(self._is_mesh(geom) and not self._mesh(geom) for geom in seen):
            seen = list(dict.fromkeys([*seen, *touching]))
        for tag, geoms_of_tag in (("visual", seen), ("collision", touching)):
            for geom in geoms_of_tag:
                for number, shape in enumerate(self._shapes(geom)):
                    place, turn = self._placed(geom, shape)
                    # MuJoCo takes them as names of geoms, each of which has its own.
                    name = f"{model.geom(geom).name}_{tag}{number or ''}"
                    element = add(link, tag, {"name": name})
                    add(element, "origin", _origin(np.zeros(3) if is_foot else place, turn))
                    add(add(element, "geometry", {}), shape.tag, shape.attributes)

    def _placed(self, geom: int, shape: _Shape) -> tuple[FloatArray, FloatArray]:
        """Return the place of a shape in the frame of its link, and its rotation."""
        model, anchor = self._model, self._anchors[self._model.geom_bodyid[geom]]
        if self._is_mesh(geom):  # its file is in that frame
            return np.zeros(3), np.eye(3)
        turn = _matrix(model.geom_quat[geom])
        return model.geom_pos[geom] + turn @ shape.at_m - anchor, turn @ shape.turn

    def _is_mesh(self, geom: int) -> bool:
        return int(self._model.geom_type[geom]) == int(_GEOM.mjGEOM_MESH)

    def _mesh(self, geom: int) -> str | None:
        return self._meshes.get(self._model.geom(geom).name)

    def _shapes(self, geom: int) -> Iterator[_Shape]:
        """Yield the shapes that stand for a geom; none for a mesh that is left out."""
        kind, size = _GEOM(int(self._model.geom_type[geom])), self._model.geom_size[geom]
        if kind == _GEOM.mjGEOM_MESH:
            path = self._mesh(geom)
            if path is not None:
                yield _Shape("mesh", {"filename": path})
        elif kind == _GEOM.mjGEOM_SPHERE:
            yield _Shape("sphere", {"radius": numbers(size[:1])})
        elif kind == _GEOM.mjGEOM_BOX:
            yield _Shape("box", {"size": numbers(2 * size)})
        elif kind == _GEOM.mjGEOM_ELLIPSOID:
            yield _cylinder_like_ellipsoid(size)
        else:
            yield _Shape(
                "cylinder", {"radius": numbers(size[:1]), "length": numbers([2 * size[1]])}
            )
            if kind == _GEOM.mjGEOM_CAPSULE:
                for end in (-float(size[1]), float(size[1])):
                    yield _Shape("sphere", {"radius": numbers(size[:1])}, (0.0, 0.0, end))

    def _add_joint(self, body: int) -> None:
        model, hinge = self._model, self._hinge(body)
        parent = int(model.body_parentid[body])
        turn = _matrix(model.body_quat[body])
        place = model.body_pos[body] + turn @ self._anchors[body] - self._anchors[parent]
        kind = "fixed" if hinge is None else "revolute"
        joint = add(self._root, "joint", {"name": model.body(body).name, "type": kind})
        add(joint, "origin", _origin(place, turn))
        add(joint, "parent", {"link": self._name(parent)})
        add(joint, "child", {"link": self._name(body)})
        if hinge is None:
            return
        dof, servo = int(model.jnt_dofadr[hinge]), self._servo(hinge)
        torque_nm = float(model.actuator_forcerange[servo][1])
        damping = float(np.ravel(model.dof_damping[dof])[0])
        # Where damping takes the whole torque.
        fastest = min(torque_nm / damping, _FASTEST_RAD_S) if damping > 0 else _FASTEST_RAD_S
        lower, upper = model.jnt_range[hinge]
        limit = {"lower": lower, "upper": upper, "effort": torque_nm, "velocity": fastest}
        add(joint, "axis", {"xyz": numbers(model.jnt_axis[hinge])})
        add(joint, "limit", {name: numbers([value]) for name, value in limit.items()})
        friction = float(model.dof_frictionloss[dof])
        add(joint, "dynamics", {"damping": numbers([damping]), "friction": numbers([friction])})

    def _servo(self, hinge: int) -> int:
        return int(np.flatnonzero(self._model.actuator_trnid[:, 0] == hinge)[0])

    def _add_settings(self) -> None:
        model = self._model
        settings = {
            name: value if isinstance(value, str) else numbers([value])
            for name, value in exported_settings(self._robot).items()
        }
        feet = [f"{self._prefix}{name}" for name in settings["feet"].split()]
        element = add(self._root, "hexapods", {**settings, "feet": " ".join(feet)})
        home = home_angles_rad(self._robot).tolist()
        for joint, home_rad in zip(legs_of(self._robot).joints, home, strict=True):
            hinge = model.joint(joint.label).id
            servo = self._servo(hinge)
            values = {
                "home": home_rad,
                "kp": model.actuator_gainprm[servo][0],
                "kv": -model.actuator_biasprm[servo][2],
                "armature": model.dof_armature[model.jnt_dofadr[hinge]],
            }
            texts = {name: numbers([value]) for name, value in values.items()}
            add(element, "servo", {"joint": joint.label, **texts})


def _add_inertial(link: Element, center: FloatArray, mass_kg: float, inertia: FloatArray) -> None:
    element = add(link, "inertial", {})
    add(element, "origin", _origin(center, np.eye(3)))
    add(element, "mass", {"value": numbers([mass_kg])})
    moments = _without_noise(inertia)
    pairs = [(row, column) for row in range(3) for column in range(row, 3)]
    values = {f"i{'xyz'[row]}{'xyz'[column]}": moments[row, column] for row, column in pairs}
    add(element, "inertia", {name: numbers([value]) for name, value in values.items()})


def _cylinder_like_ellipsoid(half_m: FloatArray) -> _Shape:
    """Return a cylinder of an ellipsoid's volume, along the axis that differs most."""
    middle = float(np.median(half_m))
    axis = int(np.abs(half_m - middle).argmax())
    radius = math.sqrt(float(np.delete(half_m, axis).prod()))
    length = {"length": numbers([2 * _ELLIPSOID_SHARE * half_m[axis]])}
    # A cyclic exchange of the axes keeps them right-handed.
    turn = np.eye(3)[:, [(axis + 1) % 3, (axis + 2) % 3, axis]]
    return _Shape("cylinder", {"radius": numbers([radius]), **length}, turn=turn)


def _origin(place: FloatArray, turn: FloatArray) -> dict[str, str]:
    """Return the attributes of a place: fixed-axis roll, pitch and yaw."""
    flat = math.hypot(turn[0, 0], turn[1, 0])
    pitch = math.atan2(-turn[2, 0], flat)
    if flat > 1e-9:
        roll, yaw = math.atan2(turn[2, 1], turn[2, 2]), math.atan2(turn[1, 0], turn[0, 0])
    else:  # roll and yaw turn about one axis
        roll, yaw = math.atan2(-turn[1, 2], turn[1, 1]), 0.0
    return {"xyz": numbers(_without_noise(place)), "rpy": numbers([roll, pitch, yaw])}


def _without_noise(values: FloatArray) -> FloatArray:
    """Return numbers with 0 for what is but a rounding error beside the largest."""
    return np.where(np.abs(values) < _NOISE * np.abs(values).max(), 0.0, values)


def _matrix(wxyz: FloatArray) -> FloatArray:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array(wxyz))
    return matrix.reshape(3, 3)
