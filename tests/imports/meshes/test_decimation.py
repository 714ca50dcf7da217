from collections import Counter

import numpy as np
import pytest

from hexapods.domain.types import FloatArray, IntArray
from hexapods.imports.meshes import decimation
from hexapods.imports.meshes.decimation import cluster
from tests.imports.robots import box_triangles


def as_mesh(triangles: FloatArray) -> tuple[FloatArray, IntArray]:
    vertices, faces = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    return vertices, faces.reshape(-1, 3)


@pytest.mark.parametrize("most", [100, 300, 3000])
def test_a_mesh_gets_no_more_triangles_than_it_may_have(most: int) -> None:
    vertices, faces = as_mesh(box_triangles((2, 1, 0.5), cells=40))

    fewer, kept_faces = cluster(vertices, faces, most)

    assert most / 8 < len(kept_faces) <= most
    assert np.ptp(fewer, axis=0) == pytest.approx([2, 1, 0.5], rel=0.2 if most < 300 else 0.1)
    assert kept_faces.max() < len(fewer)
    a, b, c = kept_faces.T
    assert not ((a == b) | (b == c) | (c == a)).any()


def test_a_closed_mesh_stays_closed() -> None:
    vertices, faces = as_mesh(box_triangles((2, 1, 0.5), cells=30))

    _, kept_faces = cluster(vertices, faces, 1000)

    edges = Counter(
        tuple(edge)
        for face in kept_faces.tolist()
        for edge in zip(face, [*face[1:], face[0]], strict=True)
    )
    assert all(edges[b, a] == count for (a, b), count in edges.items())


def test_a_small_mesh_stays_as_it_is() -> None:
    vertices, faces = as_mesh(box_triangles((1, 1, 1)))

    fewer, kept_faces = cluster(vertices, faces, 12)

    assert fewer is vertices
    assert kept_faces is faces


def test_points_in_one_place_do_not_matter() -> None:
    vertices, faces = np.zeros((300, 3)), np.arange(300).reshape(-1, 3)

    fewer, kept_faces = cluster(vertices, faces, 10)

    assert len(kept_faces) == 0
    assert len(fewer) == 0


def test_a_grid_that_is_too_fine_to_be_counted_makes_the_same() -> None:
    vertices, faces = as_mesh(box_triangles((2, 1, 0.5), cells=40))

    with pytest.MonkeyPatch.context() as patch:
        counted = cluster(vertices, faces, 500)
        patch.setattr(decimation, "_MOST_COUNTED", 0)
        sorted_ = cluster(vertices, faces, 500)

    assert (counted[0] == sorted_[0]).all()
    assert (counted[1] == sorted_[1]).all()
