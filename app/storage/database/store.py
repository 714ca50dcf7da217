"""The run store: rows in SQLite or PostgreSQL, artifacts in files beside it."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import (
    ColumnElement,
    Connection,
    String,
    Update,
    case,
    cast,
    delete,
    func,
    insert,
    literal,
    or_,
    select,
    update,
)

from app.storage.artifact_file import ArtifactFile
from app.storage.artifacts import ArtifactFiles, StoredFile
from app.storage.database.artifact_rows import Artifacts
from app.storage.database.baselines import StoredBaselines
from app.storage.database.columns import UtcTime
from app.storage.database.curves import Curves
from app.storage.database.deletions import Deletions
from app.storage.database.engine import Database
from app.storage.database.keys import Keys
from app.storage.database.listing import Listing, fetch_page
from app.storage.database.progress import ProgressCache
from app.storage.database.queries import (
    NOT_DELETED,
    RAW_RUN,
    Row,
    fetch_rows,
    fetch_run_row,
    has_public_id,
    select_runs,
)
from app.storage.database.robots import RobotStore
from app.storage.database.rows import decode_run, encode_fields, encode_run, try_decode_run
from app.storage.database.schema import RUNS
from app.storage.disk_space import START_BYTES
from app.storage.errors import Conflict, Damaged, StorageFailed
from app.storage.run import (
    LIVE,
    NOT_ENDED,
    RUNNING,
    AnyRun,
    Content,
    DamagedRun,
    IdempotencyKey,
    Kind,
    ListedRuns,
    Run,
    Sort,
    State,
    robots_of,
)
from app.storage.sessions import SessionRows

_IDS_AT_ONCE = 1_000
_INTERRUPTED_ERROR = "The server ended before the run did."


class RunStore:
    """Stores runs, curves and artifacts in a database. Thread-safe.

    Calls are durable on return, except `update_progress`. Every call may also raise
    `StorageFailed` if the database is unavailable, and every write `StorageFull`; nothing has
    changed then.

    Attributes:
        database: database with the rows.
        files: files of the artifacts.
        curves: learning curves of trainings.
        baselines: distances of one-step look-ahead, which all jobs share.
        kinds: names of the kinds of runs that are not left out.
        keys: idempotency keys.
        robots: stored robots.
        deletions: deletes rows so that they can be restored for a while.
        sessions: storage of operators' browser sessions, in the same database.
        is_public: condition that a run may be shown to everybody; None for all.
    """

    def __init__(
        self,
        database: Database,
        files: ArtifactFiles,
        robots: RobotStore,
        deletions: Deletions,
        kinds: Collection[str],
    ) -> None:
        self.database, self.files, self.robots, self.kinds = database, files, robots, kinds
        self.deletions = deletions
        deletions.purges[RUNS.name] = self._purge
        self._progress = ProgressCache()
        self._artifacts = Artifacts(database, files)
        self.curves, self.keys = Curves(database), Keys(database)
        self.baselines = StoredBaselines(database)
        self.sessions = SessionRows(database)
        self.is_public: ColumnElement[bool] | None = None

    def check_disk_space(self, size: int = START_BYTES) -> None:
        """Check that there is disk space, before work whose result is stored.

        Args:
            size: size of the data that are to be stored [bytes]; by default that of one more run.

        Raises:
            StorageFull: if there is too little.
        """
        self.files.check_disk_space(size)

    def check_writable(self) -> None:
        """Check that the last write to the database succeeded, or one that was tried since then.

        Raises:
            StorageFailed: if it failed.
        """
        if (problem := self.database.write_problem) is not None:
            raise StorageFailed(str(problem))

    def create(self, *runs: Run, key: IdempotencyKey | None = None) -> None:
        """Insert new runs, all or none, in one transaction.

        Args:
            runs: in order of insertion.
            key: idempotency key of the request that starts the last of them, stored in the same
                transaction.

        Raises:
            NotFound: if a stored robot of them was deleted meanwhile.
        """
        if not runs:
            return

        def work(connection: Connection) -> None:
            for run in runs:
                self.robots.check(connection, robots_of(run.config))
            connection.execute(insert(RUNS), [encode_run(run) for run in runs])
            self.keys.insert(connection, key, [runs[-1].id])

        self.database.write(work)

    def add(
        self,
        imported: Sequence[tuple[Run, Content]],
        new_id: Callable[[], str],
        key: IdempotencyKey | None = None,
    ) -> Sequence[Run]:
        """Insert ended runs with their content (used by imports), all or none, atomically.

        Args:
            imported: each run, which keeps its id if that is free in this store, and its content;
                robots are stored unless they are already.
            new_id: creates an id if a run's own is already in use.
            key: idempotency key of the request, stored in the same transaction.

        Returns:
            the runs as stored.

        Raises:
            StorageFull: if there is too little disk space; nothing is left behind then.
        """
        # A run that was deleted gives way to its import, which has its id.
        ids = [run.id for run, _ in imported]
        self.deletions.purge_rows(RUNS, RUNS.c.id.in_(ids))
        stored: list[dict[str, StoredFile]] = [{} for _ in imported]
        was_submitted = False
        robots = [robot for _, content in imported for robot in content.robots]

        with self.robots.adding(robots) as new_robots:

            def work(connection: Connection) -> Sequence[Run]:
                self.robots.insert(connection, new_robots)
                added = []
                for (run, content), files in zip(imported, stored, strict=True):
                    added.append(self._insert(connection, run, content, files, new_id))
                self.keys.insert(connection, key, [run.id for run in added])
                return added

            try:
                # Files first: a crash then leaves orphaned files, which the next start deletes, but
                # never a row without its files.
                for (_, content), files in zip(imported, stored, strict=True):
                    for name, data in content.artifacts.items():
                        files[name] = self.files.write(data)
                was_submitted = True
                return self.database.write(work)
            except BaseException as error:
                # After an outage the transaction may have been committed with its reply lost. The
                # files stay then; if they are orphans, the next start deletes them.
                if not (was_submitted and isinstance(error, StorageFailed)):
                    self.files.remove(*(file.file for files in stored for file in files.values()))
                raise

    def _insert(
        self,
        connection: Connection,
        run: Run,
        content: Content,
        files: Mapping[str, StoredFile],
        new_id: Callable[[], str],
    ) -> Run:
        existing = connection.execute(select(RUNS.c.id).where(RUNS.c.id == run.id)).first()
        added = run if existing is None else replace(run, id=new_id())
        connection.execute(insert(RUNS), [{**encode_run(added), "is_imported": True}])
        self.curves.insert(connection, added.id, content.evaluations)
        for table, rows in content.rows.items():
            if rows:
                connection.execute(insert(table), [{"run_id": added.id, **row} for row in rows])
        self._artifacts.insert(connection, added.id, files)
        # Decoded again, so that a run that could not be read later is rejected now.
        return decode_run(fetch_run_row(connection, added.id), self.kinds)

    def get(self, run_id: str) -> Run:
        """Return the run with its newest progress.

        Raises:
            NotFound: if there is no such run.
            Damaged: if it cannot be decoded.
        """
        run = self.find(run_id)
        if isinstance(run, DamagedRun):
            raise Damaged(run.id, run.damaged)
        return run

    def find(self, run_id: str) -> AnyRun:
        """Return the run with its newest progress, or a `DamagedRun` if it cannot be decoded.

        Raises:
            NotFound: if there is no such run.
        """
        # Read before the row: an entry is dropped only after its row was written, so that the
        # progress seen by a reader never decreases.
        progress = self._progress.get(run_id)
        row = self.database.read(lambda connection: fetch_run_row(connection, run_id))
        return self._try_decode(row, progress)

    def is_imported(self, run_id: str) -> bool:
        """Whether a run was imported, and so ran elsewhere; False also if there is none."""
        query = select(RUNS.c.id).where(RUNS.c.id == run_id, RUNS.c.is_imported.is_(True))
        return self.database.read(lambda connection: connection.execute(query).first()) is not None

    def list(
        self,
        kind: Kind | None = None,
        state: State | None = None,
        limit: int = 50,
        *,
        cursor: str | None = None,
        search: str | None = None,
        tag: str | None = None,
        sort: Sort = "newest",
        condition: ColumnElement[bool] | None = None,
    ) -> ListedRuns:
        """Return one page of runs; the arguments are those of a `Listing`.

        A run that cannot be decoded is listed in its place as a `DamagedRun`.

        Raises:
            InvalidInput: if the cursor is not one of a list in this order.
        """
        listing = Listing(kind, state, limit, cursor, search, tag, sort, condition)
        progress = self._progress.snapshot()
        rows, cursor = self.database.read(lambda connection: fetch_page(connection, listing))
        return ListedRuns(
            [self._try_decode(row, progress.get(row["id"], {})) for row in rows],
            cursor,
        )

    def users_of_table(self, training_id: str) -> Sequence[Run]:
        """Return the races and trainings that name a training's table; unreadable ones left out."""
        named = cast(RUNS.c.lane_training_ids, String).contains(f'"{training_id}"', autoescape=True)
        query = select_runs().where(or_(named, RUNS.c.continued_from == training_id))
        rows = self.database.read(lambda connection: fetch_rows(connection, query))
        progress = self._progress.snapshot()
        runs = (self._try_decode(row, progress.get(row["id"], {})) for row in rows)
        return [run for run in runs if isinstance(run, Run)]

    def counts(self) -> Mapping[State, int]:
        """Return the number of runs by state, for states that have any."""
        query = select(RUNS.c.state, func.count()).where(NOT_DELETED).group_by(RUNS.c.state)
        rows = self.database.read(lambda connection: connection.execute(query).all())
        return {state: count for state, count in rows}  # noqa: C416 - as a dict of plain types

    def change(
        self, run_id: str, from_states: Collection[State], to_state: State, **fields: Any
    ) -> Run:
        """Change the state and other fields if the state is in `from_states` (compare-and-set).

        `eta_s` is reset to None unless it is among the fields.

        Raises:
            NotFound: if there is no such run.
            Conflict: if its state is not in `from_states`.
        """
        progress = self._progress.get(run_id)
        columns = encode_fields({**progress, "eta_s": None, "state": to_state, **fields})
        unchanged = update(RUNS).where(RUNS.c.id == run_id, RUNS.c.state.in_(from_states))
        attempts = 0

        def work(connection: Connection) -> Row:
            nonlocal attempts
            attempts += 1
            changed = fetch_rows(connection, unchanged.values(columns).returning(*RAW_RUN))
            if not changed:
                run = fetch_run_row(connection, run_id)
                if attempts > 1 and run["state"] == to_state:
                    # The first attempt was committed, and its reply lost in an outage.
                    return run
                raise Conflict(f"{run['kind']} {run_id} is {run['state']}", run["state"])
            return changed[0]

        row = self.database.write(work)
        if to_state in LIVE:
            self._progress.drop_estimate(run_id)
        else:
            self._progress.drop(run_id)
        return decode_run(_with_progress(row, {}), self.kinds)

    def update(self, run_id: str, **fields: Any) -> Run:
        """Set fields other than the state.

        Raises:
            NotFound: if there is no such run.
        """
        progress = self._progress.get(run_id)
        values = encode_fields(fields)
        statement = update(RUNS).where(RUNS.c.id == run_id).values(values).returning(*RAW_RUN)

        def work(connection: Connection) -> Row:
            changed = fetch_rows(connection, statement)
            return changed[0] if changed else fetch_run_row(connection, run_id)

        row = self.database.write(work)
        self._invalidate_progress(run_id, fields)
        unchanged = {name: value for name, value in progress.items() if name not in fields}
        return decode_run(_with_progress(row, unchanged), self.kinds)

    def update_progress(self, run_id: str, done: int, eta_s: float | None = None) -> None:
        """Set the progress of a run and the estimated time left [s].

        Readers of this store see it at once; it is durable within a second.

        Raises:
            NotFound: if there is no such run; not at every call.
        """
        statement = update(RUNS).where(RUNS.c.id == run_id).values(done=done, eta_s=eta_s)

        def work(connection: Connection) -> None:
            if not connection.execute(statement).rowcount:
                fetch_run_row(connection, run_id)  # raises NotFound

        if self._progress.put(run_id, {"done": done, "eta_s": eta_s}):
            self.database.write(work)

    def delete(self, run_id: str) -> None:
        """Delete an ended run with its curve, artifacts and other data, at once.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended.
        """

        def work(connection: Connection) -> Sequence[str]:
            _check_ended(fetch_run_row(connection, run_id, for_update=True))
            is_this_run = has_public_id(connection, run_id)
            names = self._artifacts.file_names(connection, is_this_run)
            connection.execute(delete(RUNS).where(is_this_run))
            return names

        self.files.remove(*self.database.write(work))
        self._progress.drop(run_id)

    def trash(self, run_id: str) -> datetime | None:
        """Delete an ended run so that it can be restored: all is kept, and nothing finds it.

        Returns:
            until when; None if it is gone at once, as the disk is full.

        Raises:
            NotFound: if there is no such run.
            Conflict: if it has not ended.
        """

        def rows(connection: Connection) -> ColumnElement[bool]:
            _check_ended(fetch_run_row(connection, run_id, for_update=True))
            return has_public_id(connection, run_id)

        until = self.deletions.delete(RUNS, rows)
        self._progress.drop(run_id)
        return until

    def restore(self, run_id: str) -> AnyRun:
        """Bring a run back that `trash` has deleted, and return it; one that is there stays.

        Raises:
            NotFound: if there is no such run (any more), or a stored robot of it was deleted, too.
        """

        def fetch(connection: Connection) -> Row:
            row = fetch_run_row(connection, run_id)
            self.robots.check_not_deleted(connection, f"{row['config']} {row['result']}")
            return row

        row = self.deletions.restore(
            RUNS, lambda connection: has_public_id(connection, run_id), fetch
        )
        return self._try_decode(row, {})

    def _purge(self, is_purged: ColumnElement[bool]) -> int:
        def work(connection: Connection) -> tuple[int, Sequence[str]]:
            names = self._artifacts.file_names(connection, is_purged)
            return connection.execute(delete(RUNS).where(is_purged)).rowcount, names

        number, names = self.database.write(work)
        self.files.remove(*names)
        return number

    def put_artifact(
        self,
        run_id: str,
        name: str,
        data: bytes | memoryview | Iterable[bytes],
        *,
        size: int | None = None,
        **fields: Any,
    ) -> None:
        """Store a file of the run and set fields of the run, atomically.

        Replaces the file that had this name.

        Args:
            run_id: id of the run.
            name: name of the file.
            data: all of its content, or chunks of it.
            size: approximate total size of chunks [bytes].
            **fields: fields of the run that are set.

        Raises:
            NotFound: if there is no such run.
            StorageFull: if there is too little disk space.
        """
        self.get(run_id)
        columns = encode_fields(fields)
        self._artifacts.put(run_id, name, data, columns, size)
        self._invalidate_progress(run_id, fields)

    def artifact(self, run_id: str, name: str) -> bytes | None:
        """Return the content of a file of the run; None if it has no file of this name."""
        return self._artifacts.read(run_id, name, self.files.read)

    def open_artifact(self, run_id: str, name: str) -> ArtifactFile | None:
        """Open a file of the run for reading in chunks; None if it has no file of this name.

        The caller closes it.
        """
        return self._artifacts.read(run_id, name, self.files.open)

    def artifact_files(self, run_id: str) -> Mapping[str, StoredFile]:
        """Return the files of a run, by their names, as they are at one moment.

        Raises:
            NotFound: if there is no such run.
        """
        return self._artifacts.files_of(run_id)

    def interrupt_all(self) -> Sequence[str]:
        """Mark every unended run as interrupted, after the server that ran it crashed.

        Returns:
            ids of these runs.
        """
        statement = _interrupted(NOT_ENDED, _INTERRUPTED_ERROR).returning(RUNS.c.id)
        return self.database.write(lambda connection: connection.execute(statement).scalars().all())

    def interrupt(
        self, run_ids: Collection[str], from_states: Collection[State], error: str
    ) -> Sequence[Run]:
        """Mark runs as interrupted whose state is in `from_states`, in one transaction.

        Returns:
            these runs.
        """
        statement = _interrupted(from_states, error).returning(*RAW_RUN)

        def work(connection: Connection) -> Sequence[Row]:
            ids, changed = list(run_ids), list[Row]()
            for first in range(0, len(ids), _IDS_AT_ONCE):
                of_part = RUNS.c.id.in_(ids[first : first + _IDS_AT_ONCE])
                changed += fetch_rows(connection, statement.where(of_part))
            return changed

        rows = self.database.write(work)
        for row in rows:
            self._progress.drop(row["id"])
        runs = (try_decode_run(row, self.kinds) for row in rows)
        return [run for run in runs if isinstance(run, Run)]

    def delete_orphans(self) -> int:
        """Delete the artifact files that no run references; only safe before the first write.

        Returns:
            the number of deleted files.
        """
        return self._artifacts.delete_orphans()

    def _try_decode(self, row: Row, progress: Mapping[str, Any]) -> AnyRun:
        return try_decode_run(_with_progress(row, progress), self.kinds)

    def _invalidate_progress(self, run_id: str, fields: Mapping[str, Any]) -> None:
        if "done" in fields:
            self._progress.drop(run_id)


def _check_ended(row: Row) -> None:
    """Check that a run has ended, by its row.

    Raises:
        Conflict: if it has not.
    """
    if row["state"] in NOT_ENDED:
        raise Conflict(f"{row['kind']} {row['id']} is {row['state']}; stop it first", row["state"])


def _interrupted(from_states: Collection[State], error: str) -> Update:
    now = literal(datetime.now(UTC), UtcTime)
    # The clock may have been set back since the run was created, or started.
    since = func.coalesce(RUNS.c.started_at, RUNS.c.created_at)
    return (
        update(RUNS)
        .where(RUNS.c.state.in_(from_states))
        .values(
            state="interrupted",
            error=error,
            eta_s=None,
            waiting_for=[],
            ended_at=case((since > now, since), else_=now),
        )
    )


def _with_progress(row: Row, progress: Mapping[str, Any]) -> Row:
    """Merge cached progress into the row of a live run; only a running one has an estimate."""
    merged = {**row, **progress} if row["state"] in LIVE else dict(row)
    if row["state"] not in RUNNING:
        merged["eta_s"] = None
    return merged
