"""Create a SQLite file by atomic rename, and refuse one that has lost its tables.

SQLite treats an empty file as a new database. Accepting one would hide that a full disk or an
incomplete copy has lost all runs.
"""

import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.migration import check_revisions, migrate
from hexapods.domain.errors import DamagedFile
from hexapods.files import sync_folder

_TABLES = frozenset({"alembic_version", "about", "runs", "evaluations", "artifacts"})
"""Tables that every schema has."""
_REVISIONS = "SELECT version_num FROM alembic_version"
SUFFIXES = ("", "-wal", "-shm")
_ADVICE = (
    "put a backup of it back, with its artifacts; or, if nothing is missed, move it away, and the "
    "next start begins anew"
)


def create_file(path: Path, on_disk_full: Callable[[], bool]) -> None:
    """Create a database with this version's schema by atomic rename, unless the file exists.

    Args:
        path: of the file.
        on_disk_full: called when the disk is full; returns True if it freed space.

    Raises:
        StorageFull, StorageFailed: if it cannot be created.
    """
    if path.exists():
        return
    new = path.with_name(f"{path.name}.new")
    for suffix in SUFFIXES:
        # Leftovers of a killed start, and a stale `-wal` of another database at this path.
        new.with_name(new.name + suffix).unlink(missing_ok=True)
        path.with_name(path.name + suffix).unlink(missing_ok=True)
    # SQLite gives the files beside it the same permissions.
    new.touch(mode=0o600)
    with closing(Database(sqlite_engine(new), on_disk_full)) as database:
        migrate(database)
    new.replace(path)
    sync_folder(path.parent)


def file_identity(path: Path) -> tuple[int, int] | None:
    """Return device and inode of a file; None if there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_dev, status.st_ino


def check_file(path: Path, artifacts: Path) -> None:
    """Check that an existing database file has its tables, and is of a version that is read.

    A missing file is accepted. Nothing is written.

    Args:
        path: of the file.
        artifacts: folder of the artifact files of all databases that were used in the data folder;
            if it is empty, a database without any tables is accepted as new.

    Raises:
        DamagedFile: if the file is empty or lacks tables.
        InvalidInput: if a newer version made it, or one before 0.3.
    """
    if not path.exists():
        return
    if not path.stat().st_size:
        raise DamagedFile(
            f"the database file {path} is empty, so that all in it is lost; {_ADVICE}"
        )
    try:
        # Opened by URI, because read-only mode is available there only.
        with closing(sqlite3.connect(f"file:{quote(str(path))}?mode=ro", uri=True)) as connection:
            rows = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
            missing = _TABLES - {name for (name,) in rows}
            if not missing:
                check_revisions(row for (row,) in connection.execute(_REVISIONS))
    except sqlite3.Error:
        # Opening the database afterwards reports the error.
        return
    never_used = missing == _TABLES and not (artifacts.is_dir() and any(artifacts.iterdir()))
    if missing and not never_used:
        raise DamagedFile(
            f"the database file {path} has lost its tables {', '.join(sorted(missing))}; {_ADVICE}"
        )
