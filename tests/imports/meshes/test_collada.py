import re

import numpy as np
import pytest

from hexapods.domain.errors import DamagedFile
from hexapods.domain.types import FloatArray
from hexapods.imports.meshes.collada import read_collada
from tests.imports.meshes.collada_files import POLYGONS, POLYLIST, SQUARE, TRIANGLES, dae
from tests.imports.robots import bug, read, zipped
from tests.imports.test_mjcf import mentions
from tests.imports.test_urdf import MESH, decoded


def area(corners: FloatArray) -> float:
    a, b, c = np.moveaxis(corners, 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@pytest.mark.parametrize("polygons", [TRIANGLES, POLYLIST, POLYGONS])
def test_polygons_become_triangles(polygons: str) -> None:
    corners = read_collada(dae(polygons), "square.dae")

    assert corners.shape == (2, 3, 3)
    assert area(corners) == pytest.approx(2)
    assert np.ptp(corners.reshape(-1, 3), axis=0) == pytest.approx([2, 1, 0])


def test_nodes_and_units_place_them() -> None:
    node = (
        "<translate>0 0 5</translate><rotate>0 0 1 90</rotate><scale>1 2 1</scale>"
        "<node><matrix>1 0 0 10 0 1 0 0 0 0 1 0 0 0 0 1</matrix>"
        '<instance_geometry url="#g"/><instance_geometry url="#g"/></node>'
    )

    corners = read_collada(dae(node=node, meter="0.1"), "square.dae").reshape(-1, 3)

    # x + 10, y doubled, turned to the left, lifted; in tenths of a metre.
    assert corners.min(axis=0) == pytest.approx([-0.2, 1, 0.5])
    assert corners.max(axis=0) == pytest.approx([0, 1.2, 0.5])
    assert len(corners) == 2 * 2 * 3


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"<COLLADA/>", "has no triangles"),
        (dae(square="0 0 0"), "a corner has a vertex that does not exist"),
        (dae(square=SQUARE.replace("2", "nan")), "has no triangles that can be read"),
        (dae(square=SQUARE.replace("2", "wide")), "no whole COLLADA file"),
        (dae(POLYLIST.replace(">4<", ">9<")), "more corners than there are"),
        (dae(TRIANGLES.replace("3 9<", "-3 9<")), "a vertex that does not exist"),
        (dae(node='<matrix>1 2</matrix><instance_geometry url="#g"/>'), "no whole COLLADA file"),
        (dae(node='<instance_geometry url="#g"/>' * 600), "more than 500 parts"),
        (b"<COLLADA>", "no whole XML document"),
    ],
)
def test_a_damaged_collada_file_is_refused(data: bytes, said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        read_collada(data, "square.dae")


@pytest.mark.test
def test_a_robot_is_drawn_by_them() -> None:
    files = {"bug.urdf": bug(torso=MESH.format(file="hull.dae"))}

    robot = read(zipped({**files, "hull.dae": dae()}))
    damaged = read(zipped({**files, "hull.dae": b"<COLLADA/>"}))

    vertices, _ = decoded(robot.model.links[0].mesh)
    assert np.ptp(vertices, axis=0) == pytest.approx([0.5, 1, 0], abs=1e-6)
    assert mentions(damaged.repairs, "1 mesh is left out as damaged: hull.dae (it has no triangles")
