"""Opens the store that a server keeps its runs in, and makes it whole after whatever happened."""

import logging
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager

from app.settings import Settings
from app.storage.artifacts import ArtifactFiles
from app.storage.database.engine import Database, postgresql_engine, sqlite_engine
from app.storage.database.folder_lock import lock_folder
from app.storage.database.migration import migrate
from app.storage.database.ownership import Ownership, claim
from app.storage.database.sqlite_file import begin_file, check_file
from app.storage.database.store import SqlStore
from app.storage.disk_space import DiskSpace

DATABASE_FILE = "hexapods.db"
ARTIFACTS_FOLDER = "artifacts"
_logger = logging.getLogger(__name__)


@contextmanager
def open_store(
    settings: Settings, on_lost: Callable[[], object] = lambda: None
) -> Iterator[SqlStore]:
    """The store of a server, for as long as the context lasts; no other server can have it.

    Runs that a dead server left behind become `interrupted`, and its unfinished files go.

    Args:
        settings: of the server.
        on_lost: called from another thread if another server takes the database over all the
            same, as it may after an outage; every write fails from then on.

    Raises:
        InvalidInput: if another server has it, or a newer version made it, or the data folder
            cannot be written.
        DamagedFile: if the database is damaged.
        StorageFailed: if the database cannot be used.
    """
    settings.prepare_data()
    with lock_folder(settings.data):
        room = DiskSpace(settings.data, settings.quota_mb)
        with closing(_database(settings, room)) as database:
            ownership = Ownership(database, on_lost)
            with _locked(ownership):
                migrate(database)
                taken = claim(database)
                files = ArtifactFiles(settings.data / ARTIFACTS_FOLDER / taken.database_id, room)
                store = SqlStore(database, files)
                _tidy(store)
                with ownership.watched():
                    yield store


@contextmanager
def _locked(ownership: Ownership) -> Iterator[None]:
    try:
        ownership.lock()
        yield
    finally:
        ownership.release()


def _tidy(store: SqlStore) -> None:
    """Make whole what a dead server left behind."""
    left_behind, interrupted = store.delete_orphans(), store.interrupt_all()
    if left_behind or interrupted:
        _logger.warning(
            "The last server died: %d runs are interrupted, %d unfinished files are gone",
            len(interrupted),
            left_behind,
        )


def _database(settings: Settings, room: DiskSpace) -> Database:
    if settings.database_url is not None:
        return Database(postgresql_engine(settings.database_url))
    room.reserve()
    path = settings.data / DATABASE_FILE
    check_file(path, settings.data / ARTIFACTS_FOLDER)
    begin_file(path, on_full=room.release)
    return Database(sqlite_engine(path), on_full=room.release)
