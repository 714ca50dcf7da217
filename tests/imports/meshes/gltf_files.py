"""Writes glTF of triangles, as JSON or binary, for the tests."""

import base64
import json
import struct
from typing import Any

import numpy as np


def document(triangles: np.ndarray, uri: str | None = None) -> tuple[dict[str, Any], bytes]:
    """Return the JSON of a glTF and its buffer: one mesh of triangles, (n, 3, 3), with indices."""
    vertices = triangles.reshape(-1, 3).astype("<f4").tobytes()
    indices = np.arange(3 * len(triangles)).astype("<u2").tobytes()
    buffer = {"byteLength": len(vertices) + len(indices)}
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1]}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3 * len(triangles), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(vertices)},
            {"buffer": 0, "byteOffset": len(vertices), "byteLength": len(indices)},
        ],
        "buffers": [buffer if uri is None else {**buffer, "uri": uri}],
    }, vertices + indices


def gltf(triangles: np.ndarray) -> bytes:
    """Return a glTF whose buffer is within."""
    _, buffer = document(triangles)
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    return json.dumps(document(triangles, uri)[0]).encode()


def glb(parts: tuple[dict[str, Any], bytes]) -> bytes:
    """Return a binary glTF of a document and a buffer."""
    text = json.dumps(parts[0]).encode()
    text += b" " * (-len(text) % 4)
    buffer = parts[1] + bytes(-len(parts[1]) % 4)
    chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<2I", len(buffer), 0x004E4942) + buffer
    return struct.pack("<4s2I", b"glTF", 2, 12 + len(chunks)) + chunks
