"""Mesh files as MuJoCo reads them: binary STL and OBJ, together not too many triangles.

Text STL, COLLADA and glTF become binary STL. A mesh that cannot be read is left out. MuJoCo takes
more than a kilobyte for each triangle, so that many meshes are simplified as they are read.
"""

import posixpath
from collections.abc import Collection, Iterable, Sequence

import numpy as np

from hexapods.domain.errors import DamagedFile
from hexapods.domain.text import counted
from hexapods.domain.types import FloatArray, IntArray
from hexapods.imports.documents.upload import MAX_MESH_BYTES, Upload, last_part
from hexapods.imports.meshes.collada import read_collada
from hexapods.imports.meshes.decimation import cluster
from hexapods.imports.meshes.gltf import read_gltf
from hexapods.imports.meshes.obj import read_obj, write_obj
from hexapods.imports.meshes.stl import TRIANGLE_BYTES, read_stl, write_stl
from hexapods.imports.notes import Notes, listed, quoted

MAX_MESHES = 300
MAX_ALL_BYTES = 96 << 20
"""Size of all meshes that a robot uses, together."""
FORMATS = (".stl", ".obj", ".dae", ".gltf", ".glb")
_MOST_BYTES = {".dae": 16 << 20, ".gltf": 16 << 20}
"""Numbers as text take several times as much memory."""
_SIMPLIFIED_ABOVE = 50_000
"""Triangles of one mesh, unless it is OBJ."""
MAX_TRIANGLES, _FEWER_TRIANGLES = 320_000, 125_000
"""Triangles of all meshes together; of more meshes so many are left, and at most twice as many."""
_MAX_COORDINATE = 1e9
_LEAST_VERTICES = 4
_MAX_LISTED = 3
_Surface = tuple[FloatArray, IntArray]
"""Vertices, (n, 3), and faces, (m, 3)."""


class MeshFiles:
    """The meshes that a document uses, under names of its own for MuJoCo.

    Attributes:
        assets: content by name.
        sides: longest side of each mesh in the unit of its file, by name.
        undrawn: names of bodies or links of which a mesh is missing or cannot be read.
    """

    def __init__(self, upload: Upload, document: str, notes: Notes) -> None:
        self.assets: dict[str, bytes] = {}
        self.sides: dict[str, float] = {}
        self.undrawn: set[str] = set()
        self._upload, self._document, self._notes = upload, document, notes
        self._bytes = 0
        self._found: dict[str, str | None] = {}
        self._names: dict[tuple[str, str], str | None] = {}
        self._paths: dict[str, str] = {}
        self._triangles: dict[str, int] = {}
        self._before: dict[str, int] = {}
        self._copies: dict[str, int] = {}
        self._most, self._most_together = _SIMPLIFIED_ABOVE, MAX_TRIANGLES
        self._most_of_binary = _SIMPLIFIED_ABOVE
        self._missing: list[str] = []
        self._other_formats: list[str] = []
        self._damaged: list[str] = []
        self._cut: list[str] = []

    def expect(self, wanted: Iterable[str]) -> None:
        """Find out by their sizes whether the meshes that will be added are far too large.

        Then they are simplified at once, and not each by itself first, which would take too long.

        Args:
            wanted: paths as the document has them.
        """
        paths = {path for path in map(self._find, wanted) if path is not None}
        counts = [
            (self._upload.size(path) // TRIANGLE_BYTES, 1)
            for path in paths
            if path.lower().endswith(".stl")
        ]
        together = sum(min(count, _SIMPLIFIED_ABOVE) for count, _ in counts)  # whole numbers
        if together > 2 * MAX_TRIANGLES:
            self._most_of_binary = min(_level(counts, _FEWER_TRIANGLES), _SIMPLIFIED_ABOVE)

    def add(self, wanted: str, scale: str = "", *, is_copied: bool = False) -> str | None:
        """Take a mesh that a document names, and return its name in `assets`.

        Args:
            wanted: path as the document has it.
            scale: by which the document scales it; the same file has a name for each.
            is_copied: whether MuJoCo reads the file once more for each time it is named.

        Returns:
            None if it is missing or cannot be read, which `tell` tells.

        Raises:
            DamagedFile: if they are too many or too large.
        """
        path = self._find(wanted)
        if path is None:
            self._missing.append(last_part(wanted))
            return None
        if (path, scale) not in self._names:
            self._names[path, scale] = self._take(path)
        name = self._names[path, scale]
        if name is not None and is_copied:
            self._copies[name] = self._copies.get(name, 0) + 1
            self._fit()
        return name

    def drop(self, name: str, why: str) -> None:
        """Count a mesh that MuJoCo cannot read as left out."""
        path = self._paths.get(name, name)
        self._damaged.append(f"{quoted(posixpath.basename(path))} ({why})")

    def simplify(self) -> bool:
        """Simplify all meshes since the memory is not enough; False if that would not help."""
        if self._together() <= _FEWER_TRIANGLES:
            return False
        self._most_together = _FEWER_TRIANGLES
        self._fit()
        return True

    def with_missing(self, problem: str) -> str:
        """Return why a robot is refused, with the meshes that are missing if any is."""
        missing = self._missing_sentence()
        return f"{problem}; {missing}, on which this may depend" if missing else problem

    def tell(self, parts: Collection[str]) -> None:
        """Add notes about meshes that were left out or changed.

        Args:
            parts: names of bodies of which one was left out.
        """
        formats = f"left out, since only {', '.join(FORMATS)} are read"
        for sentence in (
            self._missing_sentence(),
            _sentence(self._other_formats, formats),
            _sentence(self._damaged, "left out as damaged"),
        ):
            if sentence:
                self._notes.repair(
                    "meshes", f"{sentence}; simple shapes are drawn instead", parts=sorted(parts)
                )
        if self._cut:
            self._notes.repair(
                "meshes", f"bytes after the last triangle were ignored in: {listed(self._cut)}"
            )
        self._tell_of_simplified()

    def _find(self, wanted: str) -> str | None:
        if wanted not in self._found:
            self._found[wanted] = self._upload.find(wanted, self._document)
        return self._found[wanted]

    def _missing_sentence(self) -> str:
        what = "missing from the upload (put them into a zip with the document)"
        return _sentence(self._missing, what)

    def _tell_of_simplified(self) -> None:
        names = [name for name, count in self._before.items() if self._triangles[name] < count]
        if len(names) <= _MAX_LISTED:
            for name in names:
                self._notes.repair(
                    "meshes",
                    f"mesh {quoted(self._paths[name])} was simplified from "
                    f"{self._before[name]:,} to {self._triangles[name]:,} triangles",
                )
        else:
            before = sum(self._before[name] for name in names)  # whole numbers
            after = sum(self._triangles[name] for name in names)  # whole numbers
            self._notes.repair(
                "meshes",
                f"{len(names)} meshes were simplified from {before:,} to "
                f"{after:,} triangles together, since more "
                "would not fit into the memory",
            )

    def _take(self, path: str) -> str | None:
        ending = posixpath.splitext(path)[1].lower()
        if ending not in FORMATS:
            self._other_formats.append(posixpath.basename(path))
            return None
        if len(self.assets) >= MAX_MESHES:
            raise DamagedFile(f"it has more than {MAX_MESHES} meshes")
        name = f"mesh{len(self.assets)}{'.obj' if ending == '.obj' else '.stl'}"
        try:
            self._read(name, path, ending)
        except DamagedFile as error:
            if self._bytes > MAX_ALL_BYTES:
                raise
            self._damaged.append(f"{quoted(posixpath.basename(path))} ({error})")
            return None
        self._fit()
        return name

    def _content(self, path: str, most_bytes: int) -> bytes:
        content = self._upload.read(path, most_bytes)
        self._bytes += len(content)
        if self._bytes > MAX_ALL_BYTES:
            raise DamagedFile(f"its meshes have more than {MAX_ALL_BYTES:,} bytes together")
        return content

    def _buffer(self, uri: str, path: str) -> bytes:
        """Return a file that a mesh names, from the zip."""
        buffer = self._upload.find(uri, path)
        if buffer is None:
            raise DamagedFile(f"its buffer {quoted(last_part(uri))} is missing from the upload")
        return self._content(buffer, MAX_MESH_BYTES)

    def _read(self, name: str, path: str, ending: str) -> None:
        """Read a mesh, and keep it in a form that MuJoCo reads.

        Raises:
            DamagedFile: if it cannot be read, or has no surface.
        """
        content = self._content(path, _MOST_BYTES.get(ending, MAX_MESH_BYTES))
        _check_content(content)
        is_plain = True
        if ending == ".obj":
            surface = read_obj(content)
        elif ending == ".stl":
            corners, is_plain = read_stl(content)
            surface = _separate(corners)
            if not is_plain and corners.base is not None and corners.dtype == np.float32:
                self._cut.append(posixpath.basename(path))
        elif ending == ".dae":
            surface, is_plain = _separate(read_collada(content, "it")), False
        else:
            corners = read_gltf(content, lambda uri: self._buffer(uri, path))
            surface, is_plain = _separate(corners), False
        self.sides[name] = _checked_side(surface)
        self._paths[name] = path
        self._triangles[name] = self._before[name] = len(surface[1])
        self.assets[name] = content if is_plain else _written(name, surface)
        if ending != ".obj" or self._most < _SIMPLIFIED_ABOVE:
            is_binary = ending == ".stl" and is_plain
            self._simplify(name, surface, self._most_of_binary if is_binary else self._most)

    def _together(self) -> int:
        """Return how many triangles MuJoCo is to read."""
        counts = [n * max(self._copies.get(name, 1), 1) for name, n in self._triangles.items()]
        return sum(counts)  # whole numbers

    def _fit(self) -> None:
        """Simplify the largest meshes if all together have too many triangles."""
        if self._together() <= self._most_together:
            return
        weights = [(n, max(self._copies.get(name, 1), 1)) for name, n in self._triangles.items()]
        self._most = self._most_of_binary = _level(weights, _FEWER_TRIANGLES)
        self._most_together = 2 * _FEWER_TRIANGLES
        for name, count in self._triangles.items():
            if count > self._most:
                content = self.assets[name]
                is_obj = name.endswith(".obj")
                surface = read_obj(content) if is_obj else _separate(read_stl(content)[0])
                self._simplify(name, surface, self._most)

    def _simplify(self, name: str, surface: _Surface, most: int) -> None:
        """Keep a mesh with at most so many triangles."""
        vertices, faces = surface
        if len(faces) <= most:
            return
        vertices, faces = cluster(vertices.astype(np.float64), faces, most)
        self._triangles[name] = len(faces)
        self.assets[name] = _written(name, (vertices, faces))


def _sentence(names: Collection[str], what: str) -> str:
    """Return how many meshes are something, with their names; empty if there are none."""
    kinds = sorted(set(names))
    if not kinds:
        return ""
    verb = "is" if len(kinds) == 1 else "are"
    return f"{counted(len(kinds), 'mesh', 'meshes')} {verb} {what}: {listed(kinds)}"


def _check_content(content: bytes) -> None:
    """Check that a file is no other that goes by the name of a mesh.

    Raises:
        DamagedFile: saying what it is.
    """
    begin = content[:200].lstrip().lower()
    if not begin:
        raise DamagedFile("it is empty")
    if begin.startswith(b"version https://git-lfs"):
        raise DamagedFile("it is a pointer of Git LFS, not the mesh: `git lfs pull` gets it")
    if begin.startswith((b"<!doctype html", b"<html")):
        raise DamagedFile("it is a web page, not the mesh: download the file itself")


def _separate(corners: FloatArray) -> _Surface:
    """Return triangles, (n, 3, 3), as vertices and faces."""
    return corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)


def _written(name: str, surface: _Surface) -> bytes:
    """Return a surface in the format that its name says."""
    vertices, faces = surface
    return write_obj(vertices, faces) if name.endswith(".obj") else write_stl(vertices[faces])


def _checked_side(surface: _Surface) -> float:
    """Return the longest side of the box around a surface.

    Raises:
        DamagedFile: if it is none.
    """
    vertices, faces = surface
    if len(faces) == 0:
        raise DamagedFile("it has no triangles")
    columns = np.ascontiguousarray(vertices.T)
    low, high = columns.min(axis=1), columns.max(axis=1)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise DamagedFile("it has a number that is not finite")
    if max(float(np.abs(low).max()), float(np.abs(high).max())) > _MAX_COORDINATE:
        raise DamagedFile("it has a vertex that is absurdly far away")
    few = 3 * _LEAST_VERTICES
    if len(np.unique(vertices[:few], axis=0)) < _LEAST_VERTICES and (
        len(vertices) <= few or len(np.unique(vertices, axis=0)) < _LEAST_VERTICES
    ):
        raise DamagedFile("it has fewer than four vertices")
    return float((high - low).max())


def _level(weights: Sequence[tuple[int, int]], together: int) -> int:
    """Return how many each may have at most, so that all have not more than some number together.

    Args:
        weights: for each how many it has, and how often that counts.
        together: how many all may have.
    """
    left, copies = together, sum(times for _, times in weights)  # whole numbers
    for count, times in sorted(weights):
        if count * copies >= left:
            return max(left // copies, 1)
        left -= count * times
        copies -= times
    return together
