"""The archive of a run: a zip that nothing is believed of before it is checked.

Its members lie in it uncompressed and side by side, so that it unpacks to no more than its own
size; the last one, a manifest, has the SHA-256 of each. Nothing is ever unpacked to a path.
"""

import hashlib
import io
import json
import stat
import struct
import zipfile
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from app.domain.errors import DamagedFile, InvalidInput

MANIFEST = "manifest.json"
MEDIA_TYPE = "application/zip"
MAX_BYTES = 1 << 30
MAX_MEMBERS = 128
_MAX_MANIFEST_BYTES = 64_000
_MAX_DIRECTORY_BYTES = 64_000
_END = struct.Struct("<4s4H2LH")  # the record with which a zip without a comment ends
_ANY_DAY = (1980, 1, 1, 0, 0, 0)


class Member(NamedTuple):
    """A member that is to be packed."""

    size: int
    """In bytes."""
    pieces: Callable[[], Iterator[bytes]]
    """Begins to read it."""


def member(data: bytes) -> Member:
    """A member out of memory."""
    return Member(len(data), lambda: iter([data]))


def pack(members: Mapping[str, bytes]) -> bytes:
    """An archive of these members; the same members give the same archive.

    Raises:
        InvalidInput: if it would be too large to be taken in again.
    """
    return b"".join(packed({name: member(data) for name, data in members.items()}))


def packed(members: Mapping[str, Member]) -> Iterator[bytes]:
    """The same archive piece by piece: what is read of a member is not kept.

    Raises:
        InvalidInput: at once, if it would be too large to be taken in again.
    """
    beside = _MAX_MANIFEST_BYTES + _MAX_DIRECTORY_BYTES
    if sum(one.size for one in members.values()) + beside > MAX_BYTES or (
        len(members) >= MAX_MEMBERS
    ):
        raise InvalidInput(f"the run is too large for an archive, which has up to {MAX_BYTES:,} B")
    return _packed(members)


def _packed(members: Mapping[str, Member]) -> Iterator[bytes]:
    written, hashes = _Written(), dict[str, str]()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_STORED) as archive:
        for name, one in members.items():
            digest = hashlib.sha256()
            with archive.open(_about(name, one.size), "w") as file:
                for piece in one.pieces():
                    digest.update(piece)
                    file.write(piece)
                    yield written.take()
            hashes[name] = digest.hexdigest()
        manifest = json.dumps({"sha256": hashes}, indent=1).encode()
        archive.writestr(_about(MANIFEST, len(manifest)), manifest)
    yield written.take()


def _about(name: str, size: int) -> zipfile.ZipInfo:
    about = zipfile.ZipInfo(name, _ANY_DAY)
    about.external_attr = (stat.S_IFREG | 0o644) << 16
    about.file_size = size
    return about


class _Written(io.RawIOBase):
    """What was written and not yet taken; zipfile cannot seek in it."""

    def __init__(self) -> None:
        super().__init__()
        self._parts: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        self._parts.append(bytes(data))
        return len(data)

    def take(self) -> bytes:
        taken = b"".join(self._parts)
        self._parts.clear()
        return taken


def unpack(data: bytes, said: str, is_known: Callable[[str], bool]) -> dict[str, bytes]:
    """The members of an archive, as they were packed.

    Args:
        data: all of the archive.
        said: what to call it in messages.
        is_known: whether an archive may have a member of this name.

    Raises:
        DamagedFile: if it is no archive that `pack` made, or was changed since.
    """
    _check_end(data, said)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            found = archive.infolist()
            _check_headers(found, len(data), said, is_known)
            members = {member.filename: archive.read(member) for member in found}
    except (zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError) as error:
        raise DamagedFile(f"{said} is damaged: it is no whole zip ({error})") from error
    except (ValueError, struct.error, OverflowError, OSError) as error:
        raise DamagedFile(f"{said} is damaged: it is no whole zip") from error
    _check_hashes(members, said)
    return members


def _check_end(data: bytes, said: str) -> None:
    """Look at the end first: it tells how much there is to read before any of it is read."""
    if len(data) > MAX_BYTES:
        raise DamagedFile(f"{said} is too large: an archive has at most {MAX_BYTES:,} bytes")
    where = len(data) - _END.size
    if where < 0 or data[where : where + 4] != b"PK\5\6":
        raise DamagedFile(
            f"{said} is no archive of a run, or was cut short; `hexapods export` makes one"
        )
    _, disk, start_disk, here, count, size, start, comment = _END.unpack_from(data, where)
    if count > MAX_MEMBERS or size > _MAX_DIRECTORY_BYTES:
        raise DamagedFile(f"{said} has {count:,} members; an archive has at most {MAX_MEMBERS}")
    if (disk, start_disk, here, comment) != (0, 0, count, 0) or start + size != where:
        raise DamagedFile(f"{said} is damaged: its end does not say what is in it")


def _check_headers(
    found: list[zipfile.ZipInfo], size: int, said: str, is_known: Callable[[str], bool]
) -> None:
    names = [member.filename for member in found]
    for member in found:
        # orig_filename, because zipfile cuts a name off where it has a NUL.
        name = member.orig_filename
        if name != MANIFEST and not is_known(name):
            raise DamagedFile(f"{said} has a member {name[:80]!r}, which no run has")
        kind = stat.S_IFMT(member.external_attr >> 16)
        if kind not in (0, stat.S_IFREG) or member.flag_bits & 1:
            raise DamagedFile(f"{said} has a member {name!r} that is no plain file")
        if member.compress_type != zipfile.ZIP_STORED or member.compress_size != member.file_size:
            raise DamagedFile(
                f"{said} has compressed members; take it as `hexapods export` made it"
            )
    if len(set(names)) < len(names):
        raise DamagedFile(f"{said} has a member twice")
    if MANIFEST not in names:
        raise DamagedFile(f"{said} is no archive of a run: it has no {MANIFEST}")
    if sum(member.file_size for member in found) > size:
        raise DamagedFile(f"{said} has members that claim to be larger than it is")


def _check_hashes(members: dict[str, bytes], said: str) -> None:
    """Take the manifest out, and hold the others against it."""
    written = members.pop(MANIFEST)
    try:
        if len(written) > _MAX_MANIFEST_BYTES:
            raise ValueError("it is too long")
        hashes = json.loads(written)["sha256"]
        listed = dict(hashes.items())
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DamagedFile(f"{said} is damaged: its {MANIFEST} cannot be read") from error
    if listed.keys() != members.keys():
        raise DamagedFile(f"{said} is damaged: its {MANIFEST} lists other members than it has")
    for name, data in members.items():
        if hashlib.sha256(data).hexdigest() != listed[name]:
            raise DamagedFile(f"{said} is damaged: {name} is not what was exported")
