"""Promise 6: a decompression bomb is refused from its header: 311 kB that unpack to 320 MB.

In full: such a file, and others with false sizes; memory grows by less than 50 MB. And an archive
that is as large as it says, but much larger in memory, takes a few times its size.
"""

import io
import json
import struct
import time
import zipfile
from collections.abc import Callable
from functools import cache
from typing import Any

import httpx2
import numpy as np
import pytest
from numpy.lib import format as npy

from app.features.archives import archive
from tests.browser.serving import Serving
from tests.promises.raw import watched_memory

UNPACKED_BYTES = 320_000_000
MAX_BYTES = 50_000_000


@cache
def compression_bomb() -> bytes:
    """Build a zip of zeros, compressed to a thousandth of its size."""
    buffer = io.BytesIO()
    with (
        zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive,
        archive.open("agent.values.npy", "w") as member,
    ):
        member.write(header(UNPACKED_BYTES))
        for _ in range(UNPACKED_BYTES // 10_000_000):
            member.write(bytes(10_000_000))
    return buffer.getvalue()


def header(size: int) -> bytes:
    buffer = io.BytesIO()
    shape = {"descr": "|u1", "fortran_order": False, "shape": (size,)}
    npy.write_array_header_1_0(buffer, shape)
    return buffer.getvalue()


def wrong_compression_method() -> bytes:
    """Build the bomb with headers that falsely declare its member as stored uncompressed."""
    data = bytearray(compression_bomb())
    for signature, offset in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
        at = data.index(signature)
        data[at + offset : at + offset + 2] = struct.pack("<H", zipfile.ZIP_STORED)
    return bytes(data)


def oversized_header() -> bytes:
    """Build a small file whose header declares a huge array."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("agent.values.npy", header(10**12) + b"not so many")
    return buffer.getvalue()


def duplicated_entries() -> bytes:
    """Build a file whose central directory lists the same bytes 40,000 times."""
    buffer = io.BytesIO()
    np.savez(buffer, values=np.zeros(1000))
    data = bytearray(buffer.getvalue())
    start = data.index(b"PK\x01\x02")
    end = data.index(b"PK\x05\x06")
    entry, tail = bytes(data[start:end]), data[end:]
    count = 40_000
    struct.pack_into("<HHI", tail, 8, count, count, len(entry) * count)
    return bytes(data[:start]) + entry * count + bytes(tail)


@pytest.mark.parametrize(
    "bomb", [compression_bomb, wrong_compression_method, oversized_header, duplicated_entries]
)
@pytest.mark.parametrize(
    "path", ["/api/v1/trainings/import", "/api/v1/import", "/api/v1/runs/import"]
)
def test_a_bomb_is_refused_without_allocating_memory(
    bomb: Callable[[], bytes], path: str, quiet_server: Serving
) -> None:
    data = bomb()
    if bomb is compression_bomb:
        assert 300_000 < len(data) < 320_000
    with watched_memory(quiet_server.pid) as memory:
        answer = httpx2.post(quiet_server.address[:-1] + path, content=data, timeout=60)

    assert answer.status_code == 422, answer.text
    assert memory.grown_bytes < MAX_BYTES


LARGE_BYTES = 20_000_000
Members = dict[str, bytes]


def exported(server: Serving) -> Members:
    """Train, and return the members of the training's archive."""
    with httpx2.Client(base_url=server.address, timeout=60) as client:
        body = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 20}
        path = f"api/v1/trainings/{client.post('api/v1/trainings', json=body).json()['id']}"
        while client.get(path).json()["state"] != "finished":
            time.sleep(0.05)
        data = client.get(f"{path}/export").content
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        members = {name: packed.read(name) for name in packed.namelist()}
    del members[archive.MANIFEST]
    return members


def repeated(document: Any, field: dict[str, Any], key: str, item: str) -> bytes:
    """Encode a document with a list of one item, repeated to a large size, in a field of it."""
    field[key] = ["here"]
    items = ",".join([item] * (LARGE_BYTES // len(item)))
    return json.dumps(document).replace('"here"', items).encode()


def long_curve(members: Members) -> Members:
    run = json.loads(members["run.json"])
    row = '{"step":1,"distance_m":0,"epsilon":0}'
    return {**members, "run.json": repeated(run, run, "curve", row)}


def many_changes(members: Members) -> Members:
    run = json.loads(members["run.json"])
    change = '{"step":1,"settings":{"alpha":0.5}}'
    return {**members, "run.json": repeated(run, run["run"], "changes", change)}


def blanks(members: Members) -> Members:
    return {
        **members,
        "run.json": members["run.json"][:-1] + bytes(LARGE_BYTES).replace(b"\0", b" ") + b"}",
    }


def many_arrays(members: Members) -> Members:
    buffer = io.BytesIO()
    arrays: Any = {f"a{number}": np.zeros(1) for number in range(LARGE_BYTES // 400)}
    np.savez(buffer, **arrays)
    return {**members, "q-table.npz": buffer.getvalue()}


@pytest.mark.parametrize("hostile", [long_curve, many_changes, blanks, many_arrays])
def test_a_large_archive_is_refused_without_taking_many_times_its_size(
    hostile: Callable[[Members], Members], quiet_server: Serving
) -> None:
    data = archive.pack(hostile(exported(quiet_server)))
    address = f"{quiet_server.address}api/v1/runs/import"
    with watched_memory(quiet_server.pid) as memory:
        answer = httpx2.post(address, content=data, timeout=120)

    assert answer.status_code == 422, answer.text
    assert memory.grown_bytes < 8 * LARGE_BYTES
