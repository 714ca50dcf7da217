"""Archive container: a zip file that is validated before any of it is used.

Members are stored uncompressed and must not overlap, so an archive never unpacks to more than its
own size (no zip bombs). The last member, a manifest, holds the SHA-256 of each. Members are
unpacked to memory only, never to a path.
"""

import hashlib
import io
import json
import stat
import struct
import zipfile
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.files import DrainedBuffer

MANIFEST = "manifest.json"
MEDIA_TYPE = "application/zip"
MAX_BYTES = 1 << 30
"""Maximum size of an archive."""
MAX_MEMBERS = 256
"""Maximum of members, with the manifest."""
_MAX_MANIFEST_BYTES = 64_000
_MAX_DIRECTORY_BYTES = 64_000
_END = struct.Struct("<4s4H2LH")  # end of central directory record, without a comment
_FIXED_TIME = (1980, 1, 1, 0, 0, 0)


class Member(NamedTuple):
    """A member to be packed.

    Attributes:
        size: its length [bytes].
        chunks: opens it, and iterates over its content.
    """

    size: int
    chunks: Callable[[], Iterator[bytes]]


def member(data: bytes) -> Member:
    """Create a member from bytes in memory."""
    return Member(len(data), lambda: iter([data]))


def pack(members: Mapping[str, bytes]) -> bytes:
    """Pack members into an archive; equal members give identical bytes.

    Raises:
        InvalidInput: if the archive would be too large to be imported again.
    """
    return b"".join(pack_chunks({name: member(data) for name, data in members.items()}))


def pack_chunks(members: Mapping[str, Member]) -> Iterator[bytes]:
    """Pack members into an archive as a stream of chunks; memory use is one chunk.

    Raises:
        InvalidInput: at the call, if the archive would be too large to be imported again.
    """
    if packed_size(sum(member.size for member in members.values())) > MAX_BYTES or (
        len(members) >= MAX_MEMBERS
    ):
        raise InvalidInput(f"it is too large for an archive, which has up to {MAX_BYTES:,} B")
    return _pack_chunks(members)


def packed_size(size: int) -> int:
    """Return the maximum size of an archive whose members have this size together [bytes]."""
    return size + _MAX_MANIFEST_BYTES + _MAX_DIRECTORY_BYTES


def _pack_chunks(members: Mapping[str, Member]) -> Iterator[bytes]:
    buffer, hashes = DrainedBuffer(), dict[str, str]()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, member in members.items():
            digest = hashlib.sha256()
            with archive.open(_zip_info(name, member.size), "w") as file:
                for chunk in member.chunks():
                    digest.update(chunk)
                    file.write(chunk)
                    yield buffer.drain()
            hashes[name] = digest.hexdigest()
        manifest = json.dumps({"sha256": hashes}, indent=1).encode()
        archive.writestr(_zip_info(MANIFEST, len(manifest)), manifest)
    yield buffer.drain()


def _zip_info(name: str, size: int) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, _FIXED_TIME)
    info.external_attr = (stat.S_IFREG | 0o644) << 16
    info.file_size = size
    return info


def unpack(data: bytes, label: str, is_allowed: Callable[[str], bool]) -> dict[str, bytes]:
    """Validate an archive, and return its members by name.

    Args:
        data: the whole archive.
        label: name of the archive for error messages.
        is_allowed: whether an archive may have a member of this name.

    Raises:
        DamagedFile: if `pack` did not create it, or it was changed since.
    """
    _check_end(data, label)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            infos = archive.infolist()
            _check_headers(infos, len(data), label, is_allowed)
            members = {member.filename: archive.read(member) for member in infos}
    except (zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError) as error:
        raise DamagedFile(f"{label} is damaged: it is no whole zip ({error})") from error
    except InvalidInput:
        raise
    except (ValueError, struct.error, OverflowError, OSError) as error:
        raise DamagedFile(f"{label} is damaged: it is no whole zip") from error
    _check_hashes(members, label)
    return members


def _check_end(data: bytes, label: str) -> None:
    """Check the end of central directory record, which bounds the work, before parsing the zip."""
    if len(data) > MAX_BYTES:
        raise DamagedFile(f"{label} is too large: an archive has at most {MAX_BYTES:,} bytes")
    offset = len(data) - _END.size
    if offset < 0 or data[offset : offset + 4] != b"PK\5\6":
        raise DamagedFile(
            f"{label} is no archive of a run, or was cut short; `hexapods export` makes one"
        )
    _, disk, start_disk, count_on_disk, count, size, start, comment = _END.unpack_from(data, offset)
    if count > MAX_MEMBERS or size > _MAX_DIRECTORY_BYTES:
        raise DamagedFile(f"{label} has {count:,} members; an archive has at most {MAX_MEMBERS}")
    if (disk, start_disk, count_on_disk, comment) != (0, 0, count, 0) or start + size != offset:
        raise DamagedFile(f"{label} is damaged: its end does not say what is in it")


def _check_headers(
    infos: list[zipfile.ZipInfo], size: int, label: str, is_allowed: Callable[[str], bool]
) -> None:
    names = [member.filename for member in infos]
    for member in infos:
        # orig_filename, because zipfile truncates a name at NUL.
        name = member.orig_filename
        if name != MANIFEST and not is_allowed(name):
            raise DamagedFile(f"{label} has a member {name[:80]!r}, which no run has")
        kind = stat.S_IFMT(member.external_attr >> 16)
        if kind not in (0, stat.S_IFREG) or member.flag_bits & 1:
            raise DamagedFile(f"{label} has a member {name!r} that is no plain file")
        if member.compress_type != zipfile.ZIP_STORED or member.compress_size != member.file_size:
            raise DamagedFile(
                f"{label} has compressed members; take it as `hexapods export` made it"
            )
    if len(set(names)) < len(names):
        raise DamagedFile(f"{label} has a member twice")
    if MANIFEST not in names:
        raise DamagedFile(f"{label} is no archive of a run: it has no {MANIFEST}")
    if sum(member.file_size for member in infos) > size:
        raise DamagedFile(f"{label} has members that claim to be larger than it is")


def _check_hashes(members: dict[str, bytes], label: str) -> None:
    """Remove the manifest from the members, and verify their SHA-256 hashes against it."""
    manifest = members.pop(MANIFEST)
    try:
        if len(manifest) > _MAX_MANIFEST_BYTES:
            raise ValueError("it is too long")
        hashes = json.loads(manifest)["sha256"]
        listed = dict(hashes.items())
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DamagedFile(f"{label} is damaged: its {MANIFEST} cannot be read") from error
    if listed.keys() != members.keys():
        raise DamagedFile(f"{label} is damaged: its {MANIFEST} lists other members than it has")
    for name, data in members.items():
        if hashlib.sha256(data).hexdigest() != listed[name]:
            raise DamagedFile(f"{label} is damaged: {name} is not what was exported")
