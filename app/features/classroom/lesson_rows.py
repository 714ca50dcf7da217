"""Rows of the `lessons` table."""

from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import ColumnElement, Connection, func, select

from app.features.classroom.tables import LESSONS
from app.storage.database.columns import not_deleted
from app.storage.database.store import RunStore
from app.storage.database.stored_rows import DecodedRows, put_rows, read_rows, rows_in
from app.storage.errors import NotFound


class LessonRows:
    """Reads and writes the lessons in a database."""

    def __init__(self, store: RunStore) -> None:
        self._store, self._database = store, store.database

    def put(self, lesson_id: str, title: str, document: Mapping[str, Any], most: int) -> bool:
        """Store a lesson, in the place of a damaged one of this id; False if there are too many.

        Those that were deleted count, and give way.
        """
        self._store.deletions.make_room(LESSONS, most)

        def work(connection: Connection) -> bool:
            count = connection.execute(select(func.count()).select_from(LESSONS)).scalar_one()
            if count >= most:
                return False
            row = {"id": lesson_id, "title": title, "document": dict(document)}
            put_rows(connection, LESSONS, [{**row, "created_at": datetime.now(UTC)}])
            return True

        return self._database.write(work)

    def read(self, decode: Callable[..., Any], lesson_id: str | None = None) -> DecodedRows:
        """Return lessons, newest first.

        Args:
            decode: returns a lesson from the columns.
            lesson_id: of the one that is wanted; None for all.
        """
        order = LESSONS.c.created_at.desc(), LESSONS.c.id
        where = None if lesson_id is None else LESSONS.c.id == lesson_id
        return read_rows(self._database, LESSONS, decode, *order, where=where)

    def delete(self, lesson_id: str) -> datetime | None:
        """Delete a lesson so that it can be restored for a while.

        Returns:
            until when; None if it is gone at once, as the disk is full.

        Raises:
            NotFound: if there is no stored lesson of this id.
        """

        def row(connection: Connection) -> ColumnElement[bool]:
            is_it = LESSONS.c.id == lesson_id
            query = select(LESSONS.c.id).where(is_it, not_deleted(LESSONS))
            if connection.execute(query).first() is None:
                raise NotFound(f"there is no stored lesson {lesson_id!r}; those built in stay")
            return is_it

        return self._store.deletions.delete(LESSONS, row)

    def restore(self, lesson_id: str, decode: Callable[..., Any]) -> DecodedRows:
        """Bring back a lesson that was deleted lately; return it as `read` does.

        Raises:
            NotFound: if there is no such lesson, or it was deleted too long ago.
        """
        is_it = LESSONS.c.id == lesson_id

        def fetch(connection: Connection) -> DecodedRows:
            rows = rows_in(connection, LESSONS, decode, where=is_it)
            if not (rows.sound or rows.damaged):
                raise NotFound(f"there is no stored lesson {lesson_id!r} (any more)")
            return rows

        return self._store.deletions.restore(LESSONS, lambda _: is_it, fetch)
