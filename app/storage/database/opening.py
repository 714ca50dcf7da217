"""Open the store of a server: lock, migrate, claim ownership, and recover from a crash."""

import logging
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from app.settings import ROBOTS_FOLDER, Settings
from app.storage.artifacts import ArtifactFiles
from app.storage.database.deletions import Deletions
from app.storage.database.engine import Database, postgresql_engine, sqlite_engine
from app.storage.database.migration import migrate
from app.storage.database.ownership import Ownership, claim
from app.storage.database.robots import RobotStore
from app.storage.database.sqlite_file import SUFFIXES, check_file, create_file
from app.storage.database.store import RunStore
from app.storage.disk_space import RESERVE_FILE, DiskSpace
from app.storage.private_folder import make_private
from app.storage.run_kind import kinds_without
from app.storage.server_lock import ADDRESS_FILE, LOCK_FILE, lock_folder
from hexapods.files import sync_folder

DATABASE_FILE = "hexapods.db"
ARTIFACTS_FOLDER = "artifacts"
ENTRIES = (
    *(name + suffix for name in (DATABASE_FILE, f"{DATABASE_FILE}.new") for suffix in SUFFIXES),
    ARTIFACTS_FOLDER,
    ROBOTS_FOLDER,
    RESERVE_FILE,
    LOCK_FILE,
    ADDRESS_FILE,
)
"""All that a data folder holds."""
_logger = logging.getLogger(__name__)


@contextmanager
def open_store(
    settings: Settings, on_lost: Callable[[], object] = lambda: None
) -> Iterator[RunStore]:
    """Open the store of a server exclusively, for as long as the context lasts.

    Runs that a crashed server left unended become `interrupted`; its orphaned files are deleted.

    Args:
        settings: of the server.
        on_lost: called from another thread if another server claims the database nevertheless,
            which is possible after an outage of PostgreSQL; all writes fail from then on.

    Raises:
        InvalidInput: if another server owns the database, a newer version created it or one before
            1.0, or the data folder is not writable.
        DamagedFile: if the database is empty, or lacks tables.
        StorageFailed: if the database is damaged or unavailable.
    """
    settings.prepare_data()
    make_private(settings.data, ENTRIES)
    with lock_folder(settings.data):
        disk_space = DiskSpace(settings.data, settings.quota_mb)
        with closing(_database(settings, disk_space)) as database:
            ownership = Ownership(database, on_lost)
            with _locked(ownership):
                migrate(database)
                database_id = claim(database, settings.data / ARTIFACTS_FOLDER).database_id
                files, robots = (
                    _folder(settings.data / name, database_id)
                    for name in (ARTIFACTS_FOLDER, ROBOTS_FOLDER)
                )
                deletions = Deletions(database, disk_space)
                store = RunStore(
                    database,
                    ArtifactFiles(files, disk_space),
                    RobotStore(database, robots, disk_space, deletions),
                    deletions,
                    kinds_without(settings.without),
                )
                _recover(store)
                with store.robots.known(), ownership.watched():
                    yield store


def _folder(parent: Path, database_id: str) -> Path:
    """Return the folder of a database within another one, made if it is not there."""
    folder = parent / database_id
    parent.mkdir(mode=0o700, exist_ok=True)
    folder.mkdir(mode=0o700, exist_ok=True)
    sync_folder(parent)
    return folder


@contextmanager
def _locked(ownership: Ownership) -> Iterator[None]:
    try:
        ownership.lock()
        yield
    finally:
        ownership.release()


def _recover(store: RunStore) -> None:
    """Clean up after a crash: delete orphaned files, mark unended runs as interrupted."""
    orphans = store.delete_orphans() + store.robots.delete_orphans()
    interrupted = store.interrupt_all()
    if orphans or interrupted:
        _logger.warning(
            "The last server died: %d runs are interrupted, %d unfinished files are gone",
            len(interrupted),
            orphans,
        )


def _database(settings: Settings, disk_space: DiskSpace) -> Database:
    if settings.database_url is not None:
        return Database(postgresql_engine(settings.database_url))
    path = settings.data / DATABASE_FILE
    check_file(path, settings.data / ARTIFACTS_FOLDER)
    disk_space.reserve()
    create_file(path, on_disk_full=disk_space.release)
    return Database(sqlite_engine(path), on_disk_full=disk_space.release)
