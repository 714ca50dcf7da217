"""Points on the surfaces of a compiled model's geoms."""

import mujoco
import numpy as np

from hexapods.domain.types import FloatArray, IntArray

Triangles = tuple[FloatArray, IntArray]
"""Vertices, (n, 3), and faces, (m, 3)."""
_AROUND, _ALONG = 16, 8
"""Edges of a round shape around its axis, and from pole to pole."""
_PRIMITIVES = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
}


def kind_of(model: mujoco.MjModel, geom: int) -> str:
    """Return the kind of a geom: `mesh`, or that of a primitive."""
    return _PRIMITIVES.get(int(model.geom_type[geom]), "mesh")


def triangles_of(model: mujoco.MjModel, geom: int) -> Triangles:
    """Return the surface of a geom in its frame; empty for a mesh that is no mesh."""
    kind = kind_of(model, geom)
    if kind != "mesh":
        return _primitive(kind, np.array(model.geom_size[geom]))
    mesh = int(model.geom_dataid[geom])
    if mesh < 0:
        return np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    start, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    first, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    return (
        np.array(model.mesh_vert[start : start + count], dtype=np.float64),
        np.array(model.mesh_face[first : first + faces], dtype=np.int64),
    )


def _primitive(kind: str, size: FloatArray) -> Triangles:
    if kind == "box":
        return _box(size)
    if kind == "cylinder":
        profile = [(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)]
        return _turned(np.array(profile) * [size[0], size[1]])
    angles = np.linspace(-np.pi / 2, np.pi / 2, 2 * _ALONG // 2 + 1)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if kind == "capsule":
        half = len(angles) // 2
        rounded = np.concatenate([circle[: half + 1], circle[half:]]) * size[0]
        rounded[: half + 1, 1] -= size[1]
        rounded[half + 1 :, 1] += size[1]
        return _turned(rounded)
    vertices, faces = _turned(circle)
    return vertices * (size if kind == "ellipsoid" else size[0]), faces


def _turned(profile: FloatArray) -> Triangles:
    """Turn a line of (radius, z) around the z axis."""
    angles = np.arange(_AROUND) * (2 * np.pi / _AROUND)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = [
        np.concatenate([radius * around, np.full((_AROUND, 1), z)], axis=1) for radius, z in profile
    ]
    faces = []
    for ring in range(len(rings) - 1):
        for edge in range(_AROUND):
            a, b = ring * _AROUND + edge, ring * _AROUND + (edge + 1) % _AROUND
            faces += [(a, b, b + _AROUND), (a, b + _AROUND, a + _AROUND)]
    return np.concatenate(rings), np.array(faces)


def _box(size: FloatArray) -> Triangles:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
    squares = [
        (0, 1, 3, 2),
        (4, 6, 7, 5),
        (0, 4, 5, 1),
        (2, 3, 7, 6),
        (0, 2, 6, 4),
        (1, 5, 7, 3),
    ]
    faces = [triangle for a, b, c, d in squares for triangle in ((a, b, c), (a, c, d))]
    return corners.astype(np.float64), np.array(faces)
