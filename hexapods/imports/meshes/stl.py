"""Reads and writes STL, binary or as text."""

import re

import numpy as np

from hexapods.domain.errors import DamagedFile
from hexapods.domain.types import FloatArray

TRIANGLE_BYTES = 50
"""Of a binary STL."""
_HEAD_BYTES = 84
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def read_stl(content: bytes) -> tuple[FloatArray, bool]:
    """Return the corners of all triangles, (n, 3, 3), and whether the file is binary and whole.

    Bytes after the last triangle are ignored, and the file is not whole then.

    Raises:
        DamagedFile: if it is no STL with triangles.
    """
    size = len(content) - _HEAD_BYTES
    count = int.from_bytes(content[80:84], "little")
    if size >= 0 and 0 < TRIANGLE_BYTES * count <= size:
        records = np.frombuffer(content, _TRIANGLE, count, _HEAD_BYTES)
        return records["corners"], size == TRIANGLE_BYTES * count
    if content.lstrip()[:5].lower() == b"solid":
        return _text_corners(content), False
    if size == count == 0:
        raise DamagedFile("it has no triangles")
    if 0 <= size < TRIANGLE_BYTES * count < 1 << 32:
        raise DamagedFile(
            f"it is cut short after {size // TRIANGLE_BYTES:,} of {count:,} triangles"
        )
    raise DamagedFile("it is no whole STL")


def write_stl(corners: FloatArray) -> bytes:
    """Return triangles, (n, 3, 3), as a binary STL."""
    triangles = np.zeros(len(corners), _TRIANGLE)
    triangles["corners"] = corners
    return bytes(80) + len(corners).to_bytes(4, "little") + triangles.tobytes()


def _text_corners(content: bytes) -> FloatArray:
    try:
        numbers = np.array(_VERTEX.findall(content), dtype=np.float64)
    except ValueError as error:
        raise DamagedFile("a vertex is no number") from error
    if len(numbers) == 0:
        raise DamagedFile("it has no triangles")
    if len(numbers) % 3:
        raise DamagedFile("its last triangle is cut short")
    return numbers.reshape(-1, 3, 3)
