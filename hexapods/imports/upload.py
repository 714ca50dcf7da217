"""The uploaded file: one document, or a zip whose members are read only when they are needed.

Nothing is written to disk. A zip is judged by its directory: by numbers and sizes, before a byte of
it is unpacked; and no member unpacks to more than its directory says.
"""

import io
import posixpath
import stat
import struct
import zipfile
import zlib
from collections.abc import Sequence

from hexapods.domain.errors import DamagedFile
from hexapods.imports.notes import listed, quoted

MAX_UPLOAD_BYTES = 64 << 20
MAX_DOCUMENT_BYTES = 4 << 20
"""Size of one XML document."""
MAX_MEMBERS = 2000
MAX_UNPACKED_BYTES = 192 << 20
"""Size of all members of a zip together."""
MAX_MESH_BYTES = 32 << 20
"""Size of one mesh file."""
_MAX_DIRECTORY_BYTES = 1 << 20
_END = struct.Struct("<4s4H2LH")  # end of central directory record, without a comment
_DOCUMENTS = (".xml", ".urdf", ".mjcf")
_LINK_OR_DEVICE = "a link or no plain file; a zip may have plain files only"


class Upload:
    """The files of an upload by path; a single document is one file.

    Attributes:
        is_zip: whether it is a zip.
        paths: of all files.

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
        if self.is_zip:
            self._zip = _open(data)
            self._members = _checked(self._zip.infolist(), len(data))
            self.paths: Sequence[str] = list(self._members)
        else:
            self.paths = [posixpath.basename(file_name.replace("\\", "/")) or "robot.xml"]

    @property
    def documents(self) -> list[str]:
        """Paths of the files that may describe a robot."""
        if not self.is_zip:
            return [*self.paths]
        documents = [path for path in self.paths if path.lower().endswith(_DOCUMENTS)]
        if not documents:
            raise self.without_robot()
        return documents

    def without_robot(self) -> DamagedFile:
        """Return the error for a zip without a robot."""
        if any(path.lower().endswith(".xacro") for path in self.paths):
            return DamagedFile(
                "the zip has xacro files, which are not expanded here: run `xacro robot.xacro > "
                "robot.urdf`, and add the result"
            )
        return DamagedFile(
            f"the zip has no MJCF or URDF document ({', '.join(_DOCUMENTS)}); it has: "
            f"{listed(self.paths) or 'nothing'}"
        )

    def size(self, path: str) -> int:
        """Return the size of a file as the zip's directory says."""
        return self._members[path].file_size if self.is_zip else len(self._data)

    def read(self, path: str, most_bytes: int) -> bytes:
        """Return a file's content.

        Raises:
            DamagedFile: if it is larger, or cannot be unpacked.
        """
        size = self.size(path)
        if size > most_bytes:
            raise DamagedFile(f"{quoted(path)} has {size:,} bytes; at most {most_bytes:,} are read")
        if not self.is_zip:
            return self._data
        try:
            with self._zip.open(self._members[path]) as member:
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
        """Return the path of the file that a document means.

        Args:
            wanted: path as the document has it, also such as `package://robot/meshes/hip.stl`.
            document_path: path of the document.

        Returns:
            the file at that path beside the document, or the one whose path ends with the most of
            the same parts; None if none has its name.

        Raises:
            DamagedFile: if the path leads out of the zip.
        """
        plain = wanted.replace("\\", "/")
        scheme, separator, rest = plain.partition("://")
        if separator and scheme not in ("package", "model", "file"):
            raise DamagedFile(f"{quoted(wanted)} is no path in the zip; nothing is downloaded")
        if separator:
            parts = rest.split("/")
        else:
            together = posixpath.join(posixpath.dirname(document_path), plain)
            path = posixpath.normpath(together)
            if path.startswith(("/", "../")) or path == ".." or ":" in plain[:3]:
                raise DamagedFile(
                    f"{quoted(wanted)} leads out of the zip; a mesh is named by its path beside "
                    "the document"
                )
            if path in self._members:
                return path
            parts = path.split("/")
        if ".." in parts:
            raise DamagedFile(f"{quoted(wanted)} leads out of the zip; give the path without `..`")
        return self._longest_match([name for name in parts if name not in ("", ".")])

    def _longest_match(self, parts: Sequence[str]) -> str | None:
        """Return the path with the most of its last parts the same; of equals the shortest."""

        def same(path: str) -> int:
            pairs = zip(reversed(path.split("/")), reversed(parts), strict=False)
            count = 0
            for folder_a, folder_b in pairs:
                if folder_a != folder_b:
                    break
                count += 1
            return count

        best = max(self._members, key=lambda path: (same(path), -len(path)), default=None)
        return best if best is not None and same(best) else None


def _open(data: bytes) -> zipfile.ZipFile:
    """Open a zip, after its end record, which bounds the work of reading its directory."""
    at = data.rfind(b"PK\5\6", max(0, len(data) - _END.size - 65_535))
    if at < 0 or at + _END.size > len(data):
        raise DamagedFile("the zip was cut short: it has no directory")
    _, _, _, _, count, size, start, _ = _END.unpack_from(data, at)
    if count > MAX_MEMBERS:
        raise DamagedFile(f"the zip has {count:,} members; a robot has at most {MAX_MEMBERS:,}")
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


def _checked(infos: Sequence[zipfile.ZipInfo], size: int) -> dict[str, zipfile.ZipInfo]:
    """Return the files of a zip by path, after a check of its directory.

    Raises:
        DamagedFile: if they are too many or too large, or one is encrypted, a link, or has a path
            that leads out of the zip.
    """
    if len(infos) > MAX_MEMBERS:
        raise DamagedFile(
            f"the zip has {len(infos):,} members; a robot has at most {MAX_MEMBERS:,}"
        )
    total = sum(info.file_size for info in infos)
    if total > MAX_UNPACKED_BYTES:
        raise DamagedFile(
            f"the zip of {size:,} bytes would unpack to {total:,}; at most "
            f"{MAX_UNPACKED_BYTES:,} are read"
        )
    members: dict[str, zipfile.ZipInfo] = {}
    for info in infos:
        path = info.orig_filename.replace("\\", "/")
        if "\0" in path or path.startswith("/") or ".." in path.split("/") or ":" in path[:3]:
            raise DamagedFile(f"the zip has a member {quoted(path)} whose path leads out of it")
        if info.is_dir():
            continue
        if stat.S_IFMT(info.external_attr >> 16) not in (0, stat.S_IFREG):
            raise DamagedFile(f"in the zip {quoted(path)} is {_LINK_OR_DEVICE}")
        if info.flag_bits & 1:
            raise DamagedFile(f"in the zip {quoted(path)} is encrypted; give it without a password")
        name = posixpath.normpath(path)
        if name in members:
            raise DamagedFile(f"the zip has {quoted(path)} twice")
        members[name] = info
    return members
