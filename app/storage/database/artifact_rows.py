"""Artifacts: rows in the database that name files beside it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any, TypeVar

from sqlalchemy import ColumnElement, Connection, and_, delete, insert, select, update

from app.storage.artifacts import ArtifactFiles, StoredFile
from app.storage.database.engine import Database
from app.storage.database.queries import Row, fetch_rows, fetch_run_row
from app.storage.database.schema import ARTIFACTS, RUNS
from app.storage.errors import StorageFailed
from hexapods.domain.errors import DamagedFile

T = TypeVar("T")
_FILE = (ARTIFACTS.c.file, ARTIFACTS.c.size, ARTIFACTS.c.sha256)


class Artifacts:
    """The artifacts of all runs. Thread-safe."""

    def __init__(self, database: Database, files: ArtifactFiles) -> None:
        self._database, self._files = database, files

    def insert(self, connection: Connection, run_id: str, stored: Mapping[str, StoredFile]) -> None:
        """Insert the rows of written files, by their names."""
        now = datetime.now(UTC)
        rows = [
            {"run_id": run_id, "name": name, "written_at": now, **file._asdict()}
            for name, file in stored.items()
        ]
        if rows:
            connection.execute(insert(ARTIFACTS), rows)

    def put(
        self,
        run_id: str,
        name: str,
        data: bytes | memoryview | Iterable[bytes],
        columns: Mapping[str, Any],
        size: int | None = None,
    ) -> None:
        """Store a file of the run and set columns of the run's row, atomically.

        Replaces the file that had this name.

        Raises:
            NotFound: if there is no such run.
            StorageFull: if there is too little disk space.
        """
        stored = self._files.write(data, size)
        is_former = and_(ARTIFACTS.c.run_id == run_id, ARTIFACTS.c.name == name)

        def work(connection: Connection) -> Sequence[str]:
            fetch_run_row(connection, run_id, for_update=True)
            former = select(ARTIFACTS.c.file).where(is_former)
            names = connection.execute(former).scalars().all()
            connection.execute(delete(ARTIFACTS).where(is_former))
            self.insert(connection, run_id, {name: stored})
            if columns:
                of_run = RUNS.c.id == run_id
                connection.execute(update(RUNS).where(of_run).values(columns))
            return names

        try:
            former = self._database.write(work)
        except BaseException as error:
            # After an outage the transaction may have been committed with its reply lost. The
            # file stays then; if it is an orphan, the next start deletes it.
            if not isinstance(error, StorageFailed):
                self._files.remove(stored.file)
            raise
        # After a retried commit the new file itself is among the former ones.
        self._files.remove(*(name for name in former if name != stored.file))

    def read(self, run_id: str, name: str, read: Callable[[StoredFile, str], T]) -> T | None:
        """Read a file of the run with `read(file, label)`; None if it has no file of this name.

        Raises:
            NotFound: if there is no such run.
            DamagedFile: if the file is missing, or what `read` raises.
        """
        label = f"{name} of run {run_id}"
        missing: StoredFile | None = None
        while (stored := self._row(run_id, name)) is not None:
            try:
                return read(stored, label)
            except FileNotFoundError as error:
                # A concurrent `put` may have replaced it since the query: look again.
                if stored == missing:
                    raise DamagedFile(f"{label} is missing from the data folder") from error
                missing = stored
        return None

    @staticmethod
    def file_names(connection: Connection, is_run: ColumnElement[bool]) -> Sequence[str]:
        """Return the names in the folder of the files of the runs that match `is_run`."""
        runs = select(RUNS.c.id).where(is_run)
        query = select(ARTIFACTS.c.file).where(ARTIFACTS.c.run_id.in_(runs))
        return connection.execute(query).scalars().all()

    def delete_orphans(self) -> int:
        """Delete the files that no row names; only safe before the first write.

        Returns:
            the number of deleted files.
        """
        names = select(ARTIFACTS.c.file)
        files = self._database.read(lambda connection: connection.execute(names).scalars().all())
        return self._files.delete_orphans(files)

    def files_of(self, run_id: str) -> Mapping[str, StoredFile]:
        """Return the files of a run by their names; raises NotFound if there is no such run."""
        return self._rows(run_id, ARTIFACTS.c.run_id == run_id)

    def _row(self, run_id: str, name: str) -> StoredFile | None:
        is_it = and_(ARTIFACTS.c.run_id == run_id, ARTIFACTS.c.name == name)
        return self._rows(run_id, is_it).get(name)

    def _rows(self, run_id: str, is_meant: ColumnElement[bool]) -> Mapping[str, StoredFile]:
        query = select(ARTIFACTS.c.name, *_FILE).where(is_meant)

        def work(connection: Connection) -> Sequence[Row]:
            fetch_run_row(connection, run_id)
            return fetch_rows(connection, query)

        rows = self._database.read(work)
        return {row["name"]: StoredFile(*(row[column.name] for column in _FILE)) for row in rows}
