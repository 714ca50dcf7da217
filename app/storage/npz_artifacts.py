"""Arrays of runs, stored as `.npz` artifacts."""

import io
from collections.abc import Iterator
from contextlib import closing, contextmanager

import numpy as np

from app.storage.artifact_file import ReadableArtifact
from app.storage.database.store import RunStore
from app.storage.errors import StorageFailed
from hexapods.domain.errors import DamagedFile, HexapodError
from hexapods.runs.recording import Arrays


@contextmanager
def decoding(label: str) -> Iterator[None]:
    """Translate the exceptions of reading and decoding a file.

    Args:
        label: name of the file for error messages.

    Raises:
        DamagedFile: if it cannot be decoded.
        StorageFailed: if it cannot be read.
    """
    try:
        yield
    except (HexapodError, MemoryError):
        raise
    except OSError as error:
        raise StorageFailed(f"{label} cannot be read ({error.strerror})") from error
    except Exception as error:  # zipfile and NumPy document no complete list of exceptions
        raise DamagedFile(f"{label} cannot be decoded: {error}") from error


def read_arrays(store: RunStore, run_id: str, name: str) -> Arrays | None:
    """Return the arrays of a file of a run; None if it has no file of this name.

    Raises:
        NotFound: if there is no such run.
        DamagedFile, StorageFailed: as `decoding`.
    """
    file = store.open_artifact(run_id, name)
    if file is None:
        return None
    with (
        closing(file),
        decoding(f"{name} of run {run_id}"),
        # Read from the file, so that its bytes are not in memory in addition to the arrays.
        np.load(io.BufferedReader(ReadableArtifact(file)), allow_pickle=False) as arrays,
    ):
        return dict(arrays)


def put_arrays(store: RunStore, run_id: str, name: str, arrays: Arrays) -> None:
    """Store arrays as a file of a run; see `RunStore.put_artifact`."""
    # Uncompressed: compression saves a tenth of the size and takes a hundred times as long.
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    with buffer.getbuffer() as data:  # no copy
        store.put_artifact(run_id, name, data)
