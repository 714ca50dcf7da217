"""Single-writer ownership of a database: advisory lock, fencing token, and a monitor thread.

The monitor also opens the circuit breaker of a database that is out of reach: a PostgreSQL server
that does not answer, or a SQLite file that was removed or replaced. Of such a file all that is
written is lost with the last process that has it open, without any error of SQLite.

PostgreSQL releases an advisory lock when the connection that holds it ends, so the lock alone does
not exclude a second writer after the database was restarted. The *fencing token* does: a number in
the database that every server increments when it claims the database, and that every write compares
with the server's own.
"""

import logging
import re
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from sqlalchemy import Connection, Executable, insert, select, text, update
from sqlalchemy.exc import SQLAlchemyError

from app.storage.database.engine import Database, translate_errors, unreachable_error
from app.storage.database.schema import ABOUT
from app.storage.database.sqlite_file import file_identity
from app.storage.errors import StorageFailed
from hexapods.domain.errors import HexapodError, InvalidInput

_LOCK_NUMBER = 0x6865_7861_706F_6473
_TRY_LOCK = text("SELECT pg_try_advisory_lock(:number)").bindparams(number=_LOCK_NUMBER)
_HAS_LOCK = text(
    "SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND pid = pg_backend_pid() "
    "AND granted"
)
_LOCK_WAIT_S = 5.0
_ID = re.compile("[0-9a-f]{16}")
_MAX_TOKEN = 1 << 40
WATCH_EVERY_S = 0.5
_HANG_S = 3.0
"""A poll that takes longer opens the circuit breaker: other threads' calls fail at once."""
_JOIN_S = 2.0
_logger = logging.getLogger(__name__)


class ClaimedDatabase(NamedTuple):
    """Result of claiming a database."""

    database_id: str
    """Random id of the database; names the folder of its artifact files."""
    fencing_token: int
    """Number of this ownership, one higher than that of the previous owner."""


def claim(database: Database, files: Path) -> ClaimedDatabase:
    """Change the fencing token, so that previous owners of the database can no longer write.

    A damaged row gets a token that no owner had, and the id of the only folder of files there is.

    Args:
        database: the database.
        files: folder that has a folder of files for each database.

    Raises:
        StorageFailed: if the database is unavailable.
    """

    def work(connection: Connection) -> ClaimedDatabase:
        row = connection.execute(select(ABOUT.c.id, ABOUT.c.owner).with_for_update()).first()
        stored, owner = (secrets.token_hex(8), 0) if row is None else row
        if row is None:
            connection.execute(insert(ABOUT), [{"id": stored, "owner": owner}])
        is_sound = isinstance(owner, int) and 0 <= owner < _MAX_TOKEN
        token = owner + 1 if is_sound else secrets.randbelow(_MAX_TOKEN // 2)
        claimed = ClaimedDatabase(id_of_files(stored, files) or secrets.token_hex(8), token)
        connection.execute(update(ABOUT).values(id=claimed.database_id, owner=token))
        return claimed

    claimed = database.write(work)
    database.fencing_token = claimed.fencing_token
    return claimed


def id_of_files(stored: object, files: Path) -> str | None:
    """Return the id of a database, of its folder of files; None if the stored one is damaged.

    Args:
        stored: id in the database; in the place of a damaged one is that of the only folder.
        files: folder that has a folder of files for each database.
    """
    if isinstance(stored, str) and _ID.fullmatch(stored):
        return stored
    folders = files.iterdir() if files.is_dir() else ()
    ids = [path.name for path in folders if _ID.fullmatch(path.name)]
    return ids[0] if len(ids) == 1 else None


class FileReplaced(StorageFailed):
    """The path of an open SQLite database has no file any more, or another one."""


class Ownership:
    """Holds the advisory lock, reacquires it after an outage, and detects a new owner.

    Args:
        database: the database to own.
        on_lost: called once, from the monitor thread, when another server has claimed it.
    """

    def __init__(self, database: Database, on_lost: Callable[[], object]) -> None:
        self._database, self._on_lost = database, on_lost
        self._is_postgresql = database.engine.dialect.name == "postgresql"
        self._connection: Connection | None = None
        self._poll_began_s: float | None = None
        self._failing = False
        self._problem: StorageFailed | None = None
        self._path = None if self._is_postgresql else Path(database.engine.url.database or "")
        self._file = self._path and file_identity(self._path)
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._monitor, name="ownership", daemon=True)

    def lock(self) -> None:
        """Acquire the advisory lock; for SQLite the data folder's file lock serves instead.

        Raises:
            InvalidInput: if another server holds it.
            StorageFailed: if the database cannot be reached.
        """
        deadline = time.monotonic() + _LOCK_WAIT_S
        # PostgreSQL may release the lock of a server that ended only a moment later.
        while self._is_postgresql and not self._try_lock():
            if time.monotonic() > deadline:
                raise InvalidInput(
                    "another server uses this PostgreSQL database; stop it, or name another "
                    "database in HEXAPODS_DATABASE_URL"
                )
            time.sleep(0.1)

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Run the monitor thread for as long as the context lasts."""
        self._database.check_available = self._check_available
        self._thread.start()
        try:
            yield
        finally:
            self._closing.set()
            # With a timeout: the thread may hang in a call to an unresponsive database.
            self._thread.join(_JOIN_S)

    def release(self) -> None:
        """Release the lock by closing its connection."""
        if not self._thread.is_alive():
            self._drop_connection()

    def _drop_connection(self) -> None:
        connection, self._connection = self._connection, None
        if connection is not None:
            with suppress(SQLAlchemyError):  # a connection that fails to close is closed already
                connection.invalidate()
                connection.close()

    def _check_available(self) -> None:
        poll_began_s, problem = self._poll_began_s, self._problem
        if threading.current_thread() is self._thread:
            return
        if poll_began_s is not None and time.monotonic() - poll_began_s > _HANG_S:
            if self._is_postgresql:
                raise unreachable_error()
            raise StorageFailed("the data folder does not answer")
        if problem is not None:
            raise StorageFailed(str(problem))

    def _monitor(self) -> None:
        while not self._closing.wait(WATCH_EVERY_S):
            self._poll_began_s = time.monotonic()
            try:
                owner = self._read_owner()
                self._database.probe_write()
            except HexapodError as error:
                self._note_failure(error)
                continue
            finally:
                self._poll_began_s = None
            if self._failing:
                _logger.warning("The database answers again")
            self._failing, self._problem = False, None
            if owner != self._database.fencing_token:
                _logger.error("Another server has taken this database over")
                self._on_lost()
                return

    def _note_failure(self, error: HexapodError) -> None:
        if not self._failing:
            _logger.warning("The database does not answer: %s", error)
        self._failing = True
        if self._is_postgresql:
            self._problem = unreachable_error()
        else:
            # SQLite that is busy or damaged says so itself, in the call that needs it.
            self._problem = error if isinstance(error, FileReplaced) else None

    def _check_file(self) -> None:
        if self._path is not None and file_identity(self._path) != self._file:
            # Without its folder: the message is for everyone who may watch.
            raise FileReplaced(
                f"the database file {self._path.name} was removed or replaced while the server "
                "runs, and nothing more is written: put the same file back, or start the server "
                "again with a backup"
            )

    def _read_owner(self) -> int:
        """Return the fencing token of the present owner; first reacquire a lost advisory lock."""
        query = select(ABOUT.c.owner)
        if not self._is_postgresql:
            self._check_file()
            owner: int = self._database.read(lambda c: c.execute(query).scalar_one())
            return owner
        self._try_lock()
        # On its own connection: hanging threads may hold all those of the pool.
        return int(self._execute(query))

    def _try_lock(self) -> bool:
        """Try to acquire the advisory lock on its own connection; return whether it is held."""
        return bool(self._execute(_HAS_LOCK)) or bool(self._execute(_TRY_LOCK))

    def _execute(self, statement: Executable) -> Any:
        """Execute on its own connection; on a new one if the database has ended that."""
        was_connected = self._connection is not None
        try:
            return self._execute_once(statement)
        except HexapodError:
            if not was_connected:
                raise
        return self._execute_once(statement)

    def _execute_once(self, statement: Executable) -> Any:
        try:
            if self._connection is None:
                self._connection = self._database.connect()
            with translate_errors():
                return self._connection.execute(statement).scalar_one()
        except HexapodError:
            self._drop_connection()
            raise
