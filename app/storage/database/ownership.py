"""Exactly one server writes to a database: an advisory lock, a fencing token, and a watch on both.

PostgreSQL lets go of an advisory lock with the connection that took it, so the lock alone says
nothing after the database was restarted. The *fencing token* does: a number in the database that
rises with every server that takes it over, and that every write compares with its own.
"""

import logging
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

from sqlalchemy import Connection, Executable, insert, select, text, update
from sqlalchemy.exc import SQLAlchemyError

from app.domain.errors import HexapodError, InvalidInput
from app.storage.database.engine import Database, in_plain_words
from app.storage.database.schema import ABOUT

_LOCK_NUMBER = 0x6865_7861_706F_6473
_TRY_LOCK = text("SELECT pg_try_advisory_lock(:number)").bindparams(number=_LOCK_NUMBER)
_HAS_LOCK = text(
    "SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND pid = pg_backend_pid() "
    "AND granted"
)
_LOCK_WAIT_S = 5.0
WATCH_EVERY_S = 0.5
_SILENT_S = 3.0
"""A database that has not answered for so long is not asked by anyone else."""
_JOIN_S = 2.0
_logger = logging.getLogger(__name__)


class Claim(NamedTuple):
    """What a server is given with the database."""

    database_id: str
    """Names the folder of its files."""
    owner: int
    """The fencing token."""


def claim(database: Database) -> Claim:
    """Take the database over: from now on nobody who had it before can write.

    Raises:
        StorageFailed: if it cannot be used.
    """

    def work(connection: Connection) -> Claim:
        found = connection.execute(select(ABOUT.c.id)).scalar()
        if found is None:
            found = secrets.token_hex(8)
            connection.execute(insert(ABOUT), [{"id": found, "owner": 0}])
        raised = update(ABOUT).values(owner=ABOUT.c.owner + 1).returning(ABOUT.c.owner)
        return Claim(found, connection.execute(raised).scalar_one())

    taken = database.write(work)
    database.owner = taken.owner
    return taken


class Ownership:
    """Holds the advisory lock, takes it again after an outage, and notices a successor.

    Args:
        database: to be held.
        on_lost: called once, from a thread of its own, when another server has taken it over.
    """

    def __init__(self, database: Database, on_lost: Callable[[], object]) -> None:
        self._database, self._on_lost = database, on_lost
        self._is_postgresql = database.engine.dialect.name == "postgresql"
        self._connection: Connection | None = None
        self._asked_s: float | None = None
        self._failed = False
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="ownership", daemon=True)

    def lock(self) -> None:
        """Take the advisory lock; SQLite has the data folder's lock in its place.

        Raises:
            InvalidInput: if another server has it.
            StorageFailed: if the database cannot be reached.
        """
        deadline = time.monotonic() + _LOCK_WAIT_S
        # PostgreSQL may notice the end of a server a moment after it.
        while self._is_postgresql and not self._try_lock():
            if time.monotonic() > deadline:
                raise InvalidInput(
                    "another server uses this PostgreSQL database; stop it, or name another "
                    "database in HEXAPODS_DATABASE_URL"
                )
            time.sleep(0.1)

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Keep the lock for as long as the context lasts."""
        self._database.is_answering = self._is_answering
        self._thread.start()
        try:
            yield
        finally:
            self._closing.set()
            # It may hang in a database that does not answer; nothing waits for that.
            self._thread.join(_JOIN_S)

    def release(self) -> None:
        """Let go of the lock."""
        if not self._thread.is_alive():
            self._drop_connection()

    def _drop_connection(self) -> None:
        connection, self._connection = self._connection, None
        if connection is not None:
            with suppress(SQLAlchemyError):  # one that cannot be closed is closed already
                connection.invalidate()
                connection.close()

    def _is_answering(self) -> bool:
        asked_s = self._asked_s
        if threading.current_thread() is self._thread:
            return True
        hangs = asked_s is not None and time.monotonic() - asked_s > _SILENT_S
        return not (self._failed or hangs)

    def _watch(self) -> None:
        while not self._closing.wait(WATCH_EVERY_S):
            self._asked_s = time.monotonic()
            try:
                owner = self._look()
            except HexapodError as error:
                if not self._failed:
                    _logger.warning("The database does not answer: %s", error)
                self._failed = self._is_postgresql
                continue
            finally:
                self._asked_s = None
            if self._failed:
                _logger.warning("The database answers again")
            self._failed = False
            if owner != self._database.owner:
                _logger.error("Another server has taken this database over")
                self._on_lost()
                return

    def _look(self) -> int:
        """The number of the present owner, after the lock was taken again if it was lost."""
        asked = select(ABOUT.c.owner)
        if not self._is_postgresql:
            read: int = self._database.read(lambda c: c.execute(asked).scalar_one())
            return read
        self._try_lock()
        # Not through the pool, whose connections may all be held by threads that hang.
        return int(self._ask(asked))

    def _try_lock(self) -> bool:
        """Whether this server has the advisory lock, on a connection that is kept for it."""
        return bool(self._ask(_HAS_LOCK)) or bool(self._ask(_TRY_LOCK))

    def _ask(self, statement: Executable) -> Any:
        try:
            if self._connection is None:
                self._connection = self._database.connect()
            with in_plain_words():
                return self._connection.execute(statement).scalar_one()
        except HexapodError:
            self._drop_connection()
            raise
