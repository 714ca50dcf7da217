"""Rows of the `lessons` table."""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, String, cast, delete, func, insert, select

from app.storage.database.columns import decode_json
from app.storage.database.engine import Database
from app.storage.database.schema import LESSONS
from app.storage.json_text import read_json


class LessonRows:
    """Reads and writes the lessons in a database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def add(self, lesson_id: str, title: str, document: Mapping[str, Any], most: int) -> bool:
        """Store a lesson, unless one of this id is there; False if there are too many."""

        def work(connection: Connection) -> bool:
            known = select(LESSONS.c.id).where(LESSONS.c.id == lesson_id)
            if connection.execute(known).first() is not None:
                return True
            count = connection.execute(select(func.count()).select_from(LESSONS)).scalar_one()
            if count >= most:
                return False
            row = {"id": lesson_id, "title": title, "document": dict(document)}
            connection.execute(insert(LESSONS), [{**row, "created_at": datetime.now(UTC)}])
            return True

        return self._database.write(work)

    def get(self, lesson_id: str) -> Any:
        """Return the document of a lesson as it is stored; None if there is none."""
        query = select(cast(LESSONS.c.document, String)).where(LESSONS.c.id == lesson_id)
        text = self._database.read(lambda connection: connection.execute(query).scalar())
        return None if text is None else decode_json(read_json(text))

    def ids(self) -> list[str]:
        """Return the ids of all lessons, newest first."""
        query = select(LESSONS.c.id).order_by(LESSONS.c.created_at.desc(), LESSONS.c.id)
        rows = self._database.read(lambda connection: connection.execute(query).scalars().all())
        return [str(one) for one in rows]

    def delete(self, lesson_id: str) -> bool:
        """Delete a lesson; whether there was one."""
        statement = delete(LESSONS).where(LESSONS.c.id == lesson_id)
        return self._database.write(lambda c: bool(c.execute(statement).rowcount))
