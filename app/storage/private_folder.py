"""Keep the other users of this machine out of the data folder.

Its files hold the operator's sessions. And whoever may open `hexapods.db-shm` or `server.lock`,
even for reading only, can hold a lock on it that stops all writes.
"""

import logging
import stat
import sys
from collections.abc import Collection
from pathlib import Path

_OTHERS = stat.S_IRWXG | stat.S_IRWXO
_OF_THE_FILE_SYSTEM = "lost+found"
_logger = logging.getLogger(__name__)


def make_private(folder: Path, entries: Collection[str]) -> None:
    """Take all permissions of other users from a folder and its entries, and log it.

    A folder that holds more than its entries keeps its permissions: other things may be meant for
    others. What then is left open, and what another user owns, is logged as a warning.

    Args:
        folder: an existing folder.
        entries: names of the files and folders that it should hold; not all need to exist.
    """
    if sys.platform == "win32":
        return
    has_others = any(path.name not in (*entries, _OF_THE_FILE_SYSTEM) for path in folder.iterdir())
    paths = [folder / name for name in entries]
    changed = [path for path in (paths if has_others else [folder, *paths]) if _tighten(path)]
    if changed:
        _logger.info("Other users can no longer open %s", ", ".join(map(str, changed)))
    if exposed := exposed_paths(folder, entries):
        _logger.warning(
            "Other users can open %s; take their permissions with chmod go-rwx, or choose a data "
            "folder of its own",
            ", ".join(map(str, exposed)),
        )


def exposed_paths(folder: Path, entries: Collection[str]) -> list[Path]:
    """Return folder and entries that other users have permissions for; none in a closed folder.

    Args:
        folder: an existing folder.
        entries: names of the files and folders that it should hold.
    """
    if sys.platform == "win32" or not _is_exposed(folder):
        return []
    return [folder, *filter(_is_exposed, (folder / name for name in entries))]


def _is_exposed(path: Path) -> bool:
    try:
        return bool(path.stat().st_mode & _OTHERS)
    except OSError:  # there is no such entry, or not any more
        return False


def _tighten(path: Path) -> bool:
    """Remove the permissions of other users; return whether there were some, and are gone."""
    if path.is_symlink() or not _is_exposed(path):
        return False
    try:
        path.chmod(stat.S_IMODE(path.stat().st_mode) & ~_OTHERS)
    except OSError:
        return False
    return not _is_exposed(path)
