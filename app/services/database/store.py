"""The store that lasts: rows in a database, arrays in files beside it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, TypeVar

from sqlalchemy import Connection, case, delete, func, insert, literal, select, update

from app.domain.errors import DamagedFile
from app.services.artifact_file import ArtifactFile
from app.services.artifacts import ArtifactFiles, Stored
from app.services.database.columns import UtcTime
from app.services.database.curves import Curves
from app.services.database.engine import Database
from app.services.database.finding import Row, found, row_of_run
from app.services.database.progress import Progress
from app.services.database.rows import columns_of, row_of, run_of
from app.services.database.schema import ARTIFACTS, RUNS
from app.services.database.trials import Trials
from app.services.errors import Conflict, NotFound, StorageFull
from app.services.room import START_BYTES
from app.services.store import UNENDED, Kind, Page, Run, State

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
        self._curves, self._trials = Curves(database), Trials(database)

    def check_room(self) -> None:
        self._files.check_room(START_BYTES)

    def create(self, *runs: Run) -> None:
        rows = [row_of(run) for run in runs]
        if rows:
            self._database.write(lambda connection: connection.execute(insert(RUNS), rows))

    def get(self, run_id: str) -> Run:
        return self._as_run(self._database.read(lambda connection: row_of_run(connection, run_id)))

    def list(
        self,
        kind: Kind | None = None,
        state: State | None = None,
        limit: int = 50,
        cursor: str | None = None,
    ) -> Page:
        wanted = select(RUNS).order_by(RUNS.c.id.desc()).limit(limit + 1)
        if kind is not None:
            wanted = wanted.where(RUNS.c.kind == kind)
        if state is not None:
            wanted = wanted.where(RUNS.c.state == state)
        if cursor is not None:
            wanted = wanted.where(RUNS.c.id < cursor)
        rows = self._database.read(lambda connection: found(connection, wanted))
        runs = [self._as_run(row) for row in rows[:limit]]
        return Page(runs, runs[-1].id if len(rows) > limit else None)

    def counts(self) -> Mapping[State, int]:
        wanted = select(RUNS.c.state, func.count()).group_by(RUNS.c.state)
        rows = self._database.read(lambda connection: connection.execute(wanted).all())
        return {state: count for state, count in rows}  # noqa: C416 - as a dict of plain types

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        # Whoever reads meanwhile sees the progress until the row has it.
        columns = columns_of({**self._progress.of(run_id), "state": to_state, **fields})

        still = update(RUNS).where(RUNS.c.id == run_id, RUNS.c.state.in_(from_states))

        def work(connection: Connection) -> Row:
            changed = found(connection, still.values(columns).returning(RUNS))
            if not changed:
                run = row_of_run(connection, run_id)
                raise Conflict(f"{run['kind']} {run_id} is {run['state']}", run["state"])
            return changed[0]

        row = self._database.write(work)
        self._progress.take(run_id)
        return run_of(row)

    def update(self, run_id: str, **fields: Any) -> Run:
        columns = columns_of({**self._progress.of(run_id), **fields})
        statement = update(RUNS).where(RUNS.c.id == run_id).values(columns).returning(RUNS)

        def work(connection: Connection) -> Row:
            changed = found(connection, statement)
            return changed[0] if changed else row_of_run(connection, run_id)

        row = self._database.write(work)
        self._progress.take(run_id)
        return run_of(row)

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
            files = select(ARTIFACTS.c.file).where(ARTIFACTS.c.run_id == run_id)
            names = connection.execute(files).scalars().all()
            connection.execute(delete(RUNS).where(RUNS.c.id == run_id))
            return names

        self._files.remove(*self._database.write(work))
        self._progress.take(run_id)

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
        columns = columns_of({**self._progress.of(run_id), **fields}) if fields else {}
        stored = self._files.write(data)
        of_this_name = ARTIFACTS.c.run_id == run_id, ARTIFACTS.c.name == name
        row = {"run_id": run_id, "name": name, "written_at": datetime.now(UTC)}

        def work(connection: Connection) -> Sequence[str]:
            row_of_run(connection, run_id, and_hold=True)
            former = select(ARTIFACTS.c.file).where(*of_this_name)
            names = connection.execute(former).scalars().all()
            connection.execute(delete(ARTIFACTS).where(*of_this_name))
            connection.execute(insert(ARTIFACTS), [{**row, **stored._asdict()}])
            if columns:
                of_run = RUNS.c.id == run_id
                connection.execute(update(RUNS).where(of_run).values(columns))
            return names

        try:
            former = self._database.write(work)
        except (NotFound, StorageFull):
            # After any other error the database may have taken it, and the next start knows.
            self._files.remove(stored.file)
            raise
        if columns:
            self._progress.take(run_id)
        self._files.remove(*former)

    def artifact(self, run_id: str, name: str) -> bytes | None:
        return self._found(run_id, name, self._files.read)

    def open_artifact(self, run_id: str, name: str) -> ArtifactFile | None:
        return self._found(run_id, name, self._files.open)

    def _found(self, run_id: str, name: str, read: Callable[[Stored, str], T]) -> T | None:
        said = f"{name} of run {run_id}"
        missing: Stored | None = None
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

    def sweep(self) -> int:
        """Remove the files that no run has; to be called before anyone writes.

        Returns:
            how many files that were.
        """
        known = select(ARTIFACTS.c.file)
        files = self._database.read(lambda connection: connection.execute(known).scalars().all())
        return self._files.sweep(files)

    def _stored(self, run_id: str, name: str) -> Stored | None:
        wanted = select(*_FILE).where(ARTIFACTS.c.run_id == run_id, ARTIFACTS.c.name == name)

        def work(connection: Connection) -> Sequence[Row]:
            row_of_run(connection, run_id)
            return found(connection, wanted)

        rows = self._database.read(work)
        return Stored(**rows[0]) if rows else None

    def _as_run(self, row: Row) -> Run:
        return run_of({**row, **self._progress.of(row["id"])})
