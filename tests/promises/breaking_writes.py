"""Fault injection: interrupt an operation at each of its writes, and report the remains as JSON.

For each kind of fault (`kill`: SIGKILL of the process; `full`: a full disk) and each operation, the
data folder is copied and a child process executes the operation; at one of its writes the process
is killed, or every further write fails. Then the folder is opened as by the next server, and
inspected.
"""

import errno
import json
import os
import random
import shutil
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Connection, Engine, event, select

from app.events.bus import EventBus
from app.features.experiments.trial_rows import Trials
from app.jobs import table_import
from app.jobs.jobs import Jobs
from app.jobs.messages import Batch, Began, Checkpointed, Ended, Saved, TrainingTask
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from app.storage.database.schema import ARTIFACTS
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, StorageFailed, StorageFull
from app.storage.recordings import Recordings
from app.storage.run import TABLE, IdempotencyKey, Run
from app.storage.run_ids import RunIds
from app.storage.stored_tables import load_table
from hexapods.agents.registry import BUILT_IN
from hexapods.assembly import build_learner
from hexapods.runs.config import WalkingProblem, training_config
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.results import training_result
from hexapods.runs.tables import snapshot, to_bytes
from hexapods.runs.training import train
from tests.features.archives.exported import export_run, import_run
from tests.features.experiments.ended_experiments import ended_experiment
from tests.jobs.played import played_job
from tests.storage.ended_runs import GAIT, ended_training
from tests.storage.stores import opened, training

KEPT_ID, MOVED_ID, EXPERIMENT_ID, LEARNING_ID = (
    "00000000000k1",
    "00000000000m1",
    "00000000000e1",
    "00000000000g1",
)
KEY = IdempotencyKey("key", "0" * 64)
CONFIG = training_config(gait=GAIT, simulator="kinematic", steps=60, evaluate_every=2)
TEMPLATE, FOLDER = "template", "tried"


class Breaker:
    """Counts the writes of this process, and injects the fault at one of them."""

    def __init__(self, artifacts: Path, how: str, at: int) -> None:
        self._artifacts, self._how, self.at = str(artifacts), how, at
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
        return self._how == "full" and 0 < self.at <= self.count

    def _count(self) -> None:
        self.count += 1
        if self._how == "kill" and self.count == self.at:
            os.kill(os.getpid(), signal.SIGKILL)

    def _audit(self, name: str, arguments: tuple[Any, ...]) -> None:
        writes = name == "open" and isinstance(arguments[1], str) and arguments[1][:1] in "xwa"
        if not (writes or name in ("os.rename", "os.remove")):
            return
        if not str(arguments[0]).startswith(self._artifacts):
            return
        self._count()
        if self.is_full and writes:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _statement(self, connection: Connection, cursor: Any, statement: str, *more: Any) -> None:
        if statement.startswith(("INSERT", "UPDATE", "DELETE")):
            self._count()
            if self.is_full:
                # Simulates a full disk: the database may not grow by a page.
                pages = cursor.connection.execute("PRAGMA page_count").fetchone()[0]
                cursor.connection.execute(f"PRAGMA max_page_count = {pages}")

    def _commit(self, connection: Connection) -> None:
        self._count()


# ---- operations


def import_archive(store: RunStore, folder: Path) -> None:
    data = (folder.parent / "run.zip").read_bytes()
    import_run(store, data, RunIds.of(store), "run.zip", key=KEY)


def import_experiment(store: RunStore, folder: Path) -> None:
    data = (folder.parent / "experiment.zip").read_bytes()
    import_run(store, data, RunIds.of(store), "experiment.zip", key=KEY)


def import_table(store: RunStore, folder: Path) -> None:
    table_import.import_table(
        _jobs(store), (folder.parent / "table.npz").read_bytes(), tuple(BUILT_IN), "Moved", KEY
    )


def start(store: RunStore, folder: Path) -> None:
    walk = WalkingProblem(gait=GAIT, simulator="kinematic")
    lanes = [
        LaneStart("q-learning", training=TrainingStart(CONFIG, "Its practice")),
        LaneStart("greedy"),
    ]
    _jobs(store).start(RaceStart(walk, lanes, 5, 0, "Started"), KEY)


def finish(store: RunStore, folder: Path) -> None:
    """Feed a job the messages of its process: the last checkpoint, the table, the end."""
    run = store.get(LEARNING_ID)
    _, take = played_job(run, TrainingTask(CONFIG, None), store, EventBus())
    learner = build_learner(CONFIG)
    rest = learner.walker.simulator.pose(learner.walker.state).astype(np.float32)
    take(Began((rest,), 0))
    records = list(train(learner, CONFIG, record=True))
    take(Batch(tuple(r for r in records if isinstance(r, StepTaken | Evaluated)), CONFIG.steps))
    data = to_bytes(snapshot(learner, CONFIG, changes=[]))
    take(Checkpointed(data, CONFIG.steps))
    take(Saved(data))
    take(Ended("finished", training_result(learner, CONFIG)))


def delete(store: RunStore, folder: Path) -> None:
    store.delete(KEPT_ID)


OPERATIONS: dict[str, Callable[[RunStore, Path], None]] = {
    call.__name__: call
    for call in (import_archive, import_experiment, import_table, start, finish, delete)
}


def _jobs(store: RunStore) -> Jobs:
    return Jobs(store, Recordings(store), EventBus(), cores=1)


# ---- one attempt


def prepare(folder: Path) -> None:
    """Create the template data folder, and files to import."""
    with opened(folder / "source", None) as store:
        ended_training(store, MOVED_ID, "Moved", steps=120)
        ended_experiment(store, EXPERIMENT_ID)
        (folder / "run.zip").write_bytes(export_run(store, MOVED_ID))
        (folder / "experiment.zip").write_bytes(export_run(store, EXPERIMENT_ID))
        (folder / "table.npz").write_bytes(store.artifact(MOVED_ID, TABLE) or b"")
    with opened(folder / TEMPLATE, None) as store:
        ended_training(store, KEPT_ID, "Kept", steps=120)


def attempt(folder: Path, operation: str, how: str, at: int) -> dict[str, Any]:
    """Execute an operation in a child process, interrupted at one of its writes."""
    attempt_folder = folder / FOLDER
    shutil.rmtree(attempt_folder, ignore_errors=True)
    shutil.copytree(folder / TEMPLATE, attempt_folder)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writing, json.dumps(_do(attempt_folder, operation, how, at)).encode())
        except BaseException:
            os.write(writing, json.dumps({"broke": traceback.format_exc()}).encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        output = pipe.read()
    _, status = os.waitpid(child, 0)
    report: dict[str, Any] = {"operation": operation, "how": how, "at": at}
    report |= {"killed": os.WIFSIGNALED(status), **(json.loads(output) if output else {})}
    with opened(attempt_folder, None) as store:
        report |= {"after": inspect_store(store, attempt_folder)}
    return report


def _do(folder: Path, operation: str, how: str, at: int) -> dict[str, Any]:
    with opened(folder, None) as store:
        if operation == "finish":
            run = training(LEARNING_ID, name="Learned", config=CONFIG, total=CONFIG.steps)
            store.create(run)
            store.change(LEARNING_ID, {"queued"}, "running")
        breaker = Breaker(folder / "artifacts", how, at)
        breaker.install(store.database.engine)
        refused = None
        try:
            OPERATIONS[operation](store, folder)
        except (StorageFull, StorageFailed) as error:
            refused = f"{type(error).__name__}: {error}"
        count = breaker.count
        if how == "kill" and count < at:
            os.kill(os.getpid(), signal.SIGKILL)
        breaker.at = 0
        return {"writes": count, "refused": refused, "at_once": inspect_store(store, folder)}


def inspect_store(store: RunStore, folder: Path) -> dict[str, Any]:
    """Return the contents of a store: its runs with their data, and inconsistencies of files."""
    runs = [_whole(store, run) for run in store.list().runs]
    referenced = store.database.read(lambda c: c.execute(select(ARTIFACTS.c.file)).scalars().all())
    on_disk = [path.name for path in folder.glob("artifacts/*/*") if path.is_file()]
    key = store.keys.find(KEY.key)
    return {
        "runs": sorted(runs, key=lambda run: str(run["name"])),
        "key_is_of": None if key is None else store.get(key.run_ids[-1]).name,
        "missing_files": len(set(referenced) - set(on_disk)),
        "files_of_nobody": len(set(on_disk) - set(referenced)),
    }


def _whole(store: RunStore, run: Run) -> dict[str, Any]:
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
        "evaluations": len(store.curves.get(run.id)),
        "recorded": 0 if recorded is None else len(recorded.evaluations),
        "trials": len(Trials(store.database).get(run.id)),
    }


def main(folder: Path, share: float) -> None:
    """Test a share of all writes; each operation's first line is its report without a fault."""
    prepare(folder)
    chance = random.Random(32)
    for operation in OPERATIONS:
        whole = attempt(folder, operation, "none", 0)
        emit(whole)
        for how in ("kill", "full"):
            for at in range(1, whole["writes"] + 2):
                if chance.random() < share:
                    emit(attempt(folder, operation, how, at))


def emit(report: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(report) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]))
