"""Simplifies triangle meshes by vertex clustering: vertices in one cell of a grid become one."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from hexapods.domain.types import FloatArray, IntArray

_COARSER = 0.8
_MOST_CELLS, _LEAST_CELLS = 1024, 2
"""Along the longest side."""
_MOST_COUNTED = 1 << 24
"""Cells of a grid that has a table of all of them."""
_Merged = tuple[IntArray, IntArray]
"""For each vertex its cluster, (n,); clusters of triangles that do not collapse, (m, 3)."""


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
    columns = np.ascontiguousarray(vertices.T)
    low, high = columns.min(axis=1), columns.max(axis=1)
    size = max(float((high - low).max()), 1e-9)
    outward, span = columns - low[:, None], high - low

    def merge(cells: float) -> _Merged:
        x, y, z = (outward * (cells / size)).astype(np.int64)
        counts = (span * (cells / size)).astype(np.int64) + 1
        return _merge(faces, (x * counts[1] + y) * counts[2] + z, int(np.prod(counts)))

    place, corners = _finest(merge, _grids(most), most)
    used, renumbered = np.unique(corners, return_inverse=True)
    counts = np.bincount(place)
    means = np.stack([np.bincount(place, column) / counts for column in columns], axis=1)
    return means[used], renumbered.reshape(-1, 3)[:most]


def _grids(most: int) -> list[float]:
    """Return numbers of cells along the longest side, the finest first."""
    # A closed surface has about twice as many triangles as its cells, some of each side of a cube.
    grids = [min(2.0 * math.sqrt(most), _MOST_CELLS)]
    while grids[-1] >= _LEAST_CELLS:
        grids.append(grids[-1] * _COARSER)
    return grids


def _finest(merge: Callable[[float], _Merged], grids: Sequence[float], most: int) -> _Merged:
    """Return what the finest grid makes that leaves at most so many triangles; else the coarsest.

    Few grids are tried: the number of triangles is about that of cells, which grows as the square.
    """
    number, too_fine = 0, -1
    merged = merge(grids[0])
    while len(merged[1]) > most and number < len(grids) - 1:
        too_fine = number
        steps = math.log(most / len(merged[1])) / (2 * math.log(_COARSER))
        number = min(number + max(1, math.floor(steps)), len(grids) - 1)
        merged = merge(grids[number])
    while number - 1 > too_fine and len((finer := merge(grids[number - 1]))[1]) <= most:
        number, merged = number - 1, finer
    return merged


def _merge(faces: IntArray, cells: IntArray, count: int) -> _Merged:
    """Merge vertices in the same cell, and drop triangles that collapse.

    Args:
        faces: (m, 3).
        cells: number of the cell of each vertex, (n,).
        count: of all cells of the grid.
    """
    place = _ranks(cells, count)
    moved = place[faces]
    a, b, c = moved.T
    moved = moved[(a != b) & (b != c) & (c != a)]
    # The same triangle only once, wherever it begins.
    first = moved.argmin(axis=1)
    turned = moved[np.arange(len(moved))[:, None], (first[:, None] + np.arange(3)) % 3]
    _, once = np.unique(_keys(turned, int(place.max()) + 2), return_index=True)
    return place, turned[once]


def _ranks(cells: IntArray, count: int) -> IntArray:
    """Return for each cell its place among the different ones in order, (n,)."""
    ranks: IntArray
    if count > _MOST_COUNTED:
        ranks = np.unique(cells, return_inverse=True)[1]
        return ranks
    # Without sorting, which would take most of the time.
    is_used = np.zeros(count, dtype=bool)
    is_used[cells] = True
    used = np.flatnonzero(is_used)
    numbers = np.empty(count, dtype=np.int32)
    numbers[used] = np.arange(len(used))
    ranks = numbers[cells].astype(np.int64)
    return ranks


def _keys(triples: IntArray, base: int) -> IntArray:
    """Return one number for each row of three, each below a base."""
    keys: IntArray = (triples[:, 0] * base + triples[:, 1]) * base + triples[:, 2]
    return keys
