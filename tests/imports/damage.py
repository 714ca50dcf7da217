"""Damages files at random, as disks, networks and editors do, and as who means harm does."""

import io
import json
import re
import zipfile
from collections.abc import Callable, Iterator

import numpy as np

from hexapods.imports.meshes.obj import write_obj
from tests.imports.meshes.collada_files import dae
from tests.imports.meshes.gltf_files import document, glb, gltf
from tests.imports.robots import HOME, box_triangles, bug, dog, stl, text_stl, zipped
from tests.imports.robots_in_parts import in_parts, in_xacro

_NUMBERS = ("nan", "inf", "-0", "0", "-1", "1e308", "-1e308", "1e-308", "1e9", "99999999999")
_NAMES = ("FL_hip_joint", "trunk", "../../etc/passwd", "package://a/b.stl", "x", "")
_KINDS = ("true", "false", "mesh", "plane", "free", "ball", "hinge", "slide")
_WORDS = (*_NUMBERS, *_NAMES, *_KINDS)
_ATTRIBUTE = re.compile(rb'([\w:]+)="([^"]*)"')
_NUMBER = re.compile(rb"-?\d+\.?\d*(?:e-?\d+)?")
_ELEMENT = re.compile(rb"<(\w+)[^<>]*/>")
Damage = Callable[[bytes, np.random.Generator], bytes]


def originals() -> list[bytes]:
    """Return the files that are damaged: MJCF, URDF, and zips with meshes, includes and xacro."""
    mesh = '<visual><geometry><mesh filename="package://bug/meshes/hull.stl"/></geometry></visual>'
    asset = '<asset><mesh name="hull" file="hull.stl" scale="0.1 0.1 0.1"/></asset>'
    drawn = '<geom type="mesh" mesh="hull" contype="0" conaffinity="0"/>'
    hull = stl(box_triangles((0.4, 0.2, 0.1), cells=3))
    return [
        dog(keyframes={"home": HOME}).encode(),
        bug().encode(),
        zipped({"bug/urdf/bug.urdf": bug(torso=mesh), "bug/meshes/hull.stl": hull}),
        zipped({"dog.xml": dog(sections=asset, on_torso=drawn), "hull.stl": hull}),
        zipped(in_parts()),
        zipped(in_xacro()),
        *(zipped({"bug.urdf": bug(torso=_drawn(next(iter(mesh)))), **mesh}) for mesh in _meshes()),
    ]


def _meshes() -> Iterator[dict[str, bytes]]:
    """Iterate over meshes as text and in the other formats; the first file names the others."""
    triangles = box_triangles((0.4, 0.2, 0.1), cells=3)
    yield {"hull.stl": text_stl(triangles)}
    yield {"hull.obj": write_obj(triangles.reshape(-1, 3), np.arange(162).reshape(-1, 3))}
    yield {"hull.dae": dae()}
    yield {"hull.glb": glb(document(triangles))}
    yield {"hull.gltf": gltf(triangles)}
    text, buffer = document(triangles, "hull.bin")
    yield {"hull.gltf": json.dumps(text).encode(), "hull.bin": buffer}


def _drawn(file: str) -> str:
    return f'<visual><geometry><mesh filename="{file}"/></geometry></visual>'


def flip_bits(data: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for at in rng.integers(0, len(data), rng.integers(1, 9)):
        changed[at] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def cut_off(data: bytes, rng: np.random.Generator) -> bytes:
    return data[: int(rng.integers(0, len(data)))]


def cut_out(data: bytes, rng: np.random.Generator) -> bytes:
    start, end = sorted(int(at) for at in rng.integers(0, len(data), 2))
    return data[:start] + data[end:]


def repeat(data: bytes, rng: np.random.Generator) -> bytes:
    start = int(rng.integers(0, len(data)))
    end = min(len(data), start + int(rng.integers(1, 2000)))
    return data[:end] + data[start:end] * int(rng.integers(1, 20)) + data[end:]


def change_attributes(data: bytes, rng: np.random.Generator) -> bytes:
    return _replaced(_ATTRIBUTE, data, rng, lambda match, word: match[1] + b'="' + word + b'"')


def change_numbers(data: bytes, rng: np.random.Generator) -> bytes:
    return _replaced(_NUMBER, data, rng, lambda _, word: word)


def swap_attributes(data: bytes, rng: np.random.Generator) -> bytes:
    matches = list(_ATTRIBUTE.finditer(data))
    if len(matches) < 2:
        return data
    first, second = sorted(rng.choice(len(matches), 2, replace=False).tolist())
    earlier, later = matches[first], matches[second]
    between = data[earlier.end(2) : later.start(2)]
    swapped: bytes = (
        data[: earlier.start(2)] + later[2] + between + earlier[2] + data[later.end(2) :]
    )
    return swapped


def delete_elements(data: bytes, rng: np.random.Generator) -> bytes:
    return _replaced(_ELEMENT, data, rng, lambda _, __: b"")


def double_elements(data: bytes, rng: np.random.Generator) -> bytes:
    return _replaced(_ELEMENT, data, rng, lambda match, _: match[0] * 2)


def rename_elements(data: bytes, rng: np.random.Generator) -> bytes:
    tags = [match[1] for match in _ELEMENT.finditer(data)]
    other = tags[int(rng.integers(len(tags)))] if tags else b"geom"
    return _replaced(_ELEMENT, data, rng, lambda match, _: match[0].replace(match[1], other, 1))


def _replaced(
    pattern: re.Pattern[bytes],
    data: bytes,
    rng: np.random.Generator,
    by: Callable[[re.Match[bytes], bytes], bytes],
) -> bytes:
    """Replace one to four matches."""
    matches = list(pattern.finditer(data))
    if not matches:
        return data
    chosen = rng.choice(len(matches), min(len(matches), int(rng.integers(1, 5))), replace=False)
    for number in sorted(chosen.tolist(), reverse=True):
        match = matches[number]
        word = _WORDS[int(rng.integers(len(_WORDS)))].encode()
        data = data[: match.start()] + by(match, word) + data[match.end() :]
    return data


IN_TEXT: tuple[Damage, ...] = (
    change_attributes,
    change_numbers,
    swap_attributes,
    delete_elements,
    double_elements,
    rename_elements,
)
ANYWHERE: tuple[Damage, ...] = (flip_bits, cut_off, cut_out, repeat)


def damaged(count: int, rng: np.random.Generator) -> list[tuple[str, bytes]]:
    """Return damaged files, and what was done to each."""
    files = originals()
    files_with_damage = []
    for number in range(count):
        original = files[number % len(files)]
        is_text = original.startswith(b"<")
        # Most damage to a zip itself makes it unreadable, whatever is in it.
        kinds = (*IN_TEXT, *ANYWHERE) if is_text else (*ANYWHERE, *[_inside] * 6)
        damage = kinds[int(rng.integers(len(kinds)))]
        files_with_damage.append(
            (f"{damage.__name__} of file {number % len(files)}", damage(original, rng))
        )
    return files_with_damage


def _inside(data: bytes, rng: np.random.Generator) -> bytes:
    """Damage a member of a zip, so that the zip itself stays whole."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    names = list(members)
    meshes = [name for name in names if not name.endswith((".xml", ".urdf", ".xacro"))]
    name = str(rng.choice([*names, *meshes]))
    is_text = members[name].startswith((b"<", b"{", b"v ", b"solid"))
    kinds = (*IN_TEXT, *ANYWHERE) if is_text else ANYWHERE
    members[name] = kinds[int(rng.integers(len(kinds)))](members[name], rng)
    return zipped(members)
