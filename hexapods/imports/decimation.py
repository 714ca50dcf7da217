"""Simplifies triangle meshes by vertex clustering: vertices in one cell of a grid become one."""

import math

import numpy as np

from hexapods.domain.types import FloatArray, IntArray

_COARSER = 0.8
_MOST_CELLS, _LEAST_CELLS = 1024, 2
"""Along the longest side."""


def cluster(vertices: FloatArray, faces: IntArray, most: int) -> tuple[FloatArray, IntArray]:
    """Return a mesh with at most so many triangles; itself if it has no more.

    Args:
        vertices: (n, 3).
        faces: indices of vertices, (m, 3).
        most: of triangles.

    Returns:
        vertices, (k, 3), and faces, (l, 3), with l at most `most`.
    """
    if len(faces) <= most:
        return vertices, faces
    low = vertices.min(axis=0)
    size = max(float((vertices.max(axis=0) - low).max()), 1e-9)
    # A closed surface has about twice as many triangles as its cells, some of each side of a cube.
    cells = min(2.0 * math.sqrt(most), _MOST_CELLS)
    while True:
        merged = _merge(vertices, faces, ((vertices - low) * (cells / size)).astype(np.int64))
        if len(merged[1]) <= most:
            return merged
        if cells < _LEAST_CELLS:
            return merged[0], merged[1][:most]
        cells *= _COARSER


def _merge(vertices: FloatArray, faces: IntArray, cells: IntArray) -> tuple[FloatArray, IntArray]:
    """Merge vertices in the same cell to their mean, and drop triangles that collapse."""
    _, place = np.unique(_keys(cells, _MOST_CELLS + 2), return_inverse=True)
    counts = np.bincount(place)
    means = np.stack([np.bincount(place, vertices[:, axis]) / counts for axis in range(3)], axis=1)
    moved = place[faces]
    a, b, c = moved.T
    moved = moved[(a != b) & (b != c) & (c != a)]
    # The same triangle only once, wherever it begins.
    first = moved.argmin(axis=1)
    turned = moved[np.arange(len(moved))[:, None], (first[:, None] + np.arange(3)) % 3]
    _, once = np.unique(_keys(turned, len(means) + 1), return_index=True)
    used, renumbered = np.unique(turned[once], return_inverse=True)
    return means[used], renumbered.reshape(-1, 3)


def _keys(triples: IntArray, base: int) -> IntArray:
    """Return one number for each row of three, each below a base."""
    keys: IntArray = (triples[:, 0] * base + triples[:, 1]) * base + triples[:, 2]
    return keys
