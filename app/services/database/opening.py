"""Opens the store that a server keeps its runs in, and makes it whole after whatever happened."""

import logging
import secrets
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager

from sqlalchemy import Connection, insert, select, text

from app.domain.errors import InvalidInput
from app.services.artifacts import ArtifactFiles
from app.services.database.engine import Database, postgresql_engine, sqlite_engine
from app.services.database.folder_lock import lock_folder
from app.services.database.migrating import migrate
from app.services.database.schema import ABOUT
from app.services.database.store import SqlStore
from app.services.room import Room
from app.settings import Settings

DATABASE_FILE = "hexapods.db"
ARTIFACTS_FOLDER = "artifacts"
_LOCK_NUMBER = 0x6865_7861_706F_6473
_LOCK_WAIT_S = 5.0
_logger = logging.getLogger(__name__)


@contextmanager
def open_store(settings: Settings) -> Iterator[SqlStore]:
    """The store of a server, for as long as the context lasts; no other server can have it.

    Runs that a dead server left behind become `interrupted`, and its unfinished files go.

    Raises:
        InvalidInput: if another server has it, or a newer version made it, or the data folder
            cannot be written.
        DamagedFile: if the database is damaged.
        StorageFailed: if the database cannot be used.
    """
    settings.prepare_data()
    with lock_folder(settings.data):
        room = Room(settings.data, settings.quota_mb)
        with closing(_database(settings, room)) as database, _keep_for_us(database):
            migrate(database)
            folder = settings.data / ARTIFACTS_FOLDER / database.write(_id)
            store = SqlStore(database, ArtifactFiles(folder, room))
            left_behind, interrupted = store.sweep(), store.interrupt_all()
            if left_behind or interrupted:
                _logger.warning(
                    "The last server died: %d runs are interrupted, %d unfinished files are gone",
                    len(interrupted),
                    left_behind,
                )
            yield store


def _database(settings: Settings, room: Room) -> Database:
    if settings.database_url is not None:
        return Database(postgresql_engine(settings.database_url))
    room.reserve()
    return Database(sqlite_engine(settings.data / DATABASE_FILE), on_full=room.release)


@contextmanager
def _keep_for_us(database: Database) -> Iterator[None]:
    """Keep a database that can be reached from elsewhere to this server.

    PostgreSQL lets go when the connection ends, which may be a moment after its process has.
    """
    if database.engine.dialect.name != "postgresql":
        yield
        return
    ask = text("SELECT pg_try_advisory_lock(:number)")
    with database.connected() as connection:
        deadline = time.monotonic() + _LOCK_WAIT_S
        while not connection.execute(ask, {"number": _LOCK_NUMBER}).scalar_one():
            if time.monotonic() > deadline:
                raise InvalidInput(
                    "another server uses this PostgreSQL database; stop it, or name another "
                    "database in HEXAPODS_DATABASE_URL"
                )
            time.sleep(0.1)
        yield


def _id(connection: Connection) -> str:
    """The id of the database, made when it is first asked for."""
    found = connection.execute(select(ABOUT.c.id)).scalar()
    if found is None:
        found = secrets.token_hex(8)
        connection.execute(insert(ABOUT), [{"id": found}])
    return found
