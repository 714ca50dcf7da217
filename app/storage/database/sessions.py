"""Sessions of operators' browsers in the database."""

from collections.abc import Collection, Sequence

from sqlalchemy import delete, insert, select

from app.storage.database.engine import Database
from app.storage.database.schema import SESSIONS
from app.storage.sessions import SessionRow


class SqlSessionRows:
    """Implements `SessionRows`."""

    def __init__(self, database: Database) -> None:
        """Keep them in a database."""
        self._database = database

    def load(self) -> Sequence[SessionRow]:
        """All that are stored, the oldest first."""
        wanted = select(SESSIONS).order_by(SESSIONS.c.created_at)
        rows = self._database.read(lambda connection: connection.execute(wanted).mappings().all())
        return [SessionRow(**row) for row in rows]

    def add(self, row: SessionRow) -> None:
        """Store one more."""
        statement = insert(SESSIONS).values(row._asdict())
        self._database.write(lambda connection: connection.execute(statement))

    def remove(self, ids_sha256: Collection[str]) -> None:
        """Forget some."""
        statement = delete(SESSIONS).where(SESSIONS.c.id_sha256.in_(ids_sha256))
        self._database.write(lambda connection: connection.execute(statement))
