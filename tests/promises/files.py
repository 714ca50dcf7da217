"""The open files of a process, as Linux counts them."""

from pathlib import Path

from app.storage.database.opening import DATABASE_FILE


def open_files(pid: int) -> list[str]:
    """What each open file descriptor of a process leads to."""
    found = []
    for link in Path(f"/proc/{pid}/fd").iterdir():
        try:
            found.append(str(link.readlink()))
        except FileNotFoundError:
            continue  # it was closed meanwhile
    return found


def database_files(pid: int, data: Path) -> list[str]:
    """Those of the SQLite database in a data folder: itself, its log, and the log's index."""
    return [name for name in open_files(pid) if name.startswith(str(data / DATABASE_FILE))]
