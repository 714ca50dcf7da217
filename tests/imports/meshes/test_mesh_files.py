"""Meshes that cannot be read, and meshes that are many."""

import re

import numpy as np
import pytest

from hexapods.domain.errors import DamagedFile
from hexapods.imports.child import ReadingLimits, read_robot_file
from hexapods.imports.imported import ImportedRobot
from hexapods.imports.meshes.obj import read_obj, write_obj
from tests.imports.meshes.gltf_files import document, glb
from tests.imports.robots import INERTIAL, box_triangles, bug, dog, read, stl, text_stl, zipped
from tests.imports.test_mjcf import mentions
from tests.imports.test_urdf import MESH, decoded

BOX = box_triangles((0.4, 0.2, 0.08))
PATIENT = ReadingLimits(clock_seconds=300.0)
"""On a busy machine the processor time of a reading is a small part of it."""
WEB_PAGE = b"<!DOCTYPE html><html><body>Not Found</body></html>"
OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"


def drawn_as(file: str, content: bytes) -> ImportedRobot:
    """Read a hexapod whose torso has a box, and is drawn by a mesh."""
    box = '<collision><geometry><box size="0.2 0.1 0.04"/></geometry></collision>'
    text = bug(torso=box + MESH.format(file=file))
    return read(zipped({"bug.urdf": text, file: content}))


@pytest.mark.parametrize(
    ("file", "content", "why"),
    [
        ("hull.stl", b"", "it is empty"),
        ("hull.glb", b"", "it is empty"),
        ("hull.gltf", b"{}", "it is no glTF of version 2"),
        ("hull.glb", glb(document(BOX))[:500], "it is no whole GLB of version 2"),
        ("hull.stl", bytes((32 << 20) + 1), "has 33,554,433 bytes; at most"),
        ("hull.STL", WEB_PAGE, "it is a web page, not the mesh"),
        ("hull.stl", b"version https://git-lfs.github.com/spec/v1\n", "a pointer of Git LFS"),
        ("hull.stl", bytes(84), "it has no triangles"),
        ("hull.stl", stl(BOX)[:300], "it is cut short after 4 of 12 triangles"),
        ("hull.stl", stl(BOX)[:80] + b"\xff" * 300, "it is no whole STL"),
        ("hull.stl", stl(BOX[:1]), "it has fewer than four vertices"),
        ("hull.stl", stl(np.full((9, 3, 3), np.nan)), "it has a number that is not finite"),
        ("hull.stl", stl(BOX * 1e12), "it has a vertex that is absurdly far away"),
        ("hull.stl", text_stl(BOX).rsplit(b"vertex", 1)[0], "its last triangle is cut short"),
        ("hull.stl", b"solid\nvertex 1 x 2\n", "a vertex is no number"),
        ("hull.obj", b"", "it is empty"),
        ("hull.obj", WEB_PAGE, "it is a web page, not the mesh"),
        ("hull.obj", OBJ, "it has no triangles"),
        ("hull.obj", OBJ + b"f 1 2 9\n", "a face has a vertex that does not exist"),
        ("hull.obj", OBJ + b"f 1 2 -9\n", "a face has a vertex that does not exist"),
        ("hull.obj", OBJ + b"f 1 2 x\n", "something else where numbers belong"),
        ("hull.obj", OBJ + b"v 1 2\nf 1 2 3\n", "a vertex has no three coordinates"),
        ("hull.obj", OBJ + b"f 1 2 3 99999999999999999999\n", "where numbers belong"),
        ("hull.dae", b"", "it is empty"),
        ("hull.dae", WEB_PAGE, "it is a web page, not the mesh"),
        ("hull.dae", b"<COLLADA>", "no whole XML document"),
    ],
)
def test_a_mesh_that_cannot_be_read_is_left_out_and_told(
    file: str, content: bytes, why: str
) -> None:
    robot = drawn_as(file, content)

    (note,) = (note for note in robot.notes if "1 mesh is left out as damaged" in note.text)
    assert why in note.text
    assert note.parts == ("base_link",)
    # Its simple shape is drawn.
    vertices, _ = decoded(robot.model.links[0].mesh)
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], abs=1e-6)


def test_what_mujoco_refuses_of_a_mesh_is_told_as_well() -> None:
    flat = '<mesh name="m" file="m.stl" scale="1 0 0"/>'
    drawn = '<geom type="mesh" mesh="m" contype="0" conaffinity="0"/>'
    text = dog(on_torso=drawn, sections=f"<asset>{flat}</asset>")

    robot = read(zipped({"dog.xml": text, "m.stl": stl(BOX)}))

    (note,) = (note for note in robot.notes if "1 mesh is left out as damaged: m.stl" in note.text)
    assert note.parts == ("trunk",)
    assert robot.model.links[0].mesh == read(dog()).model.links[0].mesh


def test_masses_of_meshes_that_mujoco_refuses_stay() -> None:
    line = BOX * [1, 0, 0]
    pack = '<body name="pack"><geom type="mesh" mesh="m" mass="0.5"/></body>'
    text = dog(on_torso=pack, sections='<asset><mesh name="m" file="m.stl"/></asset>')

    robot = read(zipped({"dog.xml": text, "m.stl": stl(line)}))

    assert robot.mass_kg == pytest.approx(8.9)


def test_a_scale_of_one_number_is_that_of_all_axes() -> None:
    content = stl(BOX)
    three = bug(torso=MESH.format(file="hull.stl"))
    one = three.replace('scale="0.5 0.5 0.5"', 'scale="0.5"')

    robots = [read(zipped({"bug.urdf": text, "hull.stl": content})) for text in (three, one)]

    assert robots[0].model == robots[1].model


def test_bytes_after_the_last_triangle_are_ignored_and_told() -> None:
    robot = drawn_as("hull.stl", stl(BOX) + b"\0" * 7)

    assert mentions(robot.repairs, "bytes after the last triangle were ignored in: hull.stl")
    assert robot.model == drawn_as("hull.stl", stl(BOX)).model


def test_a_binary_mesh_may_begin_with_solid() -> None:
    content = b"solid" + stl(BOX)[5:]

    assert drawn_as("hull.stl", content).model == drawn_as("hull.stl", stl(BOX)).model


class TestObj:
    def test_polygons_negative_indices_and_colours(self) -> None:
        text = (
            b"# box\nmtllib a.mtl\no a\nv 0 0 0 0.5 0.5 0.5\nv 1 0 0 1 1 1\nv\t1 1 0 1 1 1\n"
            b"vn 0 0 1\nvt 0 0\nf -3//1 -2//1 -1//1\nv 0 1 0 1 1 1\nf 1/1/1 2/1/1 3 4\n"
        )

        vertices, faces = read_obj(text)

        assert vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        assert faces.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3]]

    def test_what_was_written_is_read_again(self) -> None:
        vertices, faces = BOX.reshape(-1, 3), np.arange(36).reshape(-1, 3)

        again = read_obj(write_obj(vertices, faces))

        assert np.abs(again[0] - vertices).max() < 1e-9
        assert (again[1] == faces).all()

    def test_it_is_drawn(self) -> None:
        content = write_obj(BOX.reshape(-1, 3), np.arange(36).reshape(-1, 3))

        vertices, _ = decoded(drawn_as("hull.obj", content).model.links[0].mesh)

        assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], abs=1e-6)

    @pytest.mark.parametrize("text", [b"v 1 2 3\n", b"f 1 2 3\n", b"\xff\xfe\0"])
    def test_without_triangles_it_is_none(self, text: bytes) -> None:
        with pytest.raises(DamagedFile, match="no triangles"):
            read_obj(text)


def ball(cells: int) -> np.ndarray:
    """Return the triangles of a ball, 12 for each square of `cells`."""
    box = box_triangles((1, 1, 1), cells)
    return np.asarray(0.03 * box / np.linalg.norm(box, axis=2, keepdims=True))


@pytest.mark.test
@pytest.mark.parametrize(("count", "cells"), [(40, 35), (18, 90)])
def test_many_meshes_are_simplified_until_they_fit_into_the_memory(count: int, cells: int) -> None:
    mesh = stl(ball(cells))
    text = bug(inertial=INERTIAL + "@" * -(-count // 18))
    for number in range(text.count("@")):
        shape = MESH.format(file=f"m{number % count}.stl")
        text = text.replace("@", shape, 1)
    files = {f"m{number}.stl": mesh for number in range(count)}

    robot = read_robot_file(zipped({"bug.urdf": text, **files}), limits=PATIENT)

    (sentence,) = (text for text in robot.repairs if "together" in text)
    numbers = [int(number.replace(",", "")) for number in re.findall(r"[\d,]*\d", sentence)]
    assert numbers[:2] == [count, count * 12 * cells**2]
    assert 60_000 < numbers[2] <= 250_000
    vertices, _ = decoded(robot.model.links[2].mesh)
    # Drawn at half its size.
    assert np.linalg.norm(vertices, axis=1).mean() == pytest.approx(0.015, rel=0.05)


@pytest.mark.test
def test_a_mesh_that_mujoco_reads_several_times_counts_as_often() -> None:
    meshes = "".join(f'<mesh name="m{number}" file="m.stl"/>' for number in range(20))
    drawn = "".join(
        f'<geom type="mesh" mesh="m{number}" contype="0" conaffinity="0"/>' for number in range(20)
    )
    text = dog(on_torso=drawn, sections=f"<asset>{meshes}</asset>")

    robot = read_robot_file(zipped({"dog.xml": text, "m.stl": stl(ball(60))}), limits=PATIENT)

    assert mentions(robot.repairs, "mesh m.stl was simplified from 43,200 to")
