"""Open the store of a data folder read-only, also while its server runs."""

import sqlite3
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from urllib.parse import quote

from sqlalchemy import Connection, Engine, create_engine, event, select
from sqlalchemy.pool import NullPool, StaticPool

from app.settings import ROBOTS_FOLDER, Settings
from app.storage.artifacts import ArtifactFiles
from app.storage.database.deletions import Deletions
from app.storage.database.engine import BUSY_S, Database, decode_leniently, postgresql_engine
from app.storage.database.migration import check_current
from app.storage.database.opening import ARTIFACTS_FOLDER, DATABASE_FILE
from app.storage.database.ownership import id_of_files
from app.storage.database.robots import RobotStore
from app.storage.database.schema import ABOUT, METADATA
from app.storage.database.sqlite_file import check_file
from app.storage.database.store import RunStore
from app.storage.disk_space import DiskSpace
from app.storage.run_kind import kinds_without


@contextmanager
def open_read_only(settings: Settings) -> Iterator[RunStore]:
    """Open the store read-only; an empty one if no server has ever used this data folder.

    Args:
        settings: of the server.

    Raises:
        InvalidInput: if it has the schema of another version.
        DamagedFile: if the database is empty, or lacks tables.
        StorageFailed: if it is damaged, or cannot be read.
    """
    with ExitStack() as stack:
        database = stack.enter_context(closing(Database(_engine(settings))))
        database_id = database.read(_id)
        if database_id is None:
            database = stack.enter_context(closing(Database(_empty_engine())))
        disk_space, artifacts = DiskSpace(settings.data), settings.data / ARTIFACTS_FOLDER
        name = id_of_files(database_id, artifacts) or "none"
        files = ArtifactFiles(artifacts / name, disk_space)
        deletions = Deletions(database, disk_space)
        robots = RobotStore(database, settings.data / ROBOTS_FOLDER / name, disk_space, deletions)
        stack.enter_context(robots.known())
        yield RunStore(database, files, robots, deletions, kinds_without(settings.without))


def _engine(settings: Settings) -> Engine:
    if settings.database_url is not None:
        engine = postgresql_engine(settings.database_url)
        event.listen(engine, "connect", _set_read_only)
        return engine
    path = settings.data / DATABASE_FILE
    check_file(path, settings.data / ARTIFACTS_FOLDER)
    return _sqlite_engine(path) if path.is_file() else _empty_engine()


def _empty_engine() -> Engine:
    """Create an engine for a database in memory, with tables but no rows."""
    engine = create_engine("sqlite://", poolclass=StaticPool)
    METADATA.create_all(engine)
    return engine


def _sqlite_engine(path: Path) -> Engine:
    def connect() -> sqlite3.Connection:
        # By URI, because read-only mode is available there only.
        uri = f"file:{quote(str(path))}?mode=ro"
        connection = sqlite3.connect(uri, timeout=BUSY_S, isolation_level=None, uri=True)
        decode_leniently(connection)
        return connection

    engine = create_engine("sqlite://", creator=connect, poolclass=NullPool)
    event.listen(engine, "begin", lambda connection: connection.exec_driver_sql("BEGIN"))
    return engine


def _set_read_only(connection: object, record: object) -> None:
    del record
    connection.read_only = True  # type: ignore[attr-defined] # psycopg's


def _id(connection: Connection) -> str | None:
    """Return the id of the database; None if its tables do not exist yet."""
    if not check_current(connection):
        return None
    database_id: str | None = connection.execute(select(ABOUT.c.id)).scalar()
    return database_id
