"""The open files of a process, from Linux's `/proc`."""

from pathlib import Path

from app.storage.database.opening import DATABASE_FILE


def open_files(pid: int) -> list[str]:
    """Return the target of each open file descriptor of a process."""
    targets = []
    for link in Path(f"/proc/{pid}/fd").iterdir():
        try:
            targets.append(str(link.readlink()))
        except FileNotFoundError:
            continue  # closed in the meantime
    return targets


def database_files(pid: int, data: Path) -> list[str]:
    """Return the open files of a data folder's SQLite database: file, WAL and shared memory."""
    return [name for name in open_files(pid) if name.startswith(str(data / DATABASE_FILE))]
