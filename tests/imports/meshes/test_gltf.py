import json
import re
from typing import Any

import numpy as np
import pytest

from hexapods.domain.errors import DamagedFile
from hexapods.imports.meshes.gltf import read_gltf
from tests.imports.meshes.gltf_files import document, glb, gltf
from tests.imports.robots import box_triangles, bug, read, zipped
from tests.imports.test_mjcf import mentions
from tests.imports.test_urdf import MESH, decoded

# Along y, which is up in the file.
BOX = box_triangles((0.4, 0.08, 0.2))
UPRIGHT = BOX @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]).T


def no_buffer(uri: str) -> bytes:
    raise AssertionError(uri)


def changed(**parts: Any) -> bytes:
    """Return a GLB of a box with other elements of the document."""
    text, buffer = document(BOX)
    return glb(({**text, **parts}, buffer))


@pytest.mark.parametrize("content", [gltf(BOX), glb(document(BOX))])
def test_its_triangles_are_read_with_z_up(content: bytes) -> None:
    corners = read_gltf(content, no_buffer)

    assert corners == pytest.approx(UPRIGHT, abs=1e-6)


def test_nodes_place_meshes() -> None:
    half = np.sqrt(0.5)
    moved = {"translation": [1, 2, 3], "rotation": [0, 0, half, half], "scale": [2, 1, 1]}
    matrix = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 5, 1]
    nodes = [{"children": [1], "matrix": matrix}, {"mesh": 0, **moved}]

    corners = read_gltf(changed(nodes=nodes), no_buffer)

    # Stretched along x, turned to y, moved; then twice as large, and moved along z.
    x, y, z = BOX[:, :, 0], BOX[:, :, 1], BOX[:, :, 2]
    placed = np.stack([2 * (1 - y), 2 * (2 + 2 * x), 2 * (3 + z) + 5], axis=2)
    assert corners == pytest.approx(
        np.stack([placed[..., 0], -placed[..., 2], placed[..., 1]], axis=2), abs=1e-5
    )


def test_strips_fans_and_triangles_without_indices() -> None:
    text, buffer = document(BOX[:2])
    for mode, triangles in ((4, 2), (5, 4), (6, 4), (1, 0), (0, 0)):
        primitive = {"attributes": {"POSITION": 0}, "mode": mode}
        text["meshes"] = [{"primitives": [primitive]}]

        assert len(read_gltf(glb((text, buffer)), no_buffer)) == triangles


def test_a_buffer_comes_from_the_zip_only() -> None:
    text, buffer = document(BOX, "parts/hull%20one.bin")
    robot_text = bug(torso=MESH.format(file="meshes/hull.gltf"))
    files = {"bug.urdf": robot_text, "meshes/hull.gltf": json.dumps(text)}

    whole = read(zipped({**files, "meshes/parts/hull one.bin": buffer}))
    lacking = read(zipped(files))

    vertices, _ = decoded(whole.model.links[0].mesh)
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], abs=1e-6)
    assert mentions(lacking.repairs, "1 mesh is left out as damaged: hull.gltf (its buffer hull")


@pytest.mark.parametrize(
    "uri", ["/etc/passwd", "../../../etc/passwd", "file:///etc/passwd", "http://example.org/a.bin"]
)
def test_a_buffer_from_elsewhere_is_not_read(uri: str) -> None:
    text, _ = document(BOX, uri)
    files = {"bug.urdf": bug(torso=MESH.format(file="hull.gltf")), "hull.gltf": json.dumps(text)}

    robot = read(zipped(files))

    assert mentions(robot.repairs, "1 mesh is left out as damaged: hull.gltf (its buffer")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"glTF", "no whole GLB"),
        (glb(document(BOX))[:100], "no whole GLB of version 2"),
        (glb(document(BOX))[:4] + b"\1" + glb(document(BOX))[5:], "no whole GLB of version 2"),
        (b"{}", "no glTF of version 2"),
        (b"[" * 100_000, "its JSON is damaged"),
        (b'{"asset": {"version": "1.0"}}', "no glTF of version 2"),
        (b'{"asset": {"version": "2.0"}, "a": NaN}', "its JSON is damaged"),
        (changed(extensionsRequired=["KHR_draco_mesh_compression"]), "is compressed (KHR_draco"),
        (changed(extensionsRequired=["EXT_meshopt_compression"]), "is compressed (EXT_meshopt"),
        (changed(extensionsRequired=["KHR_mesh_quantization"]), "is compressed (KHR_mesh_qua"),
        (changed(extensionsRequired=3), "no whole glTF"),
        (changed(scene=7), "scenes has no 7"),
        (changed(nodes=[{"children": [0, 0]}]), "nodes, or they form a circle"),
        (changed(nodes=[{"children": [True]}, {"mesh": -1}]), "meshes has no -1"),
        (changed(nodes=[{"mesh": 0, "matrix": [1, 2]}]), "has no 16 numbers"),
        (changed(nodes=[{"mesh": 0, "scale": "x"}]), "no whole glTF"),
        (changed(nodes=7), "nodes is no list"),
        (changed(meshes=[{"primitives": [{}]}]), "no whole glTF (KeyError"),
        (changed(meshes=[7]), "meshes 0 is no object"),
        (changed(accessors=[{"type": "VEC3", "componentType": 5122}]), "no floats"),
        (
            changed(accessors=[{"type": "VEC3", "componentType": 5126, "sparse": {}}]),
            "sparse or compressed",
        ),
        (changed(buffers=[{"uri": 7}]), "the address of a buffer is no text"),
        (changed(buffers=[{"uri": "data:,abc"}]), "is not in base64"),
        (changed(buffers=[{"uri": "data:;base64,???"}]), "is not in base64"),
    ],
)
def test_a_damaged_one_is_refused(content: bytes, said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        read_gltf(content, no_buffer)


@pytest.mark.parametrize(
    ("accessor", "view"),
    [
        ({"count": 37}, {}),
        ({"count": -1}, {}),
        ({"count": 1 << 40}, {}),
        ({"count": True}, {}),
        ({"byteOffset": 8}, {}),
        ({}, {"byteOffset": 1 << 31}),
        ({}, {"byteLength": 1 << 31, "byteOffset": 5000}),
        ({}, {"byteStride": 4}),
        ({}, {"byteStride": 100_000}),
        ({}, {"buffer": 1}),
    ],
)
def test_counts_and_offsets_beyond_the_bytes_are_refused(
    accessor: dict[str, Any], view: dict[str, Any]
) -> None:
    text, buffer = document(BOX)
    text["accessors"][0] |= accessor
    text["bufferViews"][0] |= view

    with pytest.raises(DamagedFile, match="no whole glTF"):
        read_gltf(glb((text, buffer)), no_buffer)


def test_many_instances_are_refused() -> None:
    nodes = [{"mesh": 0, "children": [1]}, {"mesh": 0}]
    primitive = {"attributes": {"POSITION": 0}, "indices": 1}
    many = changed(nodes=nodes, meshes=[{"primitives": [primitive] * 40_000}])

    with pytest.raises(DamagedFile, match="more than 700,000 triangles"):
        read_gltf(many, no_buffer)
