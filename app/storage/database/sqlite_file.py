"""The file of a SQLite database: begun whole, and refused if it has lost what it held.

SQLite takes a file of no length for a database that is yet to be filled. To go on with one would
hide that a full disk, or a copy that broke off, has cost every run.
"""

import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

from app.domain.errors import DamagedFile
from app.storage.artifacts import sync_folder
from app.storage.database.engine import Database, sqlite_engine
from app.storage.database.migration import migrate

_TABLES = frozenset({"alembic_version", "about", "runs", "evaluations", "artifacts"})
"""Of the first released schema; all later ones have them too."""
_BESIDE = ("", "-wal", "-shm")
_WHAT_TO_DO = (
    "put a backup of it back, with its artifacts; or, if nothing is missed, move it away, and the "
    "next start begins anew"
)


def begin_file(path: Path, on_full: Callable[[], bool]) -> None:
    """Make a database with this version's schema, unless there is one: whole or not at all.

    Args:
        path: of the file.
        on_full: called when the disk is full; True if it made room.

    Raises:
        StorageFull, StorageFailed: if it cannot be made.
    """
    if path.exists():
        return
    new = path.with_name(f"{path.name}.new")
    for suffix in _BESIDE:
        # Of a start that was killed; and a log without its database says nothing of this one.
        new.with_name(new.name + suffix).unlink(missing_ok=True)
        path.with_name(path.name + suffix).unlink(missing_ok=True)
    with closing(Database(sqlite_engine(new), on_full)) as database:
        migrate(database)
    new.replace(path)
    sync_folder(path.parent)


def check_file(path: Path, artifacts: Path) -> None:
    """Refuse a database that has lost its tables; one that is not there is yet to be begun.

    Args:
        path: of the file.
        artifacts: the folder of the runs' files, of all databases that were ever used here.

    Raises:
        DamagedFile: if it has lost what it held.
    """
    if not path.exists():
        return
    if not path.stat().st_size:
        raise DamagedFile(
            f"the database file {path} is empty, so that all in it is lost; {_WHAT_TO_DO}"
        )
    try:
        # Not by a path: only a URI can ask for no writing.
        with closing(sqlite3.connect(f"file:{quote(str(path))}?mode=ro", uri=True)) as connection:
            rows = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
            missing = _TABLES - {name for (name,) in rows}
    except sqlite3.Error:
        # Whoever opens it in earnest says what is wrong.
        return
    never_used = missing == _TABLES and not (artifacts.is_dir() and any(artifacts.iterdir()))
    if missing and not never_used:
        raise DamagedFile(
            f"the database file {path} has lost its tables {', '.join(sorted(missing))}; "
            f"{_WHAT_TO_DO}"
        )
