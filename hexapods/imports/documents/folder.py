"""Choose the files of a folder or a repository that describe a robot, and pack them into a zip.

The rule is in docs/robot-files.md, and the page follows it too: all documents, and the meshes whose
names appear in one of them. Symbolic links and hidden folders are not followed.
"""

import io
import os
import posixpath
import re
import zipfile
from collections.abc import Callable, Iterable, Mapping
from fnmatch import translate
from pathlib import Path
from urllib.parse import unquote

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.imports.documents.upload import (
    DOCUMENTS,
    MAX_DOCUMENT_BYTES,
    MAX_MEMBERS,
    MAX_UNPACKED_BYTES,
    MAX_UPLOAD_BYTES,
    MESHES,
    last_part,
    plain_name,
)
from hexapods.imports.notes import listed, quoted

MAX_FILES = 10_000
"""Files of a folder, in all folders of it."""
_NAMING = (*DOCUMENTS, ".yaml", ".yml")
"""Endings of files that are taken, and searched for names of meshes."""
MAX_DOCUMENTS_BYTES = 16 << 20
"""Size of all documents together; the deepest in the folder are left out first."""
_MAX_DEPTH = 40
_SKIPPED = ("__MACOSX", "node_modules")
_PIECE = re.compile(r"[^\"'<>\r\n]+")
_EXPRESSION = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")

Read = Callable[[str], bytes]


def read_robot_path(path: Path) -> tuple[bytes, str]:
    """Return the bytes that a path of a robot's file or folder means, and a file name for them.

    A folder, and a zip that is larger than an upload may be, are packed: only what describes a
    robot is in the bytes.

    Raises:
        InvalidInput: if it cannot be read, or the folder has no document of a robot.
        DamagedFile: if the zip is damaged.
    """
    try:
        if path.is_dir():
            return pack_folder(path), f"{path.resolve().name}.zip"
        with path.open("rb") as file:
            data = file.read(MAX_UPLOAD_BYTES + 1)
    except OSError as error:
        raise InvalidInput(f"cannot read {path}: {error.strerror}") from error
    is_large_zip = len(data) > MAX_UPLOAD_BYTES and data.startswith(b"PK")
    return (pack_zip(path) if is_large_zip else data), path.name


def pack_folder(folder: Path) -> bytes:
    """Return a zip of the files in a folder that describe a robot.

    Raises:
        InvalidInput: if it has no document, too many files, or the robot is too large.
    """
    sizes = _walked(folder)
    return _pack(sizes, lambda path: _content(folder / path, path))


def pack_zip(file: Path) -> bytes:
    """Return a zip of those members of a zip, such as a repository, that describe a robot.

    Raises:
        InvalidInput: if it has no document, too many files, or the robot is too large.
        DamagedFile: if the zip is damaged.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            members = {
                posixpath.normpath(info.filename): info
                for info in archive.infolist()
                if not info.is_dir() and not _is_skipped(info.filename.split("/"))
            }
            _check_count(len(members))
            sizes = {path: info.file_size for path, info in members.items()}
            return _pack(sizes, lambda path: archive.read(members[path]))
    except InvalidInput:  # which is a ValueError
        raise
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, ValueError) as error:
        raise DamagedFile(f"the zip is damaged: {error}") from error
    except OSError as error:
        raise InvalidInput(f"cannot read {file}: {error.strerror}") from error


def chosen_files(sizes: Mapping[str, int], read: Read) -> list[str]:
    """Return the paths of the documents, and of the meshes whose names appear in one of them.

    Args:
        sizes: of all files, by path with slashes [bytes].
        read: returns the content of a file.
    """
    names, patterns = set[str](), set[str]()
    chosen, total = list[str](), 0
    for path in sorted(sizes, key=lambda path: (path.count("/"), path)):
        if not path.lower().endswith(_NAMING) or sizes[path] > MAX_DOCUMENT_BYTES:
            continue
        total += sizes[path]
        if total > MAX_DOCUMENTS_BYTES:
            break
        chosen.append(path)
        for name in names_in(read(path).decode("utf-8", "replace")):
            (patterns if "*" in name else names).add(name)
    meshes = [path for path in sizes if path.lower().endswith(MESHES)]
    named = re.compile("|".join(map(translate, sorted(patterns))) or r"(?!)")
    for path in meshes:
        name = plain_name(posixpath.basename(path))
        if name in names or named.match(name):
            chosen.append(path)
    folders = {posixpath.dirname(path) for path in chosen if path.lower().endswith(".gltf")}
    buffers = {
        path
        for path in meshes
        if path.lower().endswith(".bin") and posixpath.dirname(path) in folders
    }
    return [*chosen, *sorted(buffers - {*chosen})]


def names_in(text: str) -> set[str]:
    """Return the names of files that may appear in a document, in lower case.

    Each text between quotes, angle brackets and line ends, and each of its words, counts by the
    last part of its path, also without `%20` and the like; `${…}` and `$(…)` in it become `*`.
    """
    names = set[str]()
    for piece in _PIECE.findall(text):
        path = _EXPRESSION.sub("*", piece.strip())
        for word in {path, *path.split()}:
            name = plain_name(last_part(word))
            if "." in name or ("*" in name and "/" in word):
                names |= {name, plain_name(unquote(name))}
    return names


def _walked(folder: Path) -> dict[str, int]:
    """Return the sizes of the files below a folder by path."""
    sizes: dict[str, int] = {}
    waiting = [""]
    while waiting:
        at = waiting.pop()
        try:
            entries = sorted(os.scandir(folder / at), key=lambda entry: entry.name)
        except OSError as error:
            if at:  # a folder in it that others may not read
                continue
            raise InvalidInput(f"cannot read {folder}: {error.strerror}") from error
        for entry in entries:
            path = posixpath.join(at, entry.name)
            if entry.is_symlink() or _is_skipped([entry.name]):
                continue
            if entry.is_dir():
                if path.count("/") < _MAX_DEPTH:
                    waiting.append(path)
            elif entry.is_file():
                sizes[path] = entry.stat().st_size
        _check_count(len(sizes) + len(waiting))
    return sizes


def _is_skipped(parts: Iterable[str]) -> bool:
    return any(part in _SKIPPED or (part.startswith(".") and part != ".") for part in parts)


def _check_count(count: int) -> None:
    if count > MAX_FILES:
        raise InvalidInput(
            f"it has more than {MAX_FILES:,} files; give the folder of one robot, with its meshes"
        )


def _content(file: Path, path: str) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise InvalidInput(f"cannot read {path}: {error.strerror}") from error


def _pack(sizes: Mapping[str, int], read: Read) -> bytes:
    paths = chosen_files(sizes, read)
    if not any(path.lower().endswith(DOCUMENTS) for path in paths):
        raise InvalidInput(
            f"it has no document of a robot ({', '.join(DOCUMENTS)}); it has: "
            f"{listed(sorted(sizes)) or 'no files'}"
        )
    total = sum(sizes[path] for path in paths)  # whole numbers
    if len(paths) > MAX_MEMBERS or total > MAX_UNPACKED_BYTES:
        raise _too_large(paths, f"{len(paths):,} files of {total:,} bytes")
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for path in paths:
            archive.writestr(zipfile.ZipInfo(path), read(path), zipfile.ZIP_DEFLATED, 1)
    data = buffer.getvalue()
    if len(data) > MAX_UPLOAD_BYTES:
        raise _too_large(paths, f"{len(data):,} bytes, zipped")
    return data


def _too_large(paths: Iterable[str], what: str) -> InvalidInput:
    folders = sorted(
        {posixpath.dirname(path) or "." for path in paths if path.lower().endswith(DOCUMENTS)}
    )
    return InvalidInput(
        f"its documents and meshes are {what}; at most {MAX_MEMBERS:,} files of "
        f"{MAX_UNPACKED_BYTES:,} bytes, {MAX_UPLOAD_BYTES:,} zipped, are read: give the folder of "
        f"one robot; documents are in {listed(map(quoted, folders))}"
    )
