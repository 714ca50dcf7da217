"""Unlit meshes as files of glTF, read back by what the format says of them."""

import json
import struct
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from hexapods.drawing.glb import unlit_glb
from hexapods.drawing.shapes import Shape, strip


def read(file: NDArray[np.uint8]) -> tuple[dict[str, Any], bytes]:
    """Return the description and the binary data of a GLB."""
    data = file.tobytes()
    magic, version, size = struct.unpack_from("<4sII", data)
    assert (magic, version, size) == (b"glTF", 2, len(data))
    length, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    binary_at = 20 + length
    binary_length, binary_kind = struct.unpack_from("<I4s", data, binary_at)
    assert binary_kind == b"BIN\0"
    assert binary_at + 8 + binary_length == len(data)
    assert length % 4 == binary_length % 4 == 0
    return json.loads(data[20:binary_at]), data[binary_at + 8 :]


def array(description: dict[str, Any], binary: bytes, number: int) -> NDArray[Any]:
    """Return the values of an accessor."""
    accessor = description["accessors"][number]
    view = description["bufferViews"][accessor["bufferView"]]
    kinds = {5126: "<f4", 5121: "u1", 5123: "<u2"}
    data = binary[view["byteOffset"] :][: view["byteLength"]]
    values = np.frombuffer(data, kinds[accessor["componentType"]])
    return values.reshape(accessor["count"], -1)


def test_a_mesh_is_read_back_with_its_colours() -> None:
    shape = strip(0.4, 0.2)
    colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]], np.uint8)
    description, binary = read(unlit_glb(shape, colors))
    primitive = description["meshes"][0]["primitives"][0]
    attributes = primitive["attributes"]

    assert (array(description, binary, attributes["POSITION"]) == shape.vertices).all()
    assert (array(description, binary, primitive["indices"]).reshape(-1, 3) == shape.faces).all()
    rgba = array(description, binary, attributes["COLOR_0"])
    assert (rgba[:, :3] == colors).all()
    assert (rgba[:, 3] == 255).all()
    (material,) = description["materials"]
    assert material["alphaMode"] == "OPAQUE"
    assert "KHR_materials_unlit" in material["extensions"]
    assert description["extensionsUsed"] == ["KHR_materials_unlit"]
    bounds = description["accessors"][attributes["POSITION"]]
    assert bounds["min"] == pytest.approx([-0.2, -0.1, 0])
    assert bounds["max"] == pytest.approx([0.2, 0.1, 0])


def test_opacities_make_a_mesh_translucent() -> None:
    grey = np.array([128, 128, 128], np.uint8)
    description, binary = read(unlit_glb(strip(1, 1), grey, np.array([0, 0.5, 1, 1])))

    assert description["materials"][0]["alphaMode"] == "BLEND"
    rgba = array(description, binary, 1)
    assert rgba[:, 3].tolist() == [0, 128, 255, 255]
    assert (rgba[:, 0] < 64).all(), "a middle grey is dark in linear light"


def test_a_mesh_of_too_many_vertices_is_refused() -> None:
    count = 65_536
    shape = Shape(np.zeros((count, 3), np.float32), np.zeros((1, 3), np.uint32))
    with pytest.raises(ValueError, match="at most 65,535"):
        unlit_glb(shape, np.zeros(3, np.uint8))
