"""Use a store on a full disk, and report as JSON which operations succeed."""

import contextlib
import json
import resource
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from app.storage.database.store import RunStore
from app.storage.errors import StorageFull
from app.storage.run import LIVE, TABLE
from tests.storage.stores import opened, training

MB = 1_000_000
LIMIT_BYTES = 1 * MB


def main(folder: Path, how: str) -> None:
    fill = filled_disk if how == "mount" else file_size_limit
    with opened(folder, None) as store:
        store.create(training("a", state="running"), training("b", state="running"))
        store.put_artifact("a", TABLE, b"old" * 1000)
        with fill(folder):
            report = while_full(store)
            report["reserve_is_left"] = (folder / "reserve").exists()
        report["works_again"] = not refused(lambda: store.put_artifact("b", TABLE, bytes(2 * MB)))
        store.create(training("c"))
    with opened(folder, None) as store:
        report["states"] = {run.id: run.state for run in store.list().items}
        report["files"] = len([p for p in folder.glob("artifacts/*/*") if p.is_file()])
    sys.stdout.write(json.dumps(report))


def while_full(store: RunStore) -> dict[str, object]:
    messages = [refused(lambda: store.put_artifact("a", TABLE, bytes(2 * MB))) for _ in range(3)]
    began = time.monotonic()
    store.change("a", LIVE, "failed", error=messages[0])
    failed_after_s = time.monotonic() - began
    for done in range(50):
        store.update("b", done=done)
    return {
        "messages": messages,
        "failed_after_s": failed_after_s,
        "updated": store.get("b").done,
        "state": store.get("a").state,
        "listed": len(store.list().items),
        "old_file_is_whole": store.artifact("a", TABLE) == b"old" * 1000,
    }


def refused(write: Callable[[], object]) -> str | None:
    """Return the message with which a write is refused; None if it succeeds."""
    try:
        write()
    except StorageFull as error:
        return str(error)
    return None


@contextmanager
def filled_disk(folder: Path) -> Iterator[None]:
    """Fill the file system to the last byte by another file."""
    filler = folder / "filler"
    for size in (MB, 4096, 1):
        with contextlib.suppress(OSError), filler.open("ab", buffering=0) as file:
            while file.write(bytes(size)) == size:
                pass
    yield
    filler.unlink()


@contextmanager
def file_size_limit(folder: Path) -> Iterator[None]:
    """Simulate a full disk by RLIMIT_FSIZE: no file may grow beyond `LIMIT_BYTES`."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT_BYTES, hard))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
