"""Chunked reading of artifact files, and the descriptor that concurrent readers share."""

import gc
import io
from pathlib import Path

import pytest

from app.storage.artifact_file import (
    CHUNK_BYTES,
    ReadableArtifact,
    chunks,
    closing_after,
)
from app.storage.artifacts import ArtifactFiles, StoredFile
from app.storage.disk_space import DiskSpace
from hexapods.domain.errors import DamagedFile

DATA = bytes(range(256)) * 1000


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "artifacts"
    path.mkdir()
    return path


@pytest.fixture
def files(folder: Path) -> ArtifactFiles:
    return ArtifactFiles(folder, DiskSpace(folder.parent, None))


def open_descriptors(folder: Path) -> int:
    targets = [link.resolve() for link in Path("/proc/self/fd").iterdir() if link.exists()]
    return sum(path.parent == folder.resolve() for path in targets)


def test_chunks_add_up_to_the_file(files: ArtifactFiles, folder: Path) -> None:
    stored = files.write(DATA)
    parts = list(chunks(files.open(stored, "it")))

    assert b"".join(parts) == DATA
    assert max(map(len, parts)) == CHUNK_BYTES
    assert open_descriptors(folder) == 0


def test_concurrent_readers_share_one_descriptor(files: ArtifactFiles, folder: Path) -> None:
    stored = files.write(DATA)
    readers = [chunks(files.open(stored, "it")) for _ in range(50)]
    started = [next(reader) for reader in readers]

    assert open_descriptors(folder) == 1
    assert {b"".join([first, *rest]) for first, rest in zip(started, readers, strict=True)} == {
        DATA
    }
    assert open_descriptors(folder) == 0
    assert files.open(stored, "it").read_at(0, 10) == DATA[:10]


def test_garbage_collected_readers_close_the_file(files: ArtifactFiles, folder: Path) -> None:
    stored = files.write(DATA)
    never_started = closing_after(files.open(stored, "it"), [b""])
    started = chunks(files.open(stored, "it"))
    next(started)
    assert open_descriptors(folder) == 1

    del never_started, started
    gc.collect()
    assert open_descriptors(folder) == 0


def test_file_deleted_during_a_read_is_read_to_its_end(files: ArtifactFiles) -> None:
    stored = files.write(DATA)
    reader = chunks(files.open(stored, "it"))
    begin = next(reader)
    files.remove(stored.file)

    assert begin + b"".join(reader) == DATA
    with pytest.raises(FileNotFoundError):
        files.open(stored, "it")


@pytest.mark.parametrize(
    "damaged", [DATA[:-1], DATA + b"\0", b"\1" + DATA[1:], DATA[:-1] + b"\1", b""]
)
def test_changed_file_is_refused(files: ArtifactFiles, folder: Path, damaged: bytes) -> None:
    stored = files.write(DATA)
    (folder / stored.file).write_bytes(damaged)

    with pytest.raises(DamagedFile, match="it is damaged"):
        files.open(stored, "it")
    assert open_descriptors(folder) == 0


def test_reading_a_closed_reader_raises(files: ArtifactFiles) -> None:
    stored: StoredFile = files.write(DATA)
    reader = files.open(stored, "it")
    reader.close()
    reader.close()

    with pytest.raises(ValueError, match="closed"):
        reader.read_at(0, 1)


def test_artifact_is_readable_as_a_binary_file(files: ArtifactFiles) -> None:
    file = io.BufferedReader(ReadableArtifact(files.open(files.write(DATA), "it")))

    assert file.read(5) == DATA[:5]
    file.seek(-3, io.SEEK_END)
    assert file.read() == DATA[-3:]
    file.seek(700)
    assert file.tell() == 700
    assert file.read(300) == DATA[700:1000]
