"""Transactions on a database shared by the threads of one process.

Adds to SQLAlchemy's engines: fair queuing for SQLite, retries during an outage, the check of the
fencing token before each write, and driver errors translated to messages for the user.
"""

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, contextmanager, nullcontext
from contextvars import ContextVar
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from sqlalchemy import URL, Connection, Engine, Table, create_engine, event, make_url, select, text
from sqlalchemy.exc import DBAPIError, IntegrityError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeout

from app.storage.database.fifo_semaphore import FifoSemaphore
from app.storage.database.schema import ABOUT, METADATA
from app.storage.errors import OwnershipLost, StorageFailed, StorageFull
from hexapods.domain.errors import HexapodError
from hexapods.extras import needs

BUSY_S = 10.0
"""Time to wait for a lock that another process holds on the database."""
POOL_WAIT_S = 5.0
"""Time to wait for a connection from the exhausted PostgreSQL pool."""
_FIRST_RETRY_S, _LAST_RETRY_S = 0.1, 1.0
SQLITE_CONNECTIONS = 5
"""Concurrent connections to SQLite; further reads are queued."""
SQLITE_FILES = 2 * SQLITE_CONNECTIONS + 1
"""Maximum of open database files: `.db` and `-wal` per connection, and one shared `-shm`."""
PROBE_BUSY_S = 2.0
"""The same for a probe."""
_TOUCH = text("UPDATE about SET owner = owner")
T = TypeVar("T")
_READ_ONLY = "hexapods_only_reads"
_PRAGMAS = (
    "journal_mode=WAL",
    "synchronous=FULL",
    "foreign_keys=ON",
    # What is deleted is overwritten, for it can be of a pupil.
    "secure_delete=ON",
)
_PRIMARY_CODE = 0xFF  # mask: an extended result code of SQLite has the primary one in its low byte


class _RetryPolicy(NamedTuple):
    max_retry_s: float
    cancelled: threading.Event


_retry_policy: ContextVar[_RetryPolicy | None] = ContextVar("retry_policy", default=None)


@contextmanager
def retry_during_outage(max_retry_s: float, cancelled: threading.Event) -> Iterator[None]:
    """Retry every database call in this context with exponential back-off during an outage.

    For background threads, such as those that receive a job's results. A call may have been
    committed although its reply was lost, so all calls in this context must be idempotent.

    Args:
        max_retry_s: how long each call is retried before it fails.
        cancelled: when set, ends the retries early.
    """
    token = _retry_policy.set(_RetryPolicy(max_retry_s, cancelled))
    try:
        yield
    finally:
        _retry_policy.reset(token)


class Database:
    """Runs functions as transactions on one database. Thread-safe.

    Attributes:
        engine: SQLAlchemy's engine, for callers that need a connection of their own.
        on_disk_full: called when the disk is full; returns True if it freed space, so that the
            write is retried.
        fencing_token: number of this server's ownership, which every write compares with the one
            in the database; None, before the database is claimed, skips the check.
        write_problem: why the last write or probe failed; None if it succeeded.
        tables: all that this process knows, those that others need first.
        decoders: by table, what its rows stand for; see `stored_rows`.
        logged_damage: the damaged rows that were logged.
        check_available: circuit breaker; while it raises `StorageFailed` every call fails at once,
            so that threads do not pile up behind a database that hangs.
    """

    def __init__(self, engine: Engine, on_disk_full: Callable[[], bool] = lambda: False) -> None:
        self.engine, self.on_disk_full = engine, on_disk_full
        self.fencing_token: int | None = None
        self.write_problem: HexapodError | None = None
        self.tables: list[Table] = list(METADATA.sorted_tables)
        self.decoders: dict[str, Callable[..., Any]] = {}
        self.logged_damage: set[str] = set()
        self.check_available: Callable[[], None] = lambda: None
        # SQLite's busy handler polls, and the pool's queue is not fair, so waiters would starve.
        is_sqlite = engine.dialect.name == "sqlite"
        self._writers = FifoSemaphore(1) if is_sqlite else None
        self._connections = FifoSemaphore(SQLITE_CONNECTIONS) if is_sqlite else None

    def read(self, work: Callable[[Connection], T]) -> T:
        """Run a function in a read-only transaction, which sees one snapshot of the database.

        Raises:
            StorageFailed: if the database is unavailable.
        """

        def attempt() -> T:
            with (
                _slot(self._connections),
                translate_errors(),
                self.engine.connect() as connection,
            ):
                return work(connection.execution_options(**{_READ_ONLY: True}))

        return self._retry(attempt)

    def write(self, work: Callable[[Connection], T]) -> T:
        """Run a function in a write transaction, which is durable on return.

        The function may be called more than once, in a transaction of its own each time.

        Raises:
            StorageFull: if the disk is full.
            StorageFailed: if the database is unavailable, or locked for over `BUSY_S`.
            OwnershipLost: if another server has claimed the database.
        """

        def attempt() -> T:
            try:
                return self._write(work)
            except StorageFull:
                if not self.on_disk_full():
                    raise
            return self._write(work)

        return self._retry(attempt)

    def _retry(self, attempt: Callable[[], T]) -> T:
        """Call until it succeeds or the policy set by `retry_during_outage` gives up."""
        policy = _retry_policy.get()
        began_s, pause_s = time.monotonic(), _FIRST_RETRY_S
        while True:
            try:
                self.check_available()
                return attempt()
            except OwnershipLost:
                raise
            except StorageFailed:
                if policy is None or time.monotonic() - began_s > policy.max_retry_s:
                    raise
                if policy.cancelled.wait(pause_s):
                    raise
            pause_s = min(2 * pause_s, _LAST_RETRY_S)

    def probe_write(self) -> None:
        """Begin and end a write, so that `write_problem` is known without one, and when it is over.

        To be called regularly. After a failure the probe writes to the disk. PostgreSQL is only
        probed then: where it does not answer, reads fail, too.
        """
        try:
            if self._writers is None:
                if self.write_problem is not None:
                    self._write(lambda connection: connection.execute(_TOUCH))
            # A write that is in progress tells by itself how it ends.
            elif not self._writers.is_exhausted:
                with _slot(self._writers), _slot(self._connections), translate_errors():
                    self._probe_sqlite()
        except (StorageFull, StorageFailed) as error:
            self.write_problem = error
        except sqlite3.Error as error:
            self.write_problem = _sqlite_error(error)

    def _probe_sqlite(self) -> None:
        with closing(self.engine.raw_connection()) as connection:
            cursor = connection.cursor()
            try:
                # Not as long as a write: who asks whether the server is ready waits for it.
                cursor.execute(f"PRAGMA busy_timeout = {1000 * PROBE_BUSY_S:.0f}")
                cursor.execute("BEGIN IMMEDIATE")
                if self.write_problem is not None:
                    cursor.execute(str(_TOUCH))
                cursor.execute("COMMIT")
            finally:
                cursor.execute(f"PRAGMA busy_timeout = {1000 * BUSY_S:.0f}")
        self.write_problem = None

    def _write(self, work: Callable[[Connection], T]) -> T:
        try:
            result = self._transaction(work)
        except (StorageFull, StorageFailed) as error:
            self.write_problem = error
            raise
        self.write_problem = None
        return result

    def _transaction(self, work: Callable[[Connection], T]) -> T:
        with (
            _slot(self._writers),
            _slot(self._connections),
            translate_errors(),
            self.engine.begin() as connection,
        ):
            self._check_owner(connection)
            return work(connection)

    def _check_owner(self, connection: Connection) -> None:
        """Fence: refuse to write once another server has incremented the fencing token."""
        if self.fencing_token is None:
            return
        # FOR SHARE keeps the token unchanged until this transaction has ended.
        token = connection.execute(select(ABOUT.c.owner).with_for_update(read=True)).scalar()
        if token != self.fencing_token:
            raise OwnershipLost(
                "another server has taken this database over, so this one writes nothing more"
            )

    def connect(self) -> Connection:
        """Open a connection in autocommit mode; the caller closes it.

        Raises:
            StorageFailed: if the database cannot be reached.
        """
        with translate_errors():
            return self.engine.connect().execution_options(isolation_level="AUTOCOMMIT")

    def close(self) -> None:
        """Close all pooled connections."""
        self.engine.dispose()


def _slot(semaphore: FifoSemaphore | None) -> AbstractContextManager[None]:
    return nullcontext() if semaphore is None else semaphore.acquired(BUSY_S, _busy_error)


def sqlite_engine(path: Path) -> Engine:
    """Create an engine for a SQLite file, which is created if it does not exist."""
    engine = create_engine(
        URL.create("sqlite", database=str(path)),
        # Autocommit: the driver's implicit transactions begin only at the first write, so a read
        # before it would not be protected against lost updates.
        connect_args={"isolation_level": None, "timeout": BUSY_S},
        # A fixed-size pool, without overflow, bounds the number of open files.
        pool_size=SQLITE_CONNECTIONS,
        max_overflow=0,
        pool_timeout=BUSY_S,
    )
    event.listen(engine, "connect", _prepare_sqlite)
    event.listen(engine, "begin", _begin_sqlite)
    return engine


def postgresql_engine(url: str) -> Engine:
    """Create an engine for a PostgreSQL server; it connects on first use.

    Raises:
        MissingExtra: if its driver is not installed.
    """
    with needs("postgres", "a PostgreSQL database"):
        import psycopg  # noqa: F401, PLC0415  # as SQLAlchemy does
    wait_ms = int(BUSY_S * 1000)
    return create_engine(
        make_url(url).set(drivername="postgresql+psycopg"),
        pool_pre_ping=True,
        pool_timeout=POOL_WAIT_S,
        connect_args={
            "connect_timeout": int(BUSY_S),
            "options": f"-c lock_timeout={wait_ms} -c timezone=UTC -c synchronous_commit=on",
        },
    )


def decode_leniently(connection: sqlite3.Connection) -> None:
    """Decode invalid UTF-8 in text columns with `surrogateescape`, instead of failing the query."""
    connection.text_factory = lambda data: data.decode("utf-8", "surrogateescape")


def _prepare_sqlite(connection: sqlite3.Connection, record: object) -> None:
    del record
    decode_leniently(connection)
    for pragma in _PRAGMAS:
        connection.execute(f"PRAGMA {pragma}")


def _begin_sqlite(connection: Connection) -> None:
    read_only = connection.get_execution_options().get(_READ_ONLY)
    # IMMEDIATE takes the write lock now: upgrading a read transaction later can fail with BUSY.
    connection.exec_driver_sql("BEGIN" if read_only else "BEGIN IMMEDIATE")


@contextmanager
def translate_errors() -> Iterator[None]:
    """Translate the driver's errors into `HexapodError`s with messages for the user.

    Raises:
        StorageFull, StorageFailed: in place of the driver's errors.
    """
    try:
        yield
    except IntegrityError:
        raise
    except DBAPIError as error:
        raise _translated(error) from error
    except PoolTimeout as error:
        raise _busy_error() from error


def _translated(error: DBAPIError) -> HexapodError:
    if isinstance(error.orig, sqlite3.Error):
        return _sqlite_error(error.orig)
    state = getattr(error.orig, "sqlstate", None)
    if state in ("53100", "54000"):
        return StorageFull("the disk of the PostgreSQL server is full; make room there")
    if state == "55P03":
        return _busy_error()
    if isinstance(error, OperationalError | InterfaceError):
        return unreachable_error()
    return StorageFailed(f"the database refuses ({type(error.orig).__name__})")


def _sqlite_error(error: sqlite3.Error) -> HexapodError:
    code = getattr(error, "sqlite_errorcode", 0)
    kinds: dict[int, Any] = {
        sqlite3.SQLITE_BUSY: _busy_error,
        sqlite3.SQLITE_LOCKED: _busy_error,
        sqlite3.SQLITE_FULL: _disk_full_error,
        sqlite3.SQLITE_CORRUPT: _corrupt_error,
        sqlite3.SQLITE_NOTADB: _corrupt_error,
    }
    # Exceeding a file size limit (ulimit, quota) is reported as an I/O error of a write.
    is_write_error = code == sqlite3.SQLITE_IOERR_WRITE
    make_error = _disk_full_error if is_write_error else kinds.get(code & _PRIMARY_CODE)
    return make_error() if make_error else StorageFailed(f"the database cannot be used ({error})")


def unreachable_error() -> StorageFailed:
    """Return the error of a PostgreSQL server that does not answer."""
    return StorageFailed("the PostgreSQL server does not answer; see that it runs")


def _busy_error() -> HexapodError:
    return StorageFailed(
        "another program holds the database for longer than a write waits; close it, then try again"
    )


def _disk_full_error() -> HexapodError:
    return StorageFull("the disk of the data folder is full; delete runs, or make room there")


def _corrupt_error() -> HexapodError:
    return StorageFailed(
        "the database file in the data folder is damaged, or is no database; move it away to "
        "begin anew, or put a copy of it back"
    )
