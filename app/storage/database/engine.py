"""A database for many threads of one process: transactions, and its errors in plain words."""

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url, select
from sqlalchemy.exc import DBAPIError, IntegrityError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeout

from app.domain.errors import DamagedFile, HexapodError
from app.storage.database.fair_semaphore import FairSemaphore
from app.storage.database.schema import ABOUT
from app.storage.errors import OwnershipLost, StorageFailed, StorageFull

BUSY_S = 10.0
"""How long to wait for another process that holds the database."""
POOL_WAIT_S = 5.0
"""How long to wait for a connection while others have them all."""
_FIRST_RETRY_S, _LAST_RETRY_S = 0.1, 1.0
SQLITE_CONNECTIONS = 5
"""Reads of the database at once; further ones wait for a turn."""
SQLITE_FILES = 2 * SQLITE_CONNECTIONS + 1
"""Open files of the database at most: each connection has it and its log, all share an index."""
T = TypeVar("T")
_ONLY_READS = "hexapods_only_reads"
_SECONDARY = 0xFF  # an error code of SQLite's, without what it says beyond its kind


class _Patience(NamedTuple):
    at_most_s: float
    cancelled: threading.Event


_patience: ContextVar[_Patience | None] = ContextVar("patience", default=None)


@contextmanager
def retry_during_outage(at_most_s: float, cancelled: threading.Event) -> Iterator[None]:
    """Let every database call in this context be retried while the database cannot be used.

    For threads that nobody waits for, such as those that take in a job's results. A call may
    have been committed although its answer was lost, so whatever is called here must come to
    the same when it is done twice.

    Args:
        at_most_s: how long each call is retried before it fails.
        cancelled: ends the retries early.
    """
    token = _patience.set(_Patience(at_most_s, cancelled))
    try:
        yield
    finally:
        _patience.reset(token)


class Database:
    """One database. A piece of work is one transaction, done whole or not at all.

    Attributes:
        engine: for who needs connections of their own.
        on_full: called when the disk is full; True if it made room, so that trying again helps.
        owner: the fencing token of the server that writes; None checks none, before it has one.
        is_answering: circuit breaker; while it says False every call fails at once, so that
            threads do not pile up behind a database that hangs.
    """

    def __init__(self, engine: Engine, on_full: Callable[[], bool] = lambda: False) -> None:
        self.engine, self.on_full = engine, on_full
        self.owner: int | None = None
        self.is_answering: Callable[[], bool] = lambda: True
        # SQLite lets those who wait poll, and its pool lets others overtake them, so they starve.
        is_sqlite = engine.dialect.name == "sqlite"
        self._writers = FairSemaphore(1) if is_sqlite else None
        self._connections = FairSemaphore(SQLITE_CONNECTIONS) if is_sqlite else None

    def read(self, work: Callable[[Connection], T]) -> T:
        """Do what only reads; it sees one state of the database throughout.

        Raises:
            StorageFailed: if the database cannot be used.
        """

        def attempt() -> T:
            with (
                _turn(self._connections),
                in_plain_words(),
                self.engine.connect() as connection,
            ):
                return work(connection.execution_options(**{_ONLY_READS: True}))

        return self._retry(attempt)

    def write(self, work: Callable[[Connection], T]) -> T:
        """Do what writes; when this returns, it lasts. It may be tried twice.

        Raises:
            StorageFull: if the disk is full.
            StorageFailed: if the database cannot be used, or is held for over 10 s.
            OwnershipLost: if another server has taken the database over.
        """

        def attempt() -> T:
            try:
                return self._write(work)
            except StorageFull:
                if not self.on_full():
                    raise
            return self._write(work)

        return self._retry(attempt)

    def _retry(self, attempt: Callable[[], T]) -> T:
        """Call until it succeeds, for as long as the context of `retry_during_outage` says."""
        patience = _patience.get()
        began_s, pause_s = time.monotonic(), _FIRST_RETRY_S
        while True:
            try:
                if not self.is_answering():
                    raise _unreachable()
                return attempt()
            except OwnershipLost:
                raise
            except StorageFailed:
                if patience is None or time.monotonic() - began_s > patience.at_most_s:
                    raise
                if patience.cancelled.wait(pause_s):
                    raise
            pause_s = min(2 * pause_s, _LAST_RETRY_S)

    def _write(self, work: Callable[[Connection], T]) -> T:
        with (
            _turn(self._writers),
            _turn(self._connections),
            in_plain_words(),
            self.engine.begin() as connection,
        ):
            self._check_owner(connection)
            return work(connection)

    def _check_owner(self, connection: Connection) -> None:
        """Fence: refuse to write once another server has raised the owner's number."""
        if self.owner is None:
            return
        # The share lock keeps the number as it is until this transaction has ended.
        number = connection.execute(select(ABOUT.c.owner).with_for_update(read=True)).scalar()
        if number != self.owner:
            raise OwnershipLost(
                "another server has taken this database over, so this one writes nothing more"
            )

    def connect(self) -> Connection:
        """A connection of one's own, outside of any transaction; to be closed.

        Raises:
            StorageFailed: if the database cannot be reached.
        """
        with in_plain_words():
            return self.engine.connect().execution_options(isolation_level="AUTOCOMMIT")

    def close(self) -> None:
        """Let go of all connections."""
        self.engine.dispose()


def _turn(semaphore: FairSemaphore | None) -> AbstractContextManager[None]:
    return nullcontext() if semaphore is None else semaphore.taken(BUSY_S, _held)


def sqlite_engine(path: Path) -> Engine:
    """An engine for a file, which is made if it is not there."""
    engine = create_engine(
        URL.create("sqlite", database=str(path)),
        # Without the driver's own transactions, which begin late and so lose updates.
        connect_args={"isolation_level": None, "timeout": BUSY_S},
        # All are kept, and none is opened beyond them.
        pool_size=SQLITE_CONNECTIONS,
        max_overflow=0,
        pool_timeout=BUSY_S,
    )
    event.listen(engine, "connect", _prepare_sqlite)
    event.listen(engine, "begin", _begin_sqlite)
    return engine


def postgresql_engine(url: str) -> Engine:
    """An engine for a PostgreSQL server, whose connections are made when they are needed."""
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
    """Let text that is no UTF-8 be read with what is wrong escaped, instead of failing a query."""
    connection.text_factory = lambda data: data.decode("utf-8", "surrogateescape")


def _prepare_sqlite(connection: sqlite3.Connection, record: object) -> None:
    del record
    decode_leniently(connection)
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        connection.execute(f"PRAGMA {pragma}")


def _begin_sqlite(connection: Connection) -> None:
    only_reads = connection.get_execution_options().get(_ONLY_READS)
    # A transaction that begins to write halfway can find that it is too late, and loses.
    connection.exec_driver_sql("BEGIN" if only_reads else "BEGIN IMMEDIATE")


@contextmanager
def in_plain_words() -> Iterator[None]:
    """Turn the driver's errors into those that a user can read.

    Raises:
        StorageFull, StorageFailed, DamagedFile: in place of the driver's errors.
    """
    try:
        yield
    except IntegrityError:
        raise
    except DBAPIError as error:
        raise _translated(error) from error
    except PoolTimeout as error:
        raise _held() from error


def _translated(error: DBAPIError) -> HexapodError:
    if isinstance(error.orig, sqlite3.Error):
        return _sqlite_error(error.orig)
    state = getattr(error.orig, "sqlstate", None)
    if state in ("53100", "54000"):
        return StorageFull("the disk of the PostgreSQL server is full; make room there")
    if state == "55P03":
        return _held()
    if isinstance(error, OperationalError | InterfaceError):
        return _unreachable()
    return StorageFailed(f"the database refuses ({type(error.orig).__name__})")


def _sqlite_error(error: sqlite3.Error) -> HexapodError:
    code = getattr(error, "sqlite_errorcode", 0)
    kinds: dict[int, Any] = {
        sqlite3.SQLITE_BUSY: _held,
        sqlite3.SQLITE_LOCKED: _held,
        sqlite3.SQLITE_FULL: _full,
        sqlite3.SQLITE_CORRUPT: _damaged,
        sqlite3.SQLITE_NOTADB: _damaged,
    }
    # A limit on the size of files is met as an error of a write.
    found = _full if code == sqlite3.SQLITE_IOERR_WRITE else kinds.get(code & _SECONDARY)
    return found() if found else StorageFailed(f"the database cannot be used ({error})")


def _unreachable() -> StorageFailed:
    return StorageFailed("the PostgreSQL server does not answer; see that it runs")


def _held() -> HexapodError:
    return StorageFailed(
        f"another program holds the database for over {BUSY_S:g} s; close it, then try again"
    )


def _full() -> HexapodError:
    return StorageFull("the disk of the data folder is full; delete runs, or make room there")


def _damaged() -> HexapodError:
    return DamagedFile(
        "the database file in the data folder is damaged, or is no database; move it away to "
        "begin anew, or put a copy of it back"
    )
