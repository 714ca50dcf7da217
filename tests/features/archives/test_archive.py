"""Archive container: round trip, and rejection of malformed or malicious zips (promise 6)."""

import io
import json
import random
import stat
import struct
import tracemalloc
import zipfile
from collections.abc import Callable
from hashlib import sha256

import pytest

from app.features.archives import archive
from app.features.archives.archive import MANIFEST, pack, unpack
from hexapods.domain.errors import DamagedFile, InvalidInput

MEMBERS = {"run.json": b'{"a": 1}', "race.npz": bytes(range(256)) * 8}


def opened(data: bytes) -> dict[str, bytes]:
    return unpack(data, "run.zip", MEMBERS.__contains__)


def zipped(
    change: Callable[[zipfile.ZipInfo], None] = lambda info: None,
    compression: int = zipfile.ZIP_STORED,
    members: dict[str, bytes] | None = None,
) -> bytes:
    """Create a zip with a correct manifest, and otherwise as given."""
    members = MEMBERS if members is None else members
    hashes = {name: sha256(data).hexdigest() for name, data in members.items()}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        for name, data in {**members, MANIFEST: json.dumps({"sha256": hashes}).encode()}.items():
            info = zipfile.ZipInfo(name)
            info.compress_type = compression
            change(info)
            file.writestr(info, data)
    return buffer.getvalue()


def refusal(data: bytes) -> str:
    with pytest.raises(DamagedFile) as error:
        opened(data)
    assert "run.zip" in str(error.value)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_unpack_inverts_pack() -> None:
    assert opened(pack(MEMBERS)) == MEMBERS
    assert pack(MEMBERS) == pack(MEMBERS)
    assert opened(zipped()) == MEMBERS


def test_zip_bomb_is_refused_by_its_headers() -> None:
    bomb = zipped(members={"race.npz": bytes(320_000_000)}, compression=zipfile.ZIP_DEFLATED)
    assert len(bomb) < 320_000
    tracemalloc.start()
    assert "compressed" in refusal(bomb)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 5_000_000


def test_wrong_member_sizes_are_refused() -> None:
    whole = zipped()
    directory = whole.index(b"PK\1\2")
    for claimed in (len(MEMBERS["run.json"]) + 1, 2**31, 2**32 - 1):
        sizes = struct.pack("<LL", claimed, claimed)
        refusal(whole[: directory + 20] + sizes + whole[directory + 28 :])


@pytest.mark.parametrize(
    "name",
    ["../run.json", "/etc/passwd", "a/run.json", "a\\run.json", "run.json/", "RUN.JSON", "", "run"],
)
def test_unexpected_member_names_are_refused(name: str) -> None:
    assert "which no run has" in refusal(zipped(members={**MEMBERS, name: b"x"}))


def test_member_name_with_nul_is_refused() -> None:
    data = zipped(members={**MEMBERS, "race.npz_evil": b"x"})
    assert "which no run has" in refusal(data.replace(b"race.npz_evil", b"race.npz\0evil"))


def test_links_and_encrypted_members_are_refused() -> None:
    def link(info: zipfile.ZipInfo) -> None:
        info.external_attr = (stat.S_IFLNK | 0o777) << 16

    assert "no plain file" in refusal(zipped(link))
    secret = bytearray(zipped())
    secret[secret.index(b"PK\1\2") + 8] |= 1
    assert "no plain file" in refusal(bytes(secret))


def test_duplicate_member_is_refused() -> None:
    data = zipped(members={**MEMBERS, "run.jsox": b"x"})
    assert "twice" in refusal(data.replace(b"run.jsox", b"run.json"))


def test_too_many_members_are_refused() -> None:
    many = zipped(members={f"{n}.npz": b"" for n in range(20_000)})
    assert "members" in refusal(many)


def test_truncated_and_extended_archives_are_refused() -> None:
    whole = pack(MEMBERS)
    for size in range(len(whole)):
        refusal(whole[:size])
    for more in (b"x" + whole, whole + b"x", whole + whole):
        refusal(more)
    for nothing in (b"", b"PK\5\6", b"PK\5\6" + bytes(18), b"milk" * 100):
        refusal(nothing)


def test_flipped_bits_are_detected_or_irrelevant() -> None:
    whole, chance = pack(MEMBERS), random.Random(6)
    refused = 0
    for place in range(len(whole)):
        flipped = bytearray(whole)
        flipped[place] ^= 1 << chance.randrange(8)
        try:
            assert opened(bytes(flipped)) == MEMBERS
        except DamagedFile:
            refused += 1
    # The others are in times, versions and permissions, which are not read.
    assert refused > 0.9 * len(whole)


def test_manifest_that_does_not_match_is_refused() -> None:
    def with_manifest(manifest: bytes) -> bytes:
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as file:
            for name, data in {**MEMBERS, MANIFEST: manifest}.items():
                file.writestr(name, data)
        return buffer.getvalue()

    right = {name: sha256(data).hexdigest() for name, data in MEMBERS.items()}
    wrong = {**right, "race.npz": sha256(b"").hexdigest()}
    assert "not what was exported" in refusal(with_manifest(json.dumps({"sha256": wrong}).encode()))
    for listed in ({}, {"run.json": right["run.json"]}, {**right, "more": ""}):
        refusal(with_manifest(json.dumps({"sha256": listed}).encode()))
    for strange in (b"", b"[]", b"{}", b'{"sha256": 3}', b"[" * 50_000, b"\xff", b" " * 70_000):
        refusal(with_manifest(strange))
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as file:
        file.writestr("run.json", b"{}")
    assert MANIFEST in refusal(buffer.getvalue())


def test_archive_too_large_to_import_is_not_packed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive, "MAX_BYTES", 1000)
    with pytest.raises(InvalidInput, match="too large"):
        pack(MEMBERS)
    assert "too large" in refusal(zipped())
