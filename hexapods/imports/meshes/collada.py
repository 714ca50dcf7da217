"""Reads the triangles of a COLLADA file (`.dae`), which MuJoCo cannot read.

Of the format it takes what robots' files have: triangles and polygons, placed by the nodes of the
scene. Materials, skins and lights are ignored, and so is the axis that points up, as in RViz.
"""

from collections.abc import Iterator

import numpy as np

from hexapods.domain.errors import DamagedFile
from hexapods.domain.types import FloatArray, IntArray
from hexapods.imports.documents.xml import Element, read_xml

_TEXTS = frozenset({"float_array", "p", "vcount", "matrix", "translate", "rotate", "scale"})
_POLYGONS = ("triangles", "polylist", "polygons")
_MAX_INSTANCES = 500
_MAX_TRIANGLES = 2_000_000


def read_collada(data: bytes, label: str) -> FloatArray:
    """Return the corners of all triangles of a scene, (n, 3, 3) [m].

    Raises:
        DamagedFile: if it is no COLLADA file with triangles.
    """
    root = read_xml(data, label, _TEXTS)
    try:
        corners = list(_placed(root))
    except (KeyError, ValueError, IndexError, OverflowError) as error:
        raise DamagedFile(f"{label} is no whole COLLADA file ({error})") from error
    together: FloatArray = np.concatenate([*corners, np.empty((0, 3, 3))])
    if len(together) == 0 or not np.isfinite(together).all():
        raise DamagedFile(f"{label} has no triangles that can be read")
    return together


def _placed(root: Element) -> Iterator[FloatArray]:
    """Iterate over the triangles of each instance of a geometry."""
    geometries = {
        geometry.attributes["id"]: _triangles(geometry)
        for geometry in root.all("geometry")
        if "id" in geometry.attributes
    }
    unit = next(root.all("unit"), None)
    meter = 1.0 if unit is None else float(unit.attributes.get("meter", 1))
    instances = list(_instances(root))
    if not instances:
        instances = [(name, np.eye(4)) for name in geometries]
    count = 0
    for name, matrix in instances:
        corners = geometries.get(name, np.empty((0, 3, 3)))
        count += len(corners)
        if count > _MAX_TRIANGLES:
            raise ValueError(f"it has more than {_MAX_TRIANGLES:,} triangles")
        yield (corners @ matrix[:3, :3].T + matrix[:3, 3]) * meter


def _instances(root: Element) -> Iterator[tuple[str, FloatArray]]:
    """Iterate over the geometries of the first scene with their places."""
    scene = next(root.all("visual_scene"), None)
    waiting = [(scene, np.eye(4))] if scene is not None else []
    count = 0
    while waiting:
        node, above = waiting.pop()
        matrix = above @ _transform(node) if node.tag == "node" else above
        for child in node:
            if child.tag == "node":
                waiting.append((child, matrix))
            elif child.tag == "instance_geometry":
                count += 1
                if count > _MAX_INSTANCES:
                    raise ValueError(f"it has more than {_MAX_INSTANCES} parts")
                yield child.attributes.get("url", "").removeprefix("#"), matrix


def _transform(node: Element) -> FloatArray:
    """Return the transform of a node, (4, 4): the product of its parts in their order."""
    total = np.eye(4)
    for child in node:
        if child.tag not in _TEXTS:
            continue
        numbers, factor = _numbers(child), np.eye(4)
        if child.tag == "matrix":
            factor = numbers.reshape(4, 4)
        elif child.tag == "translate":
            factor[:3, 3] = numbers
        elif child.tag == "scale":
            factor[:3, :3] = np.diag(numbers)
        elif child.tag == "rotate":
            x, y, z = numbers[:3] / max(float(np.linalg.norm(numbers[:3])), 1e-12)
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            angle = np.radians(numbers[3])
            factor[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        total = total @ factor
    return total


def _triangles(geometry: Element) -> FloatArray:
    """Return the corners of a geometry's triangles, (n, 3, 3)."""
    sources = {f"#{source.attributes['id']}": source for source in geometry.all("source")}
    places = {
        f"#{vertices.attributes['id']}": _input(vertices, "POSITION")
        for vertices in geometry.all("vertices")
    }
    triangles = [np.empty((0, 3, 3))]
    for polygons in geometry.all(*_POLYGONS):
        vertices = _positions(sources[places[_input(polygons, "VERTEX")]])
        corners = _corners(polygons)
        if len(corners) and (corners.min() < 0 or corners.max() >= len(vertices)):
            raise ValueError("a corner has a vertex that does not exist")
        triangles.append(vertices[corners])
    return np.concatenate(triangles)


def _positions(source: Element) -> FloatArray:
    """Return the vertices of a source, (n, 3)."""
    array = next(source.all("float_array"))
    accessor = next(source.all("accessor"), None)
    stride = 3 if accessor is None else int(accessor.attributes.get("stride", 3))
    if not 3 <= stride <= 16:
        raise ValueError("its vertices have no three coordinates")
    numbers = _numbers(array)
    return numbers[: len(numbers) // stride * stride].reshape(-1, stride)[:, :3]


def _corners(polygons: Element) -> IntArray:
    """Return the vertices of triangles, (n, 3); polygons are cut like fans."""
    offsets = [int(child.attributes.get("offset", 0)) for child in polygons if child.tag == "input"]
    offset, stride = int(_input_element(polygons, "VERTEX").attributes["offset"]), max(offsets) + 1
    if not 0 <= offset < stride <= 32:
        raise ValueError("its corners have no order")
    lists = [
        _numbers(child).astype(np.int64)[offset::stride] for child in polygons if child.tag == "p"
    ]
    if not lists:
        return np.empty((0, 3), dtype=np.int64)
    if polygons.tag == "triangles":
        flat = np.concatenate(lists)
        return flat[: len(flat) // 3 * 3].reshape(-1, 3)
    counts = next((child for child in polygons if child.tag == "vcount"), None)
    if counts is None:
        sizes = np.array([len(child) for child in lists])
    else:
        sizes = _numbers(counts).astype(np.int64)
    flat = np.concatenate(lists)
    if sizes.min(initial=3) < 0 or sizes.sum() > len(flat):
        raise ValueError("its polygons have more corners than there are")
    return cut_polygons(flat, sizes)


def cut_polygons(flat: IntArray, sizes: IntArray) -> IntArray:
    """Cut polygons into triangles that share the first corner.

    Args:
        flat: corners of all polygons in a row, (n,).
        sizes: number of corners of each, (m,).

    Returns:
        corners of triangles, (k, 3).
    """
    starts = np.cumsum(sizes) - sizes
    inner = np.maximum(sizes - 2, 0).astype(np.intp)
    first = np.repeat(starts, inner)
    number = np.arange(inner.sum()) - np.repeat(np.cumsum(inner) - inner, inner)
    places = np.stack([first, first + number + 1, first + number + 2], axis=1)
    triangles: IntArray = flat[places]
    return triangles


def _input(element: Element, semantic: str) -> str:
    return _input_element(element, semantic).attributes["source"]


def _input_element(element: Element, semantic: str) -> Element:
    for child in element:
        if child.tag == "input" and child.attributes.get("semantic") == semantic:
            return child
    raise KeyError(semantic)


def _numbers(element: Element) -> FloatArray:
    numbers: FloatArray = np.array(element.text.split(), dtype=np.float64)
    return numbers
