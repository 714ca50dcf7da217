"""Mesh files as MuJoCo reads them: binary STL and OBJ, not too large.

Text STL and COLLADA become binary STL, and very many triangles are simplified, all before MuJoCo
sees them. Other formats cannot be read.
"""

import posixpath
import re
from collections.abc import Collection

import numpy as np

from hexapods.domain.errors import DamagedFile
from hexapods.domain.text import counted
from hexapods.domain.types import FloatArray
from hexapods.imports.collada import read_collada
from hexapods.imports.decimation import cluster
from hexapods.imports.notes import Notes, listed, quoted
from hexapods.imports.upload import MAX_MESH_BYTES, Upload, last_part

MAX_MESHES = 300
MAX_ALL_BYTES = 96 << 20
"""Size of all meshes that a robot uses, together."""
FORMATS = (".stl", ".obj", ".dae")
_MOST_BYTES = {".dae": 16 << 20}
"""Numbers as text take several times as much memory."""
_SIMPLIFIED_ABOVE = 50_000
"""Triangles of an STL; MuJoCo reads at most 200,000."""
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


class MeshFiles:
    """The meshes that a document uses, under names of its own for MuJoCo.

    Attributes:
        assets: content by name.
        undrawn: names of bodies or links of which a mesh is missing or cannot be read.
    """

    def __init__(self, upload: Upload, document: str, notes: Notes) -> None:
        self.assets: dict[str, bytes] = {}
        self.undrawn: set[str] = set()
        self._upload, self._document, self._notes = upload, document, notes
        self._bytes = 0
        self._names: dict[tuple[str, str], str | None] = {}
        self._missing: list[str] = []
        self._unreadable: list[str] = []

    def add(self, wanted: str, scale: str = "") -> str | None:
        """Take a mesh that a document names, and return its name in `assets`.

        Args:
            wanted: path as the document has it.
            scale: by which the document scales it; the same file has a name for each.

        Returns:
            None if it is missing or of a format that cannot be read, which `tell` tells.

        Raises:
            DamagedFile: if it is damaged, or they are too many or too large.
        """
        path = self._upload.find(wanted, self._document)
        if path is None:
            self._missing.append(last_part(wanted))
            return None
        if (path, scale) not in self._names:
            self._names[path, scale] = self._take(path)
        return self._names[path, scale]

    def with_missing(self, problem: str) -> str:
        """Return why a robot is refused, with the meshes that are missing if any is."""
        missing = self._missing_sentence()
        return f"{problem}; {missing}, on which this may depend" if missing else problem

    def _missing_sentence(self) -> str:
        what = "missing from the upload (put them into a zip with the document)"
        return _sentence(self._missing, what)

    def tell(self) -> None:
        """Add notes about meshes that are missing or cannot be read."""
        unreadable = _sentence(
            self._unreadable, f"left out, since only {', '.join(FORMATS)} are read"
        )
        for sentence in (self._missing_sentence(), unreadable):
            if sentence:
                self._notes.repair("meshes", f"{sentence}; simple shapes are drawn instead")

    def _take(self, path: str) -> str | None:
        ending = posixpath.splitext(path)[1].lower()
        if ending not in FORMATS:
            self._unreadable.append(posixpath.basename(path))
            return None
        if len(self.assets) >= MAX_MESHES:
            raise DamagedFile(f"it has more than {MAX_MESHES} meshes")
        content = self._content(path, ending)
        if content is None:
            return None
        name = f"mesh{len(self.assets)}{'.obj' if ending == '.obj' else '.stl'}"
        self.assets[name] = content
        return name

    def _content(self, path: str, ending: str) -> bytes | None:
        content = self._upload.read(path, _MOST_BYTES.get(ending, MAX_MESH_BYTES))
        self._bytes += len(content)
        if self._bytes > MAX_ALL_BYTES:
            raise DamagedFile(f"its meshes have more than {MAX_ALL_BYTES:,} bytes together")
        if content.startswith(b"version https://git-lfs"):
            self._notes.repair(
                "meshes",
                f"{quoted(path)} is a pointer of Git LFS, not the mesh: `git lfs pull` gets it",
            )
            return None
        if ending == ".obj":
            return content
        if ending == ".stl":
            return _plain_stl(content, path, self._notes)
        try:
            corners = read_collada(content, posixpath.basename(path))
        except DamagedFile as error:
            self._notes.repair("meshes", f"a mesh was left out: {error}")
            return None
        return _simplified(corners, path, self._notes)


def _sentence(names: Collection[str], what: str) -> str:
    """Return how many meshes are something, with their names; empty if there are none."""
    kinds = sorted(set(names))
    if not kinds:
        return ""
    verb = "is" if len(kinds) == 1 else "are"
    return f"{counted(len(kinds), 'mesh', 'meshes')} {verb} {what}: {listed(kinds)}"


def _plain_stl(content: bytes, path: str, notes: Notes) -> bytes:
    """Return an STL in binary form, simplified if it is very large."""
    corners = _binary_corners(content)
    is_text = corners is None
    if corners is None:
        corners = _text_corners(content, path)
    if len(corners) <= _SIMPLIFIED_ABOVE and not is_text:
        return content
    return _simplified(corners, path, notes)


def _simplified(corners: FloatArray, path: str, notes: Notes) -> bytes:
    """Return triangles as binary STL, fewer if they are very many."""
    if len(corners) <= _SIMPLIFIED_ABOVE:
        return _as_stl(corners)
    if not np.isfinite(corners).all():
        raise DamagedFile(f"mesh {quoted(path)} has a number that is not finite")
    numbers = np.arange(3 * len(corners)).reshape(-1, 3)
    flat = corners.reshape(-1, 3).astype(np.float64)
    vertices, faces = cluster(flat, numbers, _SIMPLIFIED_ABOVE)
    notes.repair(
        "meshes",
        f"mesh {quoted(path)} was simplified from {len(corners):,} to {len(faces):,} triangles",
    )
    return _as_stl(vertices[faces])


def _binary_corners(content: bytes) -> FloatArray | None:
    """Return the corners of a binary STL, (triangles, 3, 3); None if it is none."""
    if len(content) < 84:
        return None
    count = int.from_bytes(content[80:84], "little")
    if len(content) < 84 + 50 * count or count == 0:
        return None
    corners: FloatArray = np.frombuffer(content, _TRIANGLE, count, 84)["corners"]
    return corners


def _text_corners(content: bytes, path: str) -> FloatArray:
    """Return the corners of a text STL, (triangles, 3, 3)."""
    if content.lstrip()[:5].lower() == b"solid":
        try:
            numbers = np.array(_VERTEX.findall(content), dtype=np.float64)
        except ValueError:
            numbers = np.empty((0, 3))
        if len(numbers) and len(numbers) % 3 == 0:
            return numbers.reshape(-1, 3, 3)
    raise DamagedFile(f"mesh {quoted(path)} is no whole STL")


def _as_stl(corners: FloatArray) -> bytes:
    triangles = np.zeros(len(corners), _TRIANGLE)
    triangles["corners"] = corners
    return bytes(80) + len(corners).to_bytes(4, "little") + triangles.tobytes()
