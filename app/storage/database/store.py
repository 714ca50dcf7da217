"""The store that lasts: rows in a database, arrays in files beside it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any, TypeVar

from sqlalchemy import (
    ColumnElement,
    Connection,
    case,
    delete,
    func,
    insert,
    literal,
    or_,
    select,
    update,
)

from app.domain.errors import DamagedFile
from app.storage.artifact_file import ArtifactFile
from app.storage.artifacts import ArtifactFiles, StoredFile
from app.storage.database.columns import UtcTime
from app.storage.database.curves import Curves
from app.storage.database.engine import Database
from app.storage.database.keys import Keys
from app.storage.database.progress import Progress
from app.storage.database.queries import (
    RAW_RUN,
    Row,
    found,
    is_before,
    is_run,
    row_of_run,
    select_runs,
    shown_id,
)
from app.storage.database.rows import any_run_of, columns_of, row_of, run_of
from app.storage.database.schema import ARTIFACTS, RUNS
from app.storage.database.sessions import SqlSessionRows
from app.storage.database.trials import Trials
from app.storage.disk_space import START_BYTES
from app.storage.errors import Conflict, Damaged, StorageFailed
from app.storage.store import (
    KINDS,
    LIVE,
    RUNNING,
    UNENDED,
    AnyRun,
    Content,
    DamagedRun,
    IdempotencyKey,
    Kind,
    Page,
    Run,
    Started,
    State,
)

T = TypeVar("T")
_DIED = "The server ended before the run did."
_FILE = (ARTIFACTS.c.file, ARTIFACTS.c.size, ARTIFACTS.c.sha256)


class SqlStore:
    """Implements `RunStore`. What a call has done when it returns lasts, but for progress.

    Every call may also raise `StorageFailed`, if the database cannot be used, and those that
    write `StorageFull`; nothing has changed then.
    """

    def __init__(self, database: Database, files: ArtifactFiles) -> None:
        self._database, self._files = database, files
        self._progress = Progress()
        self._curves, self._trials, self._keys = Curves(database), Trials(database), Keys(database)
        self.sessions = SqlSessionRows(database)

    def check_disk_space(self) -> None:
        self._files.check_disk_space(START_BYTES)

    def create(self, *runs: Run, key: IdempotencyKey | None = None) -> None:
        if not runs:
            return
        rows = [row_of(run) for run in runs]

        def work(connection: Connection) -> None:
            connection.execute(insert(RUNS), rows)
            self._keys.note(connection, key, runs[-1].id)

        self._database.write(work)

    def add(
        self,
        run: Run,
        content: Content,
        new_id: Callable[[], str],
        key: IdempotencyKey | None = None,
    ) -> Run:
        stored: dict[str, StoredFile] = {}
        was_asked = False

        def work(connection: Connection) -> Run:
            taken = connection.execute(select(RUNS.c.id).where(RUNS.c.id == run.id)).first()
            added = run if taken is None else replace(run, id=new_id())
            connection.execute(insert(RUNS), [row_of(added)])
            self._curves.insert(connection, added.id, content.evaluations)
            self._trials.insert(connection, added.id, content.trials)
            if stored:
                connection.execute(insert(ARTIFACTS), _rows_of(added.id, stored))
            self._keys.note(connection, key, added.id)
            # As it will be read, so that what cannot be is not taken in.
            return run_of(row_of_run(connection, added.id))

        try:
            # Files first: whatever ends this process leaves no row, and the next start sweeps up.
            for name, data in content.artifacts.items():
                stored[name] = self._files.write(data)
            was_asked = True
            return self._database.write(work)
        except BaseException as error:
            # A database that fails may have taken it all the same, and the next start knows.
            if not (was_asked and isinstance(error, StorageFailed)):
                self._files.remove(*(one.file for one in stored.values()))
            raise

    def started_by(self, key: str) -> Started | None:
        return self._keys.find(key)

    def get(self, run_id: str) -> Run:
        run = self.find(run_id)
        if isinstance(run, DamagedRun):
            raise Damaged(run.id, run.damaged)
        return run

    def find(self, run_id: str) -> AnyRun:
        # Before the row, which has it once it is forgotten: so progress never goes back.
        progress = self._progress.of(run_id)
        row = self._database.read(lambda connection: row_of_run(connection, run_id))
        return any_run_of(_newest(row, progress))

    def list(
        self,
        kind: Kind | None = None,
        state: State | None = None,
        limit: int = 50,
        cursor: str | None = None,
    ) -> Page:
        wanted = select_runs().order_by(RUNS.c.id.desc()).limit(limit + 1)
        if state is not None:
            wanted = wanted.where(RUNS.c.state == state)

        def work(connection: Connection) -> Sequence[Row]:
            asked = wanted
            if kind is not None:
                asked = asked.where(_is_of_kind(connection, kind))
            if cursor is not None:
                asked = asked.where(is_before(connection, cursor))
            return found(connection, asked)

        progress = self._progress.newest()
        rows = self._database.read(work)
        return Page(
            [any_run_of(_newest(row, progress.get(row["id"], {}))) for row in rows[:limit]],
            shown_id(rows[limit - 1]["id"]) if len(rows) > limit else None,
        )

    def counts(self) -> Mapping[State, int]:
        wanted = select(RUNS.c.state, func.count()).group_by(RUNS.c.state)
        rows = self._database.read(lambda connection: connection.execute(wanted).all())
        return {state: count for state, count in rows}  # noqa: C416 - as a dict of plain types

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        progress = self._progress.of(run_id)
        columns = columns_of({**progress, "eta_s": None, "state": to_state, **fields})
        still = update(RUNS).where(RUNS.c.id == run_id, RUNS.c.state.in_(from_states))
        attempts = 0

        def work(connection: Connection) -> Row:
            nonlocal attempts
            attempts += 1
            changed = found(connection, still.values(columns).returning(*RAW_RUN))
            if not changed:
                run = row_of_run(connection, run_id)
                if attempts > 1 and run["state"] == to_state:
                    # The first attempt was committed, and its answer lost in an outage.
                    return run
                raise Conflict(f"{run['kind']} {run_id} is {run['state']}", run["state"])
            return changed[0]

        row = self._database.write(work)
        if to_state in LIVE:
            self._progress.forget_estimate(run_id)
        else:
            self._progress.forget(run_id)
        return run_of(_newest(row, {}))

    def update(self, run_id: str, **fields: Any) -> Run:
        progress = self._progress.of(run_id)
        values = columns_of(fields)
        statement = update(RUNS).where(RUNS.c.id == run_id).values(values).returning(*RAW_RUN)

        def work(connection: Connection) -> Row:
            changed = found(connection, statement)
            return changed[0] if changed else row_of_run(connection, run_id)

        row = self._database.write(work)
        self._note_written(run_id, fields)
        return run_of(_newest(row, {k: v for k, v in progress.items() if k not in fields}))

    def update_progress(self, run_id: str, done: int, eta_s: float | None = None) -> Run:
        if self._progress.note(run_id, {"done": done, "eta_s": eta_s}):
            statement = update(RUNS).where(RUNS.c.id == run_id).values(done=done, eta_s=eta_s)
            self._database.write(lambda connection: connection.execute(statement))
        return self.get(run_id)

    def delete(self, run_id: str) -> None:
        def work(connection: Connection) -> Sequence[str]:
            row = row_of_run(connection, run_id, and_hold=True)
            state = row["state"]
            if state in UNENDED:
                raise Conflict(f"{row['kind']} {run_id} is {state}; stop it first", state)
            is_it = is_run(connection, run_id)
            files = select(ARTIFACTS.c.file).where(
                ARTIFACTS.c.run_id.in_(select(RUNS.c.id).where(is_it))
            )
            names = connection.execute(files).scalars().all()
            connection.execute(delete(RUNS).where(is_it))
            return names

        self._files.remove(*self._database.write(work))
        self._progress.forget(run_id)

    def append_evaluations(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        self._curves.append(run_id, rows)

    def evaluations(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        return self._curves.of(run_id)

    def forget_evaluations(self, run_id: str, after_step: int) -> None:
        self._curves.forget(run_id, after_step)

    def append_trials(self, run_id: str, rows: Sequence[Mapping[str, Any]]) -> None:
        self._trials.append(run_id, rows)

    def trials(self, run_id: str) -> Sequence[Mapping[str, Any]]:
        return self._trials.of(run_id)

    def put_artifact(self, run_id: str, name: str, data: bytes, **fields: Any) -> None:
        self.get(run_id)
        columns = columns_of(fields)
        stored = self._files.write(data)
        of_this_name = ARTIFACTS.c.run_id == run_id, ARTIFACTS.c.name == name

        def work(connection: Connection) -> Sequence[str]:
            row_of_run(connection, run_id, and_hold=True)
            former = select(ARTIFACTS.c.file).where(*of_this_name)
            names = connection.execute(former).scalars().all()
            connection.execute(delete(ARTIFACTS).where(*of_this_name))
            connection.execute(insert(ARTIFACTS), _rows_of(run_id, {name: stored}))
            if columns:
                of_run = RUNS.c.id == run_id
                connection.execute(update(RUNS).where(of_run).values(columns))
            return names

        try:
            former = self._database.write(work)
        except BaseException as error:
            # A database that fails may have taken it all the same, and the next start knows.
            if not isinstance(error, StorageFailed):
                self._files.remove(stored.file)
            raise
        self._note_written(run_id, fields)
        # Itself is among them if the answer to a first attempt was lost.
        self._files.remove(*(name for name in former if name != stored.file))

    def artifact(self, run_id: str, name: str) -> bytes | None:
        return self._found(run_id, name, self._files.read)

    def open_artifact(self, run_id: str, name: str) -> ArtifactFile | None:
        return self._found(run_id, name, self._files.open)

    def _found(self, run_id: str, name: str, read: Callable[[StoredFile, str], T]) -> T | None:
        said = f"{name} of run {run_id}"
        missing: StoredFile | None = None
        while (stored := self._stored(run_id, name)) is not None:
            try:
                return read(stored, said)
            except FileNotFoundError as error:
                # It may have made way for a newer one since we asked.
                if stored == missing:
                    raise DamagedFile(f"{said} is missing from the data folder") from error
                missing = stored
        return None

    def interrupt_all(self) -> Sequence[str]:
        """Mark every run that has not ended as interrupted: the server that ran it is dead.

        Returns:
            their ids.
        """
        now = literal(datetime.now(UTC), UtcTime)
        # The clock may have been put back since it began.
        ended_at = case((RUNS.c.started_at > now, RUNS.c.started_at), else_=now)
        statement = (
            update(RUNS)
            .where(RUNS.c.state.in_(UNENDED))
            .values(state="interrupted", error=_DIED, eta_s=None, waiting_for=[], ended_at=ended_at)
            .returning(RUNS.c.id)
        )
        return self._database.write(
            lambda connection: connection.execute(statement).scalars().all()
        )

    def delete_orphans(self) -> int:
        """Delete the artifact files that no run references; only safe before the first write.

        Returns:
            the number of deleted files.
        """
        names = select(ARTIFACTS.c.file)
        files = self._database.read(lambda connection: connection.execute(names).scalars().all())
        return self._files.delete_orphans(files)

    def _note_written(self, run_id: str, fields: Mapping[str, Any]) -> None:
        if "done" in fields:
            self._progress.forget(run_id)

    def _stored(self, run_id: str, name: str) -> StoredFile | None:
        wanted = select(*_FILE).where(ARTIFACTS.c.run_id == run_id, ARTIFACTS.c.name == name)

        def work(connection: Connection) -> Sequence[Row]:
            row_of_run(connection, run_id)
            return found(connection, wanted)

        rows = self._database.read(work)
        return StoredFile(**rows[0]) if rows else None


def _is_of_kind(connection: Connection, kind: Kind) -> ColumnElement[bool]:
    """That a run is of this kind, or may be, since its own cannot be read."""
    odd = connection.execute(select(RUNS.c.id).where(RUNS.c.kind.not_in(KINDS))).scalars().all()
    return or_(RUNS.c.kind == kind, RUNS.c.kind.not_in(KINDS)) if odd else RUNS.c.kind == kind


def _rows_of(run_id: str, stored: Mapping[str, StoredFile]) -> list[Row]:
    now = datetime.now(UTC)
    return [
        {"run_id": run_id, "name": name, "written_at": now, **one._asdict()}
        for name, one in stored.items()
    ]


def _newest(row: Row, progress: Mapping[str, Any]) -> Row:
    """A row with newer progress while a process works on its run."""
    newest = {**row, **progress} if row["state"] in LIVE else dict(row)
    if row["state"] not in RUNNING:
        newest["eta_s"] = None
    return newest
