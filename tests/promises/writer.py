"""Write to a store as a job does, and print each acknowledged write, until killed."""

import sys
from pathlib import Path

from tests.storage.stores import opened, training

CHECKPOINT = "q-table.npz"


def checkpoint(step: int) -> bytes:
    """Build a file whose content identifies its step and reveals truncation."""
    return f"{step:08}".encode() * 5_000


def main(folder: str, url: str, first: int) -> None:
    with opened(Path(folder), url or None) as store:
        for number in range(first, first + 1_000_000):
            run_id = f"{number:06}"
            store.create(training(run_id, total=1000, state="running"))
            emit(f"created {run_id}")
            for step in range(1, 6):
                store.curves.append(
                    run_id, [{"step": step, "distance_m": step / 8, "epsilon": 0.5}]
                )
                emit(f"evaluated {run_id} {step}")
                store.put_artifact(run_id, CHECKPOINT, checkpoint(step))
                emit(f"saved {run_id} {step}")
            store.change(run_id, {"running"}, "finished", done=5)
            emit(f"finished {run_id}")


def emit(line: str) -> None:
    """Print a line by a single write, so that a kill leaves no partial line."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
