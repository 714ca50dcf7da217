"""Reads the triangles of a Wavefront OBJ: vertices and faces, of which polygons are cut.

Normals, textures, groups and materials are ignored.
"""

import re

import numpy as np

from hexapods.domain.errors import DamagedFile
from hexapods.domain.types import FloatArray, IntArray
from hexapods.imports.meshes.collada import cut_polygons

_OTHER_INDICES = re.compile(rb"/\S*")
"""Indices of textures and normals behind that of the vertex."""


def read_obj(content: bytes) -> tuple[FloatArray, IntArray]:
    """Return vertices, (n, 3), and faces, (m, 3).

    Raises:
        DamagedFile: if it is no OBJ with triangles.
    """
    lines = content.replace(b"\\\n", b" ").replace(b"\t", b" ").split(b"\n")
    vertex_lines = [line[2:] for line in lines if line[:2] == b"v "]
    face_lines = [line[2:] for line in lines if line[:2] == b"f "]
    if not vertex_lines or not face_lines:
        raise DamagedFile("it has no triangles")
    vertices = _vertices(vertex_lines)
    indices, sizes = _faces(face_lines)
    indices = _absolute(indices, sizes, lines) if (indices < 0).any() else indices - 1
    if len(indices) and not 0 <= indices.min() <= indices.max() < len(vertices):
        raise DamagedFile("a face has a vertex that does not exist")
    return vertices, cut_polygons(indices, sizes)


def write_obj(vertices: FloatArray, faces: IntArray) -> bytes:
    """Return vertices, (n, 3), and faces, (m, 3), as an OBJ."""
    places = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices.tolist()]
    corners = [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    return "\n".join([*places, *corners, ""]).encode()


def _vertices(lines: list[bytes]) -> FloatArray:
    """Return the first three numbers of each line, (n, 3)."""
    numbers = _numbers(b" ".join(lines), float)
    columns, rest = divmod(len(numbers), len(lines))
    if rest or columns < 3:
        raise DamagedFile("a vertex has no three coordinates")
    vertices: FloatArray = numbers.reshape(-1, columns)[:, :3]
    return vertices


def _faces(lines: list[bytes]) -> tuple[IntArray, IntArray]:
    """Return the vertices of all polygons in a row, (n,), and how many each has, (m,)."""
    together = _OTHER_INDICES.sub(b"", b" \n".join(lines))
    indices = _numbers(together, int)
    sizes = np.array([len(line.split()) for line in together.split(b"\n")], dtype=np.int64)
    if sizes.sum() != len(indices):
        raise DamagedFile("a face has no whole numbers")
    return indices, sizes


def _absolute(indices: IntArray, sizes: IntArray, lines: list[bytes]) -> IntArray:
    """Return indices from 0; negative ones count back from the last vertex above the face."""
    above: list[int] = []
    count = 0
    for line in lines:
        count += line[:2] == b"v "
        if line[:2] == b"f ":
            above.append(count)
    counts = np.repeat(np.array(above, dtype=np.int64), sizes)
    absolute: IntArray = np.where(indices < 0, counts + indices, indices - 1)
    return absolute


def _numbers(text: bytes, kind: type[float] | type[int]) -> np.ndarray:
    try:
        return np.array(list(map(kind, text.split())), dtype="f8" if kind is float else "i8")
    except (ValueError, OverflowError) as error:
        raise DamagedFile("it has something else where numbers belong") from error
