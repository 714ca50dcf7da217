"""Triangle meshes of primitive shapes.

Faces at sharp edges share no vertices, since viser's client smooths normals over shared ones.
"""

from itertools import combinations
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from hexapods.domain.types import FloatArray

_ROUND = 20
"""Number of corners of a polygon that approximates a circle."""


class Shape(NamedTuple):
    """Triangle mesh."""

    vertices: NDArray[np.float32]
    """(v, 3) [m]"""
    faces: NDArray[np.uint32]
    """(f, 3) rows of `vertices`."""

    def moved(self, rotation: FloatArray, translation: FloatArray) -> "Shape":
        """Return the mesh rotated by a matrix (3, 3), then translated by a vector (3,) [m]."""
        vertices = self.vertices @ rotation.T + translation
        return Shape(vertices.astype(np.float32), self.faces)


def joined(shapes: list[Shape]) -> Shape:
    """Concatenate several meshes into one."""
    sizes = np.cumsum([0, *(len(shape.vertices) for shape in shapes)])[:-1]
    faces = [shape.faces + np.uint32(start) for shape, start in zip(shapes, sizes, strict=True)]
    return Shape(np.concatenate([s.vertices for s in shapes]), np.concatenate(faces))


def geom_shape(model: mujoco.MjModel, geom: int) -> Shape:
    """Return the mesh of a MuJoCo geom in its own frame.

    Raises:
        ValueError: if the geom's type is not supported.
    """
    kind, size = mujoco.mjtGeom(int(model.geom_type[geom])), model.geom_size[geom]
    types = mujoco.mjtGeom
    if kind == types.mjGEOM_BOX:
        return box(size)
    if kind == types.mjGEOM_CYLINDER:
        return cylinder(size[0], size[1])
    if kind == types.mjGEOM_CAPSULE:
        return _capsule(size[0], size[1])
    if kind == types.mjGEOM_MESH:
        return mesh(model, int(model.geom_dataid[geom]))
    if kind in (types.mjGEOM_SPHERE, types.mjGEOM_ELLIPSOID):
        radii = size if kind == types.mjGEOM_ELLIPSOID else np.full(3, size[0])
        vertices, faces = _unit_sphere()
        return _smooth(vertices * radii, faces)
    raise ValueError(f"geom {geom} is of type {kind}, which the stage cannot draw")


def mesh(model: mujoco.MjModel, number: int) -> Shape:
    """Return a mesh of a model; at edges its faces share no vertices.

    Faces share a vertex whose normals are in one of 26 directions.
    """
    start, count = int(model.mesh_vertadr[number]), int(model.mesh_vertnum[number])
    first, faces_count = int(model.mesh_faceadr[number]), int(model.mesh_facenum[number])
    vertices = model.mesh_vert[start : start + count]
    faces = model.mesh_face[first : first + faces_count]
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    towards = np.repeat((np.rint(normals) + 1).astype(int) @ (1, 3, 9), 3)
    unique, number_of = np.unique(faces.ravel() * 27 + towards, return_inverse=True)
    return _smooth(vertices[unique // 27], number_of.reshape(-1, 3))


def box(half: FloatArray) -> Shape:
    """Return a box centred on the origin, from the halves of its edges, (3,) [m]."""
    sides = []
    for axis in range(3):
        across, up = (axis + 1) % 3, (axis + 2) % 3
        for sign in (1.0, -1.0):
            corners = np.zeros((4, 3))
            corners[:, axis] = sign
            corners[:, across] = sign * np.array([-1, 1, 1, -1])
            corners[:, up] = [-1, -1, 1, 1]
            sides.append(_smooth(corners * half, np.array([[0, 1, 2], [0, 2, 3]])))
    return joined(sides)


def cylinder(radius: float, half_height: float) -> Shape:
    """Return a cylinder around z, centred on the origin [m]."""
    angles = 2 * np.pi * np.arange(_ROUND) / _ROUND
    rim = radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    up = np.array([0.0, 0.0, half_height])
    index, next_index = np.arange(_ROUND), (np.arange(_ROUND) + 1) % _ROUND
    side = _triangles(
        (index, next_index, _ROUND + next_index), (index, _ROUND + next_index, _ROUND + index)
    )
    top, flipped = disc(radius), np.diag([1.0, -1.0, -1.0])
    wall = _smooth(np.concatenate([rim - up, rim + up]), side)
    return joined([wall, top.moved(np.eye(3), up), top.moved(flipped, -up)])


def disc(radius: float, corners: int = _ROUND) -> Shape:
    """Return a disc in the plane z = 0, facing up; radius in m."""
    angles = 2 * np.pi * np.arange(corners) / corners
    rim = radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    vertices = np.concatenate([[[0.0, 0.0, 0.0]], rim])
    index = np.arange(corners)
    faces = np.stack([0 * index, 1 + index, 1 + (index + 1) % corners], axis=1)
    return _smooth(vertices, faces)


def strip(width: float, depth: float) -> Shape:
    """Return a rectangle in the plane z = 0, facing up, x by y [m], centred on the origin."""
    x, y = width / 2, depth / 2
    return outlined(np.array([[-x, -y], [x, -y], [x, y], [-x, y]]))


def outlined(corners: FloatArray) -> Shape:
    """Return a convex polygon in the plane z = 0, facing up, from its corners, (k, 2) [m].

    The corners are anticlockwise.
    """
    after = np.arange(1, len(corners) - 1)
    faces = np.stack([0 * after, after, after + 1], axis=1)
    return _smooth(np.column_stack([corners, np.zeros(len(corners))]), faces)


def surface(points: FloatArray) -> Shape:
    """Return a surface through points on a grid, (rows, columns, 3) [m].

    It faces up where x grows with the column and y with the row.
    """
    rows, columns, _ = points.shape
    index = np.arange(rows * columns).reshape(rows, columns)
    corner, right, up = index[:-1, :-1], index[:-1, 1:], index[1:, :-1]
    corners = [indices.ravel() for indices in (corner, right, index[1:, 1:], up)]
    faces = _triangles((corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3]))
    return _smooth(points.reshape(-1, 3), faces)


def arrow(length: float) -> Shape:
    """Return a flat arrow in the plane z = 0 towards +y, facing up, centred on the origin [m]."""
    half = length / 2
    stem = strip(0.3 * length, 0.55 * length)
    stem = stem.moved(np.eye(3), np.array([0.0, 0.275 * length - half, 0.0]))
    point = np.array([[-0.35 * length, 0.05 * length], [0.35 * length, 0.05 * length], [0.0, half]])
    return joined([stem, outlined(point)])


def antenna(height: float) -> Shape:
    """Return a thin mast from z = 0 to a height [m], with a ball on its top."""
    mast = cylinder(0.003, height / 2).moved(np.eye(3), np.array([0, 0, height / 2]))
    vertices, faces = _unit_sphere()
    return joined([mast, _smooth(0.016 * vertices + np.array([0, 0, height]), faces)])


def flag(height: float) -> Shape:
    """Return a pole from z = 0 to a height [m], with a pennant towards +x."""
    pole = cylinder(0.02 * height, height / 2).moved(np.eye(3), np.array([0, 0, height / 2]))
    top, low, out = height, 0.62 * height, 0.55 * height
    lean = 0.2 * height  # towards the light, which comes from above
    cloth = np.array([[0, lean, top], [0, -lean, low], [out, 0, (top + low) / 2]])
    return joined([pole, _smooth(cloth, np.array([[0, 1, 2]]))])


def _capsule(radius: float, half_length: float) -> Shape:
    """Return a capsule around z, centred on the origin [m]: rings of vertices, and two poles."""
    sides, quarter = 12, np.linspace(0, np.pi / 2, _ROUND // 2 + 1)
    rise = np.concatenate([quarter[1:] - np.pi / 2, quarter[:-1]])
    turn = 2 * np.pi * np.arange(sides) / sides
    rings = np.empty((len(rise), sides, 3))
    rings[..., 0] = radius * np.outer(np.cos(rise), np.cos(turn))
    rings[..., 1] = radius * np.outer(np.cos(rise), np.sin(turn))
    shift = np.repeat([-half_length, half_length], _ROUND // 2)
    rings[..., 2] = (radius * np.sin(rise) + shift)[:, None]
    poles = np.array([[0, 0, -1], [0, 0, 1]]) * (radius + half_length)
    index = np.arange(rings.shape[0] * sides).reshape(-1, sides)
    after = np.roll(index, -1, axis=1)
    bottom, top = np.full(sides, index.size), np.full(sides, index.size + 1)
    faces = _triangles(
        (index[:-1], after[:-1], index[1:]),
        (index[1:], after[:-1], after[1:]),
        (bottom, after[0], index[0]),
        (top, index[-1], after[-1]),
    )
    return _smooth(np.concatenate([rings.reshape(-1, 3), poles]), faces)


def _unit_sphere() -> tuple[FloatArray, NDArray[np.integer[Any]]]:
    """Return vertices (162, 3) and faces (320, 3) of an icosahedron that is subdivided twice."""
    golden = (1 + 5**0.5) / 2
    first = [[0, unit, long] for unit in (1, -1) for long in (golden, -golden)]
    vertices = np.concatenate([np.roll(first, axis, axis=1) for axis in range(3)])
    faces = np.array(list(combinations(range(len(vertices)), 3)))
    # Neighbours are 2 apart.
    edges = vertices[faces] - vertices[np.roll(faces, 1, axis=1)]
    faces = faces[(np.linalg.norm(edges, axis=2) < 2.1).all(axis=1)]
    inwards = np.linalg.det(vertices[faces]) < 0
    faces[inwards] = faces[inwards, ::-1]
    for _ in range(2):
        sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2)).reshape(-1, 2)
        once, number = np.unique(sides, axis=0, return_inverse=True)
        (a, b, c), (ab, bc, ca) = faces.T, len(vertices) + number.reshape(-1, 3).T
        vertices = np.concatenate([vertices, vertices[once].mean(axis=1)])
        faces = _triangles((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    return vertices, faces


def _triangles(*corners: tuple[NDArray[np.integer[Any]], ...]) -> NDArray[np.integer[Any]]:
    """Stack triples of index arrays, each with the first, second and third corners, to (f, 3)."""
    return np.concatenate([np.stack(three, axis=-1).reshape(-1, 3) for three in corners])


def _smooth(vertices: FloatArray, faces: NDArray[np.integer[Any]]) -> Shape:
    return Shape(vertices.astype(np.float32), faces.astype(np.uint32))
