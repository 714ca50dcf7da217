"""The uploaded file: one document, or a zip whose members are read only when they are needed.

Nothing is written to disk. A zip is judged by its directory: by numbers and sizes, before a byte of
it is unpacked; and no member unpacks to more than its directory says. Limits count the members that
could be read: documents and meshes.
"""

import io
import posixpath
import re
import stat
import struct
import unicodedata
import zipfile
import zlib
from collections.abc import Iterable, Sequence
from urllib.parse import unquote

from hexapods.domain.errors import DamagedFile
from hexapods.imports.notes import quoted

DOCUMENTS = (".urdf", ".xml", ".mjcf", ".xacro")
"""Endings of files that may describe a robot."""
MESHES = (".stl", ".obj", ".dae", ".gltf", ".glb", ".bin", ".ply", ".msh", ".3ds")
"""Endings of files that may be meshes; most of them are read."""

MAX_UPLOAD_BYTES = 64 << 20
MAX_DOCUMENT_BYTES = 4 << 20
"""Size of one XML document."""
MAX_MEMBERS = 2000
"""Documents and meshes in a zip."""
MAX_UNPACKED_BYTES = 192 << 20
"""Size of all documents and meshes in a zip together."""
MAX_MESH_BYTES = 32 << 20
"""Size of one mesh file."""
_MAX_ENTRIES = 10_000
"""Members of a zip of any kind."""
_MAX_DIRECTORY_BYTES = 2 << 20
_MAX_LINK_BYTES = 1000
_ENCRYPTED, _UTF_8 = 0x1, 0x800
"""Bits of a member's flags."""
_START_BYTES = 300
_MAX_PACKAGE_BYTES = 64 << 10
_END = struct.Struct("<4s4H2LH")  # end of central directory record, without a comment
_SCHEME = re.compile(r"([a-zA-Z][\w+.-]+):/+")
_PACKAGE_NAME = re.compile(rb"<name>\s*([\w.-]{1,200})\s*</name>")


def last_part(path: str) -> str:
    """Return the last part of a path with slashes or backslashes."""
    return path.replace("\\", "/").rstrip("/").rpartition("/")[2]


def plain_name(name: str) -> str:
    """Return a name without regard to case, and to how accents are composed."""
    return unicodedata.normalize("NFC", name).casefold()


class Upload:
    """The files of an upload by path; a single document is one file.

    Attributes:
        name: of the uploaded file.
        is_zip: whether it is a zip.
        paths: of all files.
        outside: paths of members that were left out, since they lead out of the zip.

    Raises:
        DamagedFile: if it is empty, too large, or a zip that claims too much or is damaged.
    """

    def __init__(self, data: bytes, file_name: str) -> None:
        if not data:
            raise DamagedFile("the file is empty; give an MJCF or URDF file, or a zip with one")
        if len(data) > MAX_UPLOAD_BYTES:
            raise DamagedFile(
                f"the file has {len(data):,} bytes; a robot has at most {MAX_UPLOAD_BYTES:,}"
            )
        self.is_zip = data.startswith((b"PK\3\4", b"PK\5\6"))
        self._data, self._members = data, dict[str, zipfile.ZipInfo]()
        self._links: dict[str, zipfile.ZipInfo] = {}
        self.name = last_part(file_name) or "robot.xml"
        self.outside: list[str] = []
        if self.is_zip:
            self._zip = _open(data)
            for info in _checked(self._zip.infolist(), len(data)):
                self._add(info)
            self.paths: Sequence[str] = list(self._members)
        else:
            self.paths = [self.name]
        self._by_name: dict[str, list[str]] = {}
        for path in [*self._members, *self._links]:
            self._by_name.setdefault(plain_name(posixpath.basename(path)), []).append(path)
        self._packages: dict[str, str] | None = None

    def _add(self, info: zipfile.ZipInfo) -> None:
        path = _name_of(info).replace("\\", "/")
        if "\0" in path or path.startswith("/") or ".." in path.split("/") or ":" in path[:3]:
            self.outside.append(path)
            return
        if info.is_dir():
            return
        kind, name = stat.S_IFMT(info.external_attr >> 16), posixpath.normpath(path)
        if name in self._members or name in self._links:
            if name.lower().endswith((*DOCUMENTS, *MESHES)):
                raise DamagedFile(f"the zip has {quoted(path)} twice")
            return
        if info.flag_bits & _ENCRYPTED and name.lower().endswith((*DOCUMENTS, *MESHES)):
            raise DamagedFile(f"in the zip {quoted(path)} is encrypted; give it without a password")
        if kind == stat.S_IFLNK:
            self._links[name] = info
        elif kind in (0, stat.S_IFREG):
            self._members[name] = info

    @property
    def documents(self) -> list[str]:
        """Paths of the files that may describe a robot."""
        if not self.is_zip:
            return [*self.paths]
        return [path for path in self.paths if path.lower().endswith(DOCUMENTS)]

    def size(self, path: str) -> int:
        """Return the size of a file as the zip's directory says."""
        return self._members[path].file_size if self.is_zip else len(self._data)

    @property
    def start(self) -> bytes:
        """The first bytes of the upload itself."""
        return self._data[:_START_BYTES]

    def read(self, path: str, most_bytes: int) -> bytes:
        """Return a file's content.

        Raises:
            DamagedFile: if it is larger, or cannot be unpacked.
        """
        size = self.size(path)
        if size > most_bytes:
            raise DamagedFile(f"{quoted(path)} has {size:,} bytes; at most {most_bytes:,} are read")
        return self._data if not self.is_zip else self._unpacked(self._members[path], path)

    def _unpacked(self, info: zipfile.ZipInfo, path: str) -> bytes:
        size = info.file_size
        try:
            with self._zip.open(info) as member:
                content = member.read(size + 1)
        except (
            zipfile.BadZipFile,
            zlib.error,
            EOFError,
            NotImplementedError,
            RuntimeError,
            ValueError,
            OSError,
            struct.error,
        ) as error:
            raise DamagedFile(f"{quoted(path)} in the zip is damaged: {error}") from error
        if len(content) != size:
            raise DamagedFile(f"{quoted(path)} in the zip is not as large as the zip says")
        return content

    def find(self, wanted: str, document_path: str) -> str | None:
        r"""Return the path of the file that a document means.

        Where a file lies on the disk of the one who wrote the document does not matter: it is found
        by the end of its path.

        Args:
            wanted: path as the document has it, such as `../meshes/hip.stl`, `C:\robot\hip.stl`,
                or `package://robot/meshes/hip.stl`.
            document_path: path of the document.

        Returns:
            the file at that path beside the document, or the one whose path ends with the most of
            the same parts, if none with other case, or without `%20` and the like; None if none
            has its name.
        """
        plain = wanted.strip().replace("\\", "/")
        if scheme := _SCHEME.match(plain):
            rest = plain[scheme.end() :]
            if scheme[1].lower() in ("http", "https"):
                rest = re.split(r"[?#]", rest, maxsplit=1)[0]
            parts = self._in_package(rest) if scheme[1].lower() == "package" else rest.split("/")
        else:
            if path := self.beside(wanted, document_path):
                return path
            folder = posixpath.dirname(document_path)
            parts = posixpath.normpath(posixpath.join(folder, plain)).split("/")
        parts = [name for name in parts if name not in ("", ".", "..")]
        decoded = unquote("/".join(parts)).split("/")
        for ignores_case in (False, True):
            for names in (parts, decoded):
                if path_found := self._longest_match(names, ignores_case):
                    return self._target(path_found)
        return None

    def beside(self, wanted: str, document_path: str) -> str | None:
        """Return the path of the file at a path beside a document; None if there is none."""
        folder = posixpath.dirname(document_path)
        path = posixpath.normpath(posixpath.join(folder, wanted.strip().replace("\\", "/")))
        return path if path in self._members else None

    def package_folder(self, name: str) -> str:
        """Return the path of the folder of a ROS package; if it is not in the zip, its name.

        It is the folder with a `package.xml` of that name, else the one of that name nearest to the
        top.
        """
        if self._packages is None:
            self._packages = self._read_packages()
        if name in self._packages:
            return self._packages[name]
        folders = [path.split("/")[:-1] for path in self._members]
        above = ["/".join(parts[: parts.index(name) + 1]) for parts in folders if name in parts]
        return min(above, key=len, default=name)

    def _read_packages(self) -> dict[str, str]:
        """Return the folders of ROS packages by name."""
        packages: dict[str, str] = {}
        for path in sorted(self._members, key=len):
            if posixpath.basename(path) == "package.xml" and self.size(path) <= _MAX_PACKAGE_BYTES:
                name = _PACKAGE_NAME.search(self._unpacked(self._members[path], path))
                if name:
                    packages.setdefault(name[1].decode(), posixpath.dirname(path))
        return packages

    def _in_package(self, path: str) -> list[str]:
        """Return the parts of a path that begins with the name of a ROS package."""
        name, _, rest = posixpath.normpath(path).partition("/")
        return f"{self.package_folder(name)}/{rest}".split("/")

    def _longest_match(self, parts: Sequence[str], ignores_case: bool) -> str | None:
        """Return the path with the most of its last parts the same; of equals the shortest."""

        def same(path: str) -> int:
            pairs = zip(reversed(path.split("/")), reversed(parts), strict=False)
            count = 0
            for folder_a, folder_b in pairs:
                if folder_a != folder_b and not (
                    ignores_case and plain_name(folder_a) == plain_name(folder_b)
                ):
                    break
                count += 1
            return count

        paths = self._by_name.get(plain_name(parts[-1]), []) if parts else []
        best = max(paths, key=lambda path: (same(path), -len(path)), default=None)
        return best if best is not None and same(best) else None

    def _target(self, path: str) -> str | None:
        """Return the file to which a link in the zip leads; any other path as it is."""
        if path not in self._links:
            return path
        if self._links[path].file_size > _MAX_LINK_BYTES:
            return None
        target = self._unpacked(self._links[path], path).decode("utf-8", "replace")
        file = posixpath.normpath(posixpath.join(posixpath.dirname(path), target))
        return file if file in self._members else None


def _open(data: bytes) -> zipfile.ZipFile:
    """Open a zip, after its end record, which bounds the work of reading its directory."""
    at = data.rfind(b"PK\5\6", max(0, len(data) - _END.size - 65_535))
    if at < 0 or at + _END.size > len(data):
        raise DamagedFile("the zip was cut short: it has no directory")
    _, _, _, _, count, size, start, _ = _END.unpack_from(data, at)
    if count > _MAX_ENTRIES:
        raise DamagedFile(
            f"the zip has {count:,} members; at most {_MAX_ENTRIES:,} are read: give the folder of "
            "one robot"
        )
    if size > _MAX_DIRECTORY_BYTES or start + size > at:
        raise DamagedFile("the zip is damaged: its end does not say where its directory is")
    try:
        return zipfile.ZipFile(io.BytesIO(data))
    except (
        zipfile.BadZipFile,
        NotImplementedError,
        ValueError,
        struct.error,
        OverflowError,
        OSError,
        EOFError,
    ) as error:
        raise DamagedFile(f"the zip is damaged: {error}") from error


def _name_of(info: zipfile.ZipInfo) -> str:
    """Return a member's path; some programs write UTF-8 without saying so."""
    name = info.orig_filename
    if info.flag_bits & _UTF_8:
        return name
    try:
        return name.encode("cp437").decode("utf-8")
    except UnicodeError:
        return name


def _checked(infos: Sequence[zipfile.ZipInfo], size: int) -> Iterable[zipfile.ZipInfo]:
    """Return the members of a zip, after a check of their number and sizes.

    Raises:
        DamagedFile: if documents and meshes are too many or too large.
    """
    read = [info for info in infos if info.filename.lower().endswith((*DOCUMENTS, *MESHES))]
    if len(read) > MAX_MEMBERS:
        raise DamagedFile(
            f"the zip has {len(read):,} documents and meshes; a robot has at most {MAX_MEMBERS:,}"
        )
    total = sum(info.file_size for info in read)
    if total > MAX_UNPACKED_BYTES:
        raise DamagedFile(
            f"the zip of {size:,} bytes would unpack to {total:,}; at most "
            f"{MAX_UNPACKED_BYTES:,} are read"
        )
    return infos
