"""Rows of the `sessions` table: browser sessions of operators."""

from collections.abc import Collection, Sequence

from sqlalchemy import delete, insert, select

from app.storage.database.engine import Database
from app.storage.database.schema import SESSIONS
from app.storage.sessions import SessionRow


class SqlSessionRows:
    """Implements `SessionRows` in a database."""

    def __init__(self, database: Database) -> None:
        """Use the sessions of a database."""
        self._database = database

    def load(self) -> Sequence[SessionRow]:
        """Return all stored sessions, oldest first."""
        query = select(SESSIONS).order_by(SESSIONS.c.created_at)
        rows = self._database.read(lambda connection: connection.execute(query).mappings().all())
        return [SessionRow(**row) for row in rows]

    def add(self, row: SessionRow) -> None:
        """Store a session."""
        statement = insert(SESSIONS).values(row._asdict())
        self._database.write(lambda connection: connection.execute(statement))

    def remove(self, ids_sha256: Collection[str]) -> None:
        """Delete the sessions with these hashed ids."""
        statement = delete(SESSIONS).where(SESSIONS.c.id_sha256.in_(ids_sha256))
        self._database.write(lambda connection: connection.execute(statement))
