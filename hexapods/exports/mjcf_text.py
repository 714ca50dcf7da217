"""Write a model as MJCF in one file, for MuJoCo 3.2 and later and other readers of MJCF.

Each number stands at its element, as MuJoCo has compiled it: masses and inertias too, so that other
versions do not compute them in another way. MuJoCo's own writer is not used, as it rounds to six
digits, and writes elements and attributes that only its newest version reads.
"""

from collections.abc import Mapping, Sequence
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
from numpy.typing import NDArray

from hexapods.domain.types import FloatArray
from hexapods.exports.xml_text import add, document, name_of, numbers

_GEOMS = {
    mujoco.mjtGeom.mjGEOM_PLANE: ("plane", 3),
    mujoco.mjtGeom.mjGEOM_SPHERE: ("sphere", 1),
    mujoco.mjtGeom.mjGEOM_CAPSULE: ("capsule", 2),
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: ("ellipsoid", 3),
    mujoco.mjtGeom.mjGEOM_CYLINDER: ("cylinder", 2),
    mujoco.mjtGeom.mjGEOM_BOX: ("box", 3),
    mujoco.mjtGeom.mjGEOM_MESH: ("mesh", 0),
}
"""Types of geoms, with how many numbers their sizes have."""
_GEOM_DEFAULTS: Mapping[str, tuple[float, ...]] = {
    "contype": (1,),
    "conaffinity": (1,),
    "condim": (3,),
    "group": (0,),
    "priority": (0,),
    "friction": (1, 0.005, 0.0001),
    "solref": (0.02, 1),
    "solimp": (0.9, 0.95, 0.001, 0.5, 2),
    "margin": (0,),
    "gap": (0,),
}
"""Attributes of geoms, with MuJoCo's defaults."""
_LEAST_DEPTH_M = 1e-4
_AT_ORIGIN, _UNTURNED = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)


def mjcf_text(
    spec: mujoco.MjSpec,
    name: str,
    keyframes: Mapping[str, tuple[FloatArray, FloatArray]],
    custom: Mapping[str, str | float],
) -> str:
    """Return a specification of hinges, position servos and simple geoms as MJCF.

    Args:
        spec: the specification.
        name: name of the model.
        keyframes: `qpos` and `ctrl` of each keyframe, by its name.
        custom: texts and numbers in `<custom>`, by name.
    """
    return document(_MjcfWriter(spec, name).root(keyframes, custom))


class _MjcfWriter:
    def __init__(self, spec: mujoco.MjSpec, name: str) -> None:
        self._spec, self._model = spec, spec.compile()
        self._root = Element("mujoco", {"model": name_of(name)})

    def root(
        self,
        keyframes: Mapping[str, tuple[FloatArray, FloatArray]],
        custom: Mapping[str, str | float],
    ) -> Element:
        add(self._root, "compiler", {"angle": "radian"})
        # Dense: with sparse matrices MuJoCo 4.0.0 factors large models wrongly.
        option = {"integrator": "implicitfast", "jacobian": "dense"}
        add(self._root, "option", {"timestep": numbers([self._model.opt.timestep]), **option})
        if custom:
            section = add(self._root, "custom", {})
            for name, value in custom.items():
                if isinstance(value, str):
                    add(section, "text", {"name": name, "data": value})
                else:
                    add(section, "numeric", {"name": name, "data": numbers([value])})
        self._add_meshes()
        bodies = [add(self._root, "worldbody", {})]
        self._add_geoms(bodies[0], 0)
        for body in range(1, self._model.nbody):
            bodies.append(self._body(bodies[int(self._model.body_parentid[body])], body))
        self._add_actuators()
        section = add(self._root, "keyframe", {})
        for key, (qpos, ctrl) in keyframes.items():
            add(section, "key", {"name": key, "qpos": numbers(qpos), "ctrl": numbers(ctrl)})
        return self._root

    def _add_meshes(self) -> None:
        if not self._spec.meshes:
            return
        assets = add(self._root, "asset", {})
        for mesh in self._spec.meshes:
            vertices, faces = with_depth(
                np.array(mesh.uservert, np.float32).reshape(-1, 3),
                np.array(mesh.userface, np.int32).reshape(-1, 3),
            )
            text = {
                "name": mesh.name,
                "vertex": " ".join(map(str, vertices.ravel())),
                "face": " ".join(map(str, faces.ravel().tolist())),
            }
            add(assets, "mesh", text)

    def _body(self, parent: Element, body: int) -> Element:
        model = self._model
        element = add(
            parent,
            "body",
            {
                "name": model.body(body).name,
                **_placed(model.body_pos[body], model.body_quat[body]),
            },
        )
        if model.body_mass[body] > 0:
            add(
                element,
                "inertial",
                {
                    # MuJoCo demands it.
                    "pos": numbers(model.body_ipos[body]),
                    **_placed(_AT_ORIGIN, model.body_iquat[body]),
                    "mass": numbers([model.body_mass[body]]),
                    "diaginertia": numbers(model.body_inertia[body]),
                },
            )
        first = int(model.body_jntadr[body])
        for joint in range(first, first + int(model.body_jntnum[body])):
            self._add_joint(element, joint)
        self._add_geoms(element, body)
        return element

    def _add_joint(self, parent: Element, joint: int) -> None:
        model, name = self._model, self._model.joint(joint).name
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            add(parent, "freejoint", {"name": name})
            return
        dof = int(model.jnt_dofadr[joint])
        friction = float(model.dof_frictionloss[dof])
        add(
            parent,
            "joint",
            {
                "name": name,
                **_placed(model.jnt_pos[joint], _UNTURNED),
                "axis": numbers(model.jnt_axis[joint]),
                "limited": "true",
                "range": numbers(model.jnt_range[joint]),
                "armature": numbers([model.dof_armature[dof]]),
                "damping": numbers(np.ravel(model.dof_damping[dof])[:1]),
                **({"frictionloss": numbers([friction])} if friction else {}),
            },
        )

    def _add_geoms(self, parent: Element, body: int) -> None:
        model = self._model
        first = int(model.body_geomadr[body])
        for geom in range(first, first + int(model.body_geomnum[body])):
            name = model.geom(geom).name
            kind, sizes = _GEOMS[mujoco.mjtGeom(int(model.geom_type[geom]))]
            attributes = {"name": name, "type": kind}
            if kind == "mesh":
                # The compiled one is in the frame of the mesh's inertia.
                of_spec = self._spec.geom(name)
                attributes |= {"mesh": of_spec.meshname, **_placed(of_spec.pos, of_spec.quat)}
            else:
                attributes["size"] = numbers(model.geom_size[geom][:sizes])
                attributes |= _placed(model.geom_pos[geom], model.geom_quat[geom])
            for attribute, default in _GEOM_DEFAULTS.items():
                values = np.ravel(getattr(model, f"geom_{attribute}")[geom])
                if tuple(values) != default:
                    attributes[attribute] = numbers(values)
            add(parent, "geom", attributes)

    def _add_actuators(self) -> None:
        model, section = self._model, add(self._root, "actuator", {})
        for servo in range(model.nu):
            add(
                section,
                "position",
                {
                    "name": model.actuator(servo).name,
                    "joint": model.joint(int(model.actuator_trnid[servo][0])).name,
                    "kp": numbers([model.actuator_gainprm[servo][0]]),
                    "kv": numbers([-model.actuator_biasprm[servo][2]]),
                    "forcelimited": "true",
                    "forcerange": numbers(model.actuator_forcerange[servo]),
                },
            )


def with_depth(
    vertices: NDArray[np.float32], faces: NDArray[np.int32]
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Return a mesh that has a volume, which MuJoCo demands even where no mass depends on it.

    Its attribute by which a mesh may be flat is unknown to versions before 3.3. A flat mesh gets a
    triangle that rises from its plane, too small to be seen.

    Args:
        vertices: (n, 3) [m].
        faces: (m, 3).
    """
    centred = vertices.astype(float) - vertices.mean(axis=0)
    _, _, axes = np.linalg.svd(centred, full_matrices=False)
    normal = axes[2]
    if np.ptp(centred @ normal) > _LEAST_DEPTH_M:
        return vertices, faces
    first, second, _ = faces[0].tolist()
    raised = (vertices[first] + vertices[second]) / 2 + _LEAST_DEPTH_M * normal
    return (
        np.concatenate([vertices, raised[None].astype(np.float32)]),
        np.concatenate([faces, np.array([[first, second, len(vertices)]], np.int32)]),
    )


def _placed(
    pos: Sequence[float] | FloatArray, quat: Sequence[float] | FloatArray
) -> dict[str, str]:
    """Return attributes of a place; what is MuJoCo's default is left out."""
    attributes = {}
    if tuple(pos) != _AT_ORIGIN:
        attributes["pos"] = numbers(pos)
    if tuple(quat) != _UNTURNED:
        attributes["quat"] = numbers(quat)
    return attributes
