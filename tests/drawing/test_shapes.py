"""Meshes of primitive shapes are closed, face outwards, and have the size that is asked for."""

from collections import Counter

import mujoco
import numpy as np
import pytest

from hexapods.drawing.shapes import Shape, geom_shape


def shape_of(geom: str) -> Shape:
    xml = f"<mujoco><worldbody><geom {geom}/></worldbody></mujoco>"
    return geom_shape(mujoco.MjModel.from_xml_string(xml), 0)


@pytest.mark.parametrize(
    ("geom", "half_extent_m", "volume_m3"),
    [
        ('type="sphere" size="0.3"', (0.3, 0.3, 0.3), 4 / 3 * np.pi * 0.3**3),
        ('type="ellipsoid" size="0.3 0.2 0.1"', (0.3, 0.2, 0.1), 4 / 3 * np.pi * 0.006),
        ('type="capsule" size="0.1 0.4"', (0.1, 0.1, 0.5), np.pi * (0.01 * 0.8 + 4 / 3 * 0.001)),
    ],
    ids=["sphere", "ellipsoid", "capsule"],
)
def test_round_shapes(
    geom: str, half_extent_m: tuple[float, float, float], volume_m3: float
) -> None:
    shape = shape_of(geom)
    corners = shape.vertices[shape.faces].astype(float)
    edges = Counter((int(f[i]), int(f[i - 2])) for f in shape.faces for i in range(3))

    assert set(edges.values()) == {1}
    assert edges.keys() == {(b, a) for a, b in edges}, "each edge joins two faces of one side"
    assert (np.linalg.det(corners) > 0).all(), "faces are anticlockwise from outside"
    assert np.abs(shape.vertices).max(axis=0) == pytest.approx(half_extent_m, rel=0.06)
    # Chords lie inside of what they approximate.
    assert 0.85 * volume_m3 < np.linalg.det(corners).sum() / 6 < volume_m3
