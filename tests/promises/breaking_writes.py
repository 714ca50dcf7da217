"""Breaks off each write of an operation in turn, and says as JSON what was left of it.

For each way (`kill`: SIGKILL of the process; `full`: a full disk) and each operation, the data
folder is copied, a process of its own opens it and does the operation, and at one of its writes it
is killed, or no further write has room. Then the folder is opened as by the next server, and looked
at.
"""

import errno
import json
import os
import random
import shutil
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Connection, Engine, event, select

from app.agents.registry import OURS
from app.archive.table_import import adopt
from app.archive.transfer import export_run, import_run
from app.assembly import build_learner, finish_training
from app.events.bus import EventBus
from app.jobs.job import Job
from app.jobs.jobs import Jobs
from app.jobs.messages import Batch, Began, Checkpointed, Ended, Saved, TrainingTask
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart, load_table
from app.runs.config import TrainingConfig, WalkingProblem
from app.runs.records import Evaluated, StepTaken
from app.runs.tables import snapshot, to_bytes
from app.runs.training import train
from app.storage.database.schema import ARTIFACTS
from app.storage.database.store import SqlStore
from app.storage.errors import Conflict, StorageFailed, StorageFull
from app.storage.recordings import Recordings
from app.storage.run_ids import RunIds
from app.storage.store import TABLE, IdempotencyKey, Run
from tests.storage.ended import GAIT, ended_experiment, ended_training
from tests.storage.stores import opened, training

KEPT, MOVED, TRIED, LEARNING = "00000000000k1", "00000000000m1", "00000000000e1", "00000000000g1"
KEY = IdempotencyKey("key", "0" * 64)
CONFIG = TrainingConfig(gait=GAIT, simulator="kinematic", steps=60, evaluate_every=2)
TEMPLATE, FOLDER = "template", "tried"


class Breaker:
    """Counts the writes of this process, and breaks off at one of them."""

    def __init__(self, artifacts: Path, how: str, at: int) -> None:
        self._artifacts, self._how, self._at = str(artifacts), how, at
        self.count = 0

    def install(self, engine: Engine) -> None:
        sys.addaudithook(self._audit)
        event.listen(engine, "before_cursor_execute", self._statement)
        event.listen(engine, "commit", self._commit)
        fsync = os.fsync

        def counted(descriptor: Any) -> None:
            self._count()
            fsync(descriptor)

        os.fsync = counted  # type: ignore[assignment] # a name of a parameter is another

    @property
    def is_full(self) -> bool:
        return self._how == "full" and 0 < self._at <= self.count

    def _count(self) -> None:
        self.count += 1
        if self._how == "kill" and self.count == self._at:
            os.kill(os.getpid(), signal.SIGKILL)

    def _audit(self, name: str, given: tuple[Any, ...]) -> None:
        writes = name == "open" and isinstance(given[1], str) and given[1][:1] in "xwa"
        if not (writes or name in ("os.rename", "os.remove")):
            return
        if not str(given[0]).startswith(self._artifacts):
            return
        self._count()
        if self.is_full and writes:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _statement(self, connection: Connection, cursor: Any, statement: str, *more: Any) -> None:
        if statement.startswith(("INSERT", "UPDATE", "DELETE")):
            self._count()
            if self.is_full:
                # No page more than there is, as on a disk that is full.
                pages = cursor.connection.execute("PRAGMA page_count").fetchone()[0]
                cursor.connection.execute(f"PRAGMA max_page_count = {pages}")

    def _commit(self, connection: Connection) -> None:
        self._count()


# ---- operations: each returns what is to be compared if it came to its end


def import_archive(store: SqlStore, folder: Path) -> None:
    data = (folder.parent / "run.zip").read_bytes()
    import_run(store, data, RunIds.of(store), tuple(OURS), "run.zip", key=KEY)


def import_experiment(store: SqlStore, folder: Path) -> None:
    data = (folder.parent / "experiment.zip").read_bytes()
    import_run(store, data, RunIds.of(store), tuple(OURS), "experiment.zip", key=KEY)


def import_table(store: SqlStore, folder: Path) -> None:
    adopt(_jobs(store), (folder.parent / "table.npz").read_bytes(), tuple(OURS), "Moved", KEY)


def start(store: SqlStore, folder: Path) -> None:
    walk = WalkingProblem(gait=GAIT, simulator="kinematic")
    lanes = [
        LaneStart("q-learning", training=TrainingStart(CONFIG, "Its practice")),
        LaneStart("greedy"),
    ]
    _jobs(store).race(RaceStart(walk, lanes, 5, 0, "Started"), KEY)


def finish(store: SqlStore, folder: Path) -> None:
    """What a job's process says, taken in by its job: the last checkpoint, the table, the end."""
    run = store.get(LEARNING)
    recordings = Recordings(store)
    order, shutdown = TrainingTask(CONFIG, None), threading.Event()
    job = Job(run, order, store, recordings, EventBus(), shutdown=shutdown, niceness=0)
    learner = build_learner(CONFIG)
    rest = learner.walker.simulator.pose(learner.walker.state).astype(np.float32)
    take = job._handle
    take(Began((rest,), 0))
    records = list(train(learner, CONFIG, record=True))
    take(Batch(tuple(r for r in records if isinstance(r, StepTaken | Evaluated)), CONFIG.steps))
    data = to_bytes(snapshot(learner, CONFIG, changes=[]))
    take(Checkpointed(data, CONFIG.steps))
    take(Saved(data))
    take(Ended("finished", finish_training(learner, CONFIG)))


def delete(store: SqlStore, folder: Path) -> None:
    store.delete(KEPT)


OPERATIONS: dict[str, Callable[[SqlStore, Path], None]] = {
    one.__name__: one
    for one in (import_archive, import_experiment, import_table, start, finish, delete)
}


def _jobs(store: SqlStore) -> Jobs:
    return Jobs(store, Recordings(store), EventBus(), cores=1)


# ---- one try


def prepare(folder: Path) -> None:
    """A data folder to try on, and files to import."""
    with opened(folder / "source", None) as store:
        ended_training(store, MOVED, "Moved", steps=120)
        ended_experiment(store, TRIED)
        (folder / "run.zip").write_bytes(export_run(store, MOVED))
        (folder / "experiment.zip").write_bytes(export_run(store, TRIED))
        (folder / "table.npz").write_bytes(store.artifact(MOVED, TABLE) or b"")
    with opened(folder / TEMPLATE, None) as store:
        ended_training(store, KEPT, "Kept", steps=120)


def attempt(folder: Path, operation: str, how: str, at: int) -> dict[str, Any]:
    """Do an operation that breaks off at one of its writes, in a process of its own."""
    tried = folder / FOLDER
    shutil.rmtree(tried, ignore_errors=True)
    shutil.copytree(folder / TEMPLATE, tried)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writing, json.dumps(_do(tried, operation, how, at)).encode())
        except BaseException:
            os.write(writing, json.dumps({"broke": traceback.format_exc()}).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        said = pipe.read()
    _, status = os.waitpid(child, 0)
    report: dict[str, Any] = {"operation": operation, "how": how, "at": at}
    report |= {"killed": os.WIFSIGNALED(status), **(json.loads(said) if said else {})}
    with opened(tried, None) as store:
        report |= {"after": looked_at(store, tried)}
    return report


def _do(folder: Path, operation: str, how: str, at: int) -> dict[str, Any]:
    with opened(folder, None) as store:
        if operation == "finish":
            run = training(LEARNING, name="Learned", config=CONFIG, total=CONFIG.steps)
            store.create(run)
            store.change(LEARNING, {"queued"}, "running")
        breaker = Breaker(folder / "artifacts", how, at)
        breaker.install(store._database.engine)
        refused = None
        try:
            OPERATIONS[operation](store, folder)
        except (StorageFull, StorageFailed) as error:
            refused = f"{type(error).__name__}: {error}"
        count = breaker.count
        if how == "kill" and count < at:
            os.kill(os.getpid(), signal.SIGKILL)
        breaker._at = 0
        return {"writes": count, "refused": refused, "at_once": looked_at(store, folder)}


def looked_at(store: SqlStore, folder: Path) -> dict[str, Any]:
    """All that is in a store: its runs with what they have, and its files."""
    runs = [_whole(store, run) for run in store.list().runs]
    known = store._database.read(lambda c: c.execute(select(ARTIFACTS.c.file)).scalars().all())
    on_disk = [path.name for path in folder.glob("artifacts/*/*") if path.is_file()]
    key = store.find_key(KEY.key)
    return {
        "runs": sorted(runs, key=lambda run: str(run["name"])),
        "key_is_of": None if key is None else store.get(key.run_id).name,
        "missing_files": len(set(known) - set(on_disk)),
        "files_of_nobody": len(set(on_disk) - set(known)),
    }


def _whole(store: SqlStore, run: Run) -> dict[str, Any]:
    try:
        has_table = run.kind == "training" and load_table(store, run.id) is not None
    except Conflict:
        has_table = False
    recorded = Recordings(store).training(run.id)
    return {
        "name": run.name,
        "state": run.state,
        "has_result": run.result is not None,
        "has_table": has_table,
        "evaluations": len(store.evaluations(run.id)),
        "recorded": 0 if recorded is None else len(recorded.evaluations),
        "trials": len(store.trials(run.id)),
    }


def main(folder: Path, share: float) -> None:
    """Try a share of all writes; the first line is what each operation leaves if nothing breaks."""
    prepare(folder)
    chance = random.Random(32)
    for operation in OPERATIONS:
        whole = attempt(folder, operation, "none", 0)
        say(whole)
        for how in ("kill", "full"):
            for at in range(1, whole["writes"] + 2):
                if chance.random() < share:
                    say(attempt(folder, operation, how, at))


def say(report: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(report) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]))
