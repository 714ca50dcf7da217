"""Reads the triangles of a glTF 2.0 file, as JSON (`.gltf`) or binary (`.glb`).

Of the format it takes what robots' files have: triangles, placed by the nodes of the scene, of
floats and whole numbers that are stored plainly. Every count and offset is checked against the
bytes that are there. Materials, skins, morphs and animations are ignored. In glTF y points up; as
in RViz 2, Drake and Blender it is turned so that z does.
"""

import base64
import binascii
import json
import struct
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from hexapods.domain.errors import DamagedFile
from hexapods.domain.types import FloatArray, IntArray
from hexapods.imports.notes import quoted

BufferReader = Callable[[str], bytes]
"""Returns the content of a buffer by its path beside the file.

Raises:
    DamagedFile: if it is missing or too large.
"""
_MAX_NODES, _MAX_DEPTH = 10_000, 200
_MAX_TRIANGLES, _MAX_ROWS = 700_000, 3_000_000
"""Of all instances, and rows of accessors that are read."""
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942
_FLOAT = 5126
_INDEX_TYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4"}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_COMPRESSED = ("draco", "meshopt", "quantization")
_Y_UP_TO_Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
_PLACES = (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError)
"""What a document raises whose parts do not fit each other."""


def read_gltf(data: bytes, read_buffer: BufferReader) -> FloatArray:
    """Return the corners of all triangles of a scene, (n, 3, 3) [m], z up.

    Raises:
        DamagedFile: if it is no glTF with triangles, or one that is compressed.
    """
    text, binary = _chunks(data) if data.startswith(b"glTF") else (data, None)
    scene = _GltfScene(_document(text), binary, read_buffer)
    try:
        corners = [np.empty((0, 3, 3)), *scene.triangles()]
    except DamagedFile:
        raise
    except _PLACES as error:
        raise DamagedFile(f"it is no whole glTF ({type(error).__name__}: {error})") from error
    together: FloatArray = np.concatenate(corners) @ _Y_UP_TO_Z_UP.T
    return together


def _chunks(data: bytes) -> tuple[bytes, bytes | None]:
    """Return the JSON and the binary buffer of a GLB."""
    if len(data) < 20:
        raise DamagedFile("it is no whole GLB")
    _, version, length = struct.unpack_from("<4s2I", data)
    if version != 2 or not 20 <= length <= len(data):
        raise DamagedFile("it is no whole GLB of version 2")
    chunks: list[tuple[int, bytes]] = []
    at = 12
    while at + 8 <= length and len(chunks) < 2:
        size, kind = struct.unpack_from("<2I", data, at)
        if at + 8 + size > length:
            raise DamagedFile("it is no whole GLB: a chunk is cut short")
        chunks.append((kind, data[at + 8 : at + 8 + size]))
        at += 8 + size
    if chunks[0][0] != _JSON_CHUNK:
        raise DamagedFile("it is no whole GLB: it does not begin with JSON")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BINARY_CHUNK else None
    return chunks[0][1], binary


def _document(text: bytes) -> dict[str, Any]:
    """Parse the JSON, and check that it needs nothing that is not read."""
    try:
        document = json.loads(
            text.decode("utf-8-sig").rstrip("\0"), parse_constant=_refuse_constant
        )
    except (ValueError, RecursionError) as error:
        raise DamagedFile("it is no glTF: its JSON is damaged") from error
    version = document.get("asset") if isinstance(document, dict) else None
    if not isinstance(version, dict) or not str(version.get("version")).startswith("2"):
        raise DamagedFile("it is no glTF of version 2")
    required = document.get("extensionsRequired", [])
    if not isinstance(required, list):
        raise DamagedFile("it is no whole glTF")
    for name in map(str, required):
        if any(word in name for word in _COMPRESSED):
            raise DamagedFile(f"it is compressed ({quoted(name)}): export it without")
    checked: dict[str, Any] = document
    return checked


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is no number")


class _GltfScene:
    """The scene of a document, with what it reads of buffers."""

    def __init__(
        self, document: dict[str, Any], binary: bytes | None, read_buffer: BufferReader
    ) -> None:
        self._document, self._binary, self._read_buffer = document, binary, read_buffer
        self._buffers: dict[int, bytes] = {}
        self._arrays: dict[int, np.ndarray] = {}
        self._rows = self._triangles = 0

    def triangles(self) -> Iterator[FloatArray]:
        """Iterate over the corners of each instance of a mesh, (n, 3, 3)."""
        for mesh, matrix in self._instances():
            for primitive in _list(self._element("meshes", mesh), "primitives"):
                corners = self._primitive(primitive)
                yield corners @ matrix[:3, :3].T + matrix[:3, 3]

    def _element(self, kind: str, number: Any) -> dict[str, Any]:
        """Return an element of a list of the document by its number."""
        elements = _list(self._document, kind)
        if not isinstance(number, int) or not 0 <= number < len(elements):
            raise ValueError(f"{kind} has no {str(number)[:20]}")
        element = elements[number]
        if not isinstance(element, dict):
            raise TypeError(f"{kind} {number} is no object")
        return element

    def _instances(self) -> Iterator[tuple[int, FloatArray]]:
        """Iterate over the meshes of the scene's nodes with their places, (4, 4)."""
        waiting = [(number, np.eye(4), 0) for number in self._roots()]
        count = 0
        while waiting:
            number, above, depth = waiting.pop()
            count += 1
            if count > _MAX_NODES or depth > _MAX_DEPTH:
                raise ValueError(f"it has more than {_MAX_NODES:,} nodes, or they form a circle")
            node = self._element("nodes", number)
            matrix = above @ _transform(node)
            if "mesh" in node:
                yield node["mesh"], matrix
            waiting += [(child, matrix, depth + 1) for child in _list(node, "children")]

    def _roots(self) -> list[Any]:
        """Return the numbers of the nodes at the top of the scene."""
        if _list(self._document, "scenes"):
            return _list(self._element("scenes", self._document.get("scene", 0)), "nodes")
        nodes = _list(self._document, "nodes")
        below = {child for node in nodes for child in _list(node, "children")}
        return [number for number in range(len(nodes)) if number not in below]

    def _primitive(self, primitive: dict[str, Any]) -> FloatArray:
        """Return the corners of a primitive's triangles, (n, 3, 3); lines and points have none."""
        mode = primitive.get("mode", _TRIANGLES)
        if mode not in (_TRIANGLES, _STRIP, _FAN):
            return np.empty((0, 3, 3))
        vertices = self._vertices(primitive["attributes"]["POSITION"])
        indices = np.arange(len(vertices))
        if "indices" in primitive:
            indices = self._indices(primitive["indices"])
        if len(indices) and indices.max() >= len(vertices):
            raise ValueError("a corner has a vertex that does not exist")
        triangles = _corners(indices, mode)
        self._triangles += len(triangles)
        if self._triangles > _MAX_TRIANGLES:
            raise ValueError(f"it has more than {_MAX_TRIANGLES:,} triangles")
        corners: FloatArray = vertices[triangles]
        return corners

    def _vertices(self, number: Any) -> FloatArray:
        accessor = self._element("accessors", number)
        if accessor.get("type") != "VEC3" or accessor.get("componentType") != _FLOAT:
            raise DamagedFile("its vertices are compressed (no floats): export it without")
        if number not in self._arrays:
            self._arrays[number] = self._read(accessor, "<f4", 3)
        return self._arrays[number]

    def _indices(self, number: Any) -> IntArray:
        accessor = self._element("accessors", number)
        kind = _INDEX_TYPES.get(accessor["componentType"])
        if accessor.get("type") != "SCALAR" or kind is None:
            raise ValueError("its corners are no whole numbers")
        if number not in self._arrays:
            self._arrays[number] = self._read(accessor, kind, 1)
        indices: IntArray = self._arrays[number][:, 0].astype(np.int64)
        return indices

    def _read(self, accessor: dict[str, Any], kind: str, columns: int) -> np.ndarray:
        """Return the rows of an accessor, after a check of where they are, (n, columns)."""
        if "sparse" in accessor or "bufferView" not in accessor:
            raise DamagedFile("its vertices are sparse or compressed: export it without")
        view = self._element("bufferViews", accessor["bufferView"])
        content = self._buffer(view["buffer"])
        item = np.dtype(kind).itemsize * columns
        count, at = _whole(accessor, "count"), _whole(accessor, "byteOffset", 0)
        start, size = _whole(view, "byteOffset", 0), _whole(view, "byteLength")
        stride = _whole(view, "byteStride", item)
        if not item <= stride <= 252:
            raise ValueError("a stride does not fit its rows")
        needed = at + (count - 1) * stride + item if count else 0
        if needed > size or start + size > len(content):
            raise ValueError("an accessor reaches beyond its buffer")
        self._rows += count
        if self._rows > _MAX_ROWS:
            raise ValueError(f"its accessors have more than {_MAX_ROWS:,} rows")
        rows = np.ndarray((count, columns), kind, content, start + at, (stride, item // columns))
        return rows.copy()

    def _buffer(self, number: Any) -> bytes:
        if number not in self._buffers:
            buffer = self._element("buffers", number)
            self._buffers[number] = self._content(number, buffer.get("uri"))
        return self._buffers[number]

    def _content(self, number: int, uri: Any) -> bytes:
        """Return a buffer: of the GLB, of a `data:` address, or of a file beside it."""
        if uri is None:
            if self._binary is None or number != 0:
                raise ValueError("a buffer has no content")
            return self._binary
        if not isinstance(uri, str):
            raise TypeError("the address of a buffer is no text")
        if not uri.startswith("data:"):
            return self._read_buffer(uri)
        head, _, body = uri.partition(",")
        if not head.endswith(";base64"):
            raise ValueError("the data of a buffer is not in base64")
        try:
            return base64.b64decode(body, validate=True)
        except binascii.Error as error:
            raise ValueError("the data of a buffer is not in base64") from error


def _list(element: dict[str, Any], name: str) -> list[Any]:
    items = element.get(name, [])
    if not isinstance(items, list):
        raise TypeError(f"{name} is no list")
    return items


def _whole(element: dict[str, Any], name: str, default: int | None = None) -> int:
    """Return a whole number that is not negative."""
    number = element.get(name, default)
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < 1 << 32:
        raise ValueError(f"{name} is no count of bytes or rows")
    return number


def _transform(node: dict[str, Any]) -> FloatArray:
    """Return the transform of a node, (4, 4)."""
    if "matrix" in node:
        return _numbers(node["matrix"], 16).reshape(4, 4).T
    x, y, z, w = _numbers(node.get("rotation", (0, 0, 0, 1)), 4)
    length = max(float(np.sqrt(x * x + y * y + z * z + w * w)), 1e-12)
    x, y, z, w = x / length, y / length, z / length, w / length
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= _numbers(node.get("scale", (1, 1, 1)), 3)
    matrix[:3, 3] = _numbers(node.get("translation", (0, 0, 0)), 3)
    return matrix


def _numbers(values: Any, count: int) -> FloatArray:
    numbers = np.array(values, dtype=np.float64)
    if numbers.shape != (count,):
        raise ValueError(f"a transform has no {count} numbers")
    return numbers


def _corners(indices: IntArray, mode: int) -> IntArray:
    """Return the vertices of triangles, (n, 3)."""
    if mode == _TRIANGLES:
        return indices[: len(indices) // 3 * 3].reshape(-1, 3)
    count = max(len(indices) - 2, 0)
    number = np.arange(count)
    odd = number % 2
    places = np.stack([number, number + 1 + odd, number + 2 - odd], axis=1)
    if mode == _FAN:
        places = np.stack([np.zeros_like(number), number + 1, number + 2], axis=1)
    triangles: IntArray = indices[places]
    return triangles
