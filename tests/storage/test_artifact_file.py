"""Files of runs, read piece by piece."""

import gc
import io
from pathlib import Path

import pytest

from app.domain.errors import DamagedFile
from app.storage.artifact_file import (
    PIECE_BYTES,
    BytesFile,
    ReadableArtifact,
    closing_after,
    pieces,
)
from app.storage.artifacts import ArtifactFiles, StoredFile
from app.storage.disk_space import DiskSpace

DATA = bytes(range(256)) * 1000


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "artifacts"


@pytest.fixture
def files(folder: Path) -> ArtifactFiles:
    return ArtifactFiles(folder, DiskSpace(folder.parent, None))


def open_descriptors(folder: Path) -> int:
    found = [link.resolve() for link in Path("/proc/self/fd").iterdir() if link.exists()]
    return sum(path.parent == folder.resolve() for path in found)


def test_the_pieces_are_the_whole(files: ArtifactFiles, folder: Path) -> None:
    stored = files.write(DATA)
    parts = list(pieces(files.open(stored, "it")))

    assert b"".join(parts) == DATA
    assert max(map(len, parts)) == PIECE_BYTES
    assert open_descriptors(folder) == 0


def test_many_readers_share_one_descriptor(files: ArtifactFiles, folder: Path) -> None:
    stored = files.write(DATA)
    readers = [pieces(files.open(stored, "it")) for _ in range(50)]
    begun = [next(reader) for reader in readers]

    assert open_descriptors(folder) == 1
    assert {b"".join([first, *rest]) for first, rest in zip(begun, readers, strict=True)} == {DATA}
    assert open_descriptors(folder) == 0
    assert files.open(stored, "it").read_at(0, 10) == DATA[:10]


def test_a_reader_that_is_dropped_closes_its_file(files: ArtifactFiles, folder: Path) -> None:
    stored = files.write(DATA)
    never_begun = closing_after(files.open(stored, "it"), [b""])
    begun = pieces(files.open(stored, "it"))
    next(begun)
    assert open_descriptors(folder) == 1

    del never_begun, begun
    gc.collect()
    assert open_descriptors(folder) == 0


def test_a_file_that_goes_while_it_is_read_is_read_to_its_end(files: ArtifactFiles) -> None:
    stored = files.write(DATA)
    reader = pieces(files.open(stored, "it"))
    begin = next(reader)
    files.remove(stored.file)

    assert begin + b"".join(reader) == DATA
    with pytest.raises(FileNotFoundError):
        files.open(stored, "it")


@pytest.mark.parametrize(
    "damaged", [DATA[:-1], DATA + b"\0", b"\1" + DATA[1:], DATA[:-1] + b"\1", b""]
)
def test_what_is_not_what_was_written_is_refused(
    files: ArtifactFiles, folder: Path, damaged: bytes
) -> None:
    stored = files.write(DATA)
    (folder / stored.file).write_bytes(damaged)

    with pytest.raises(DamagedFile, match="it is damaged"):
        files.open(stored, "it")
    assert open_descriptors(folder) == 0


def test_a_closed_reader_reads_no_more(files: ArtifactFiles) -> None:
    stored: StoredFile = files.write(DATA)
    reader = files.open(stored, "it")
    reader.close()
    reader.close()

    with pytest.raises(ValueError, match="closed"):
        reader.read_at(0, 1)


def test_an_artifact_can_be_read_as_a_file() -> None:
    file = io.BufferedReader(ReadableArtifact(BytesFile(DATA)))

    assert file.read(5) == DATA[:5]
    file.seek(-3, io.SEEK_END)
    assert file.read() == DATA[-3:]
    file.seek(700)
    assert file.tell() == 700
    assert file.read(300) == DATA[700:1000]
