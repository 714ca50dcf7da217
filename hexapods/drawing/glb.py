"""Unlit meshes with colours and opacities of their vertices, which viser's own meshes do not have.

They are files of glTF 2.0 in one piece (GLB); viser's client draws them as they are, with z up.
"""

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.drawing.shapes import Shape
from hexapods.drawing.viser_internals.client import batch_colors

_HEADER = struct.Struct("<4sII")
_CHUNK = struct.Struct("<I4s")
_VERSION = 2
_FLOAT, _UNSIGNED_BYTE, _UNSIGNED_SHORT = 5126, 5121, 5123
_VERTICES, _INDICES = 34962, 34963
_ALIGNMENT = 4


def unlit_glb(
    shape: Shape, colors: NDArray[np.uint8], opacities: NDArray[np.floating[Any]] | None = None
) -> NDArray[np.uint8]:
    """Return a mesh whose colours are not shaded by the lights.

    Args:
        shape: the mesh, of fewer than 65,536 vertices.
        colors: of each vertex, or one of all, sRGB, (v, 3) or (3,), 0–255.
        opacities: of each vertex, (v,), 0–1; opaque without them.

    Returns:
        the bytes of the file, (n,).

    Raises:
        ValueError: if there are too many vertices.
    """
    count = len(shape.vertices)
    if count > np.iinfo(np.uint16).max:
        raise ValueError(f"{count} vertices; an unlit mesh has at most 65,535")
    alphas = np.ones(count) if opacities is None else opacities
    rgba = np.empty((count, 4), np.uint8)
    rgba[:, :3] = batch_colors(np.broadcast_to(colors, (count, 3)))  # glTF's are linear too
    rgba[:, 3] = np.rint(255 * alphas)
    arrays = [
        (shape.vertices.astype("<f4"), _FLOAT, "VEC3", _VERTICES),
        (rgba, _UNSIGNED_BYTE, "VEC4", _VERTICES),
        (shape.faces.astype("<u2").ravel(), _UNSIGNED_SHORT, "SCALAR", _INDICES),
    ]
    views, accessors, binary = [], [], b""
    for number, (array, component, kind, target) in enumerate(arrays):
        data = array.tobytes()
        views.append(
            {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), "target": target}
        )
        accessors.append(
            {"bufferView": number, "componentType": component, "count": len(array), "type": kind}
        )
        binary += data + bytes(-len(data) % _ALIGNMENT)
    accessors[0]["min"], accessors[0]["max"] = (
        edge.tolist() for edge in (shape.vertices.min(axis=0), shape.vertices.max(axis=0))
    )
    accessors[1]["normalized"] = True
    description = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}
                ]
            }
        ],
        "materials": [
            {
                "alphaMode": "OPAQUE" if opacities is None else "BLEND",
                "extensions": {"KHR_materials_unlit": {}},
            }
        ],
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    text = json.dumps(description, separators=(",", ":")).encode()
    text += b" " * (-len(text) % _ALIGNMENT)
    chunks = _CHUNK.pack(len(text), b"JSON") + text + _CHUNK.pack(len(binary), b"BIN\0") + binary
    file = _HEADER.pack(b"glTF", _VERSION, _HEADER.size + len(chunks)) + chunks
    return np.frombuffer(file, np.uint8)
