"""Rows of the `lessons` table."""

from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, delete, func, select

from app.features.classroom.tables import LESSONS
from app.storage.database.engine import Database
from app.storage.database.stored_rows import DecodedRows, put_rows, read_rows


class LessonRows:
    """Reads and writes the lessons in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def put(self, lesson_id: str, title: str, document: Mapping[str, Any], most: int) -> bool:
        """Store a lesson, in the place of a damaged one of this id; False if there are too many."""

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

    def delete(self, lesson_id: str) -> bool:
        """Delete a lesson; whether there was one."""
        statement = delete(LESSONS).where(LESSONS.c.id == lesson_id)
        return self._database.write(lambda c: bool(c.execute(statement).rowcount))
