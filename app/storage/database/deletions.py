"""Deletions that can be undone for a while: the rows stay with all that belongs to them, unseen.

A table that is deleted from so has a `deletion_time`; queries leave out the rows that have one.
What stays needs its room: it counts towards the quota, and the greatest number of rows of a table.
"""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any, TypeVar

from sqlalchemy import ColumnElement, Connection, Table, delete, func, select, update

from app.storage.database.columns import DELETED_AT
from app.storage.database.engine import Database
from app.storage.disk_space import START_BYTES, DiskSpace
from app.storage.errors import NotFound, StorageFull

RESTORABLE = timedelta(hours=1)
"""For how long what was deleted can be restored."""
T = TypeVar("T")
Where = ColumnElement[bool]


class Deletions:
    """Deletes rows so that they can be restored for `RESTORABLE`, then for good. Thread-safe.

    Attributes:
        now: the clock, with time zone.
        purges: by table, deletes the rows that meet a condition for good, and returns their number;
            of other tables the rows alone are deleted.
    """

    def __init__(self, database: Database, disk_space: DiskSpace) -> None:
        """Use a database, and the disk that what is deleted goes on to fill."""
        self._database, self._disk_space = database, disk_space
        self.now: Callable[[], datetime] = lambda: datetime.now(UTC)
        self.purges: dict[str, Callable[[Where], int]] = {}

    def delete(self, table: Table, rows: Callable[[Connection], Where]) -> datetime | None:
        """Delete rows, so that `restore` brings them back.

        Args:
            table: their table.
            rows: returns their condition within the transaction; what it raises keeps them.

        Returns:
            until when they can be restored; None if the disk is full: all that was deleted is gone
            then, to make room.
        """
        deleted_at = self.now()

        def work(connection: Connection) -> None:
            statement = update(table).where(rows(connection), table.c[DELETED_AT].is_(None))
            connection.execute(statement.values({DELETED_AT: deleted_at}))

        self._database.write(work)
        try:
            self._disk_space.check(START_BYTES)
        except StorageFull:
            self._purge_all(lambda deletion_time: deletion_time.is_not(None))
            return None
        return deleted_at + RESTORABLE

    def restore(
        self,
        table: Table,
        rows: Callable[[Connection], Where],
        fetch: Callable[[Connection], T],
    ) -> T:
        """Bring rows back that were deleted lately; those that are there stay.

        Args:
            table: their table.
            rows: returns their condition within the transaction.
            fetch: returns them within the transaction; what it raises keeps them deleted.

        Raises:
            NotFound: if `fetch` does, also because they were deleted too long ago.
        """
        since = self.now() - RESTORABLE

        def work(connection: Connection) -> T:
            statement = update(table).where(rows(connection), table.c[DELETED_AT] >= since)
            connection.execute(statement.values({DELETED_AT: None}))
            return fetch(connection)

        try:
            return self._database.write(work)
        except NotFound as error:
            hours = RESTORABLE // timedelta(hours=1)
            raise NotFound(f"{error}; what was deleted can be restored for {hours} h") from error

    def purge(self) -> int:
        """Delete for good what can be restored no more; return the number of rows."""
        deleted_before = self.now() - RESTORABLE
        return self._purge_all(lambda deletion_time: deletion_time < deleted_before)

    def purge_rows(self, table: Table, rows: Where) -> int:
        """Delete those of some rows for good that were deleted; return their number."""
        return self._purge(table, rows & table.c[DELETED_AT].is_not(None))

    def make_room(self, table: Table, most: int, new: int = 1) -> None:
        """Let the rows of a table that were deleted first give way to new ones.

        Args:
            table: the table.
            most: number of rows that it may have, those that were deleted among them.
            new: number of rows that are to be inserted.
        """
        (key,), deleted_at = table.primary_key.columns, table.c[DELETED_AT]

        def work(connection: Connection) -> list[Any]:
            count = connection.execute(select(func.count()).select_from(table)).scalar_one()
            query = select(key).where(deleted_at.is_not(None)).order_by(deleted_at, key)
            excess = max(0, count + new - most)
            return list(connection.execute(query.limit(excess)).scalars())

        if oldest := self._database.read(work):
            self.purge_rows(table, key.in_(oldest))

    def _purge_all(self, rows: Callable[[ColumnElement[Any]], Where]) -> int:
        tables = [table for table in self._database.tables if DELETED_AT in table.c]
        numbers = [self._purge(table, rows(table.c[DELETED_AT])) for table in tables]
        return sum(numbers)  # whole numbers

    def _purge(self, table: Table, rows: Where) -> int:
        if (purge := self.purges.get(table.name)) is not None:
            return purge(rows)
        statement = delete(table).where(rows)
        return self._database.write(lambda connection: connection.execute(statement).rowcount)
