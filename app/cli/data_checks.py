"""Checks of `hexapods doctor` on the data folder, the database and the server's address."""

import os
import shutil
import socket
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from pathlib import Path

from app.cli.machine_checks import CheckFailed
from app.events.damage import damaged_rows, damaged_runs
from app.feature import Feature, blaming
from app.installed_features import load
from app.setting_fields import PREFIX
from app.settings import ROBOTS_FOLDER, Settings
from app.storage.database.opening import ENTRIES
from app.storage.database.read_only import open_read_only
from app.storage.database.robots import damaged_robots
from app.storage.database.stored_rows import MAX_NAMED
from app.storage.disk_space import MB, DiskSpace
from app.storage.private_folder import exposed_paths
from app.storage.server_lock import LOCK_FILE, FolderInUse, lock_folder, read_address_file
from hexapods.domain.errors import HexapodError
from hexapods.domain.text import counted

WANTED_FREE_MB = 200
_NEARLY_FULL = 0.9
_MAX_NAMED = 10
_BACKUP = "put a backup of the database back"
_ADVICE: Mapping[str, str] = {
    "about": "the next start of a server mends it",
    "runs": "delete these runs, or put a backup back",
    "evaluations": "delete these trainings, or put a backup back",
    "artifacts": "delete these runs, or put a backup back",
    "idempotency_keys": "nothing needs to be done: a repeated request with such a key is refused",
    "sessions": "nothing needs to be done: the next start of a server with a token deletes them, "
    "and who had one opens the address with the token again",
    "robots": "import the files of these robots again, or put a backup back",
}
"""By table of the core what helps against its damaged rows."""


def _folder(settings: Settings) -> str:
    """Check that the data folder is writable, without creating it."""
    folder = settings.data
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        raise CheckFailed(
            f"{there} cannot be written by this user; give it to this user, or choose another "
            f"data folder with --data or {PREFIX}DATA"
        )
    if there != folder:
        return f"{folder} will be made when a server starts"
    with tempfile.TemporaryFile(dir=folder):
        pass
    if exposed := exposed_paths(folder, ENTRIES):
        raise CheckFailed(
            f"other users of this machine can open {', '.join(map(str, exposed))}, and stop all "
            "writes by a lock: take their permissions with `chmod go-rwx`"
        )
    return f"{folder} can be written, and is closed to other users"


def _disk_space(settings: Settings) -> str:
    there = next(path for path in (settings.data, *settings.data.parents) if path.exists())
    free_mb = shutil.disk_usage(there).free // MB
    if free_mb < WANTED_FREE_MB:
        raise CheckFailed(
            f"the disk has {free_mb:,} MB left, and runs need some: make room for "
            f"{WANTED_FREE_MB} MB at least, or delete runs"
        )
    used_mb = DiskSpace(settings.data).used_bytes() // MB if there == settings.data else 0
    if settings.quota_mb is None:
        return f"{used_mb:,} MB are used, {free_mb:,} MB are free, and there is no quota"
    if used_mb >= _NEARLY_FULL * settings.quota_mb:
        raise CheckFailed(
            f"{used_mb:,} MB of {settings.quota_mb:,} MB are used: delete runs, or raise "
            f"{PREFIX}QUOTA_MB"
        )
    return f"{used_mb:,} MB of {settings.quota_mb:,} MB are used, {free_mb:,} MB are free"


def _lock(settings: Settings) -> str:
    if not _is_locked(settings.data):
        return "no server has the data folder now"
    address = read_address_file(settings.data) or "an address unsaid"
    return f"a server has the data folder, at {address}"


def _database(settings: Settings) -> str:
    # The URL is not shown, because it may contain a password.
    kind = "SQLite in the data folder" if settings.database_url is None else "PostgreSQL"
    with open_read_only(settings) as store:
        has_runs = bool(store.list(limit=1).items)
        damaged = damaged_runs(store)
    if damaged:
        named = "; ".join(
            f"{run.kind or 'run'} {run.id}: {run.damaged}" for run in damaged[:_MAX_NAMED]
        )
        raise CheckFailed(
            f"{len(damaged):,} of the runs cannot be shown, {named}; remove them with `hexapods "
            "runs delete`, or put a backup back"
        )
    return f"{kind} can be read, " + ("and has runs" if has_runs else "and is empty or to be made")


def _robots(settings: Settings) -> str:
    with open_read_only(settings) as store:
        robots = store.robots.stored(hidden=True)
        damaged = damaged_robots(robots)
    if damaged:
        names = {one.id: one.name for one in robots}
        named = "; ".join(
            f"{names[robot_id]} ({robot_id}): {reason}"
            for robot_id, reason in [*damaged.items()][:_MAX_NAMED]
        )
        raise CheckFailed(
            f"{len(damaged):,} of the stored robots cannot be read, {named}; put a backup of "
            f"{settings.data / ROBOTS_FOLDER} back, or import their files again"
        )
    return f"{len(robots):,} stored, which can all be read" if robots else "none is stored"


def _rows(settings: Settings) -> str:
    """Check that every row of every table can be read."""
    features = load(settings.without).classes
    tables = [feature.tables for feature in features if feature.tables is not None]
    with open_read_only(settings, *tables) as store:
        # What the rows stand for is known to those who read them.
        for feature in features:
            with blaming(feature, "`read_rows`"):
                feature.read_rows(store)
        damaged = {table: rows for table, rows in damaged_rows(store).items() if rows}
    if damaged:
        raise CheckFailed(
            ". ".join(
                f"{counted(len(rows), 'row')} of {table} cannot be read: "
                f"{'; '.join(map(str, rows[:MAX_NAMED]))}: "
                f"{advice(features).get(table, _BACKUP)}"
                for table, rows in damaged.items()
            )
        )
    return "those of all tables can be read"


def advice(features: Iterable[type[Feature]]) -> Mapping[str, str]:
    """Return by table of the database what helps against its damaged rows."""
    return {**_ADVICE, **{t: text for one in features for t, text in one.damage_advice.items()}}


def _address(settings: Settings) -> str:
    where = f"{settings.host} port {settings.port}"
    if _can_listen(settings):
        return f"{where} is free"
    recorded_address = read_address_file(settings.data) or ""
    if _is_locked(settings.data) and recorded_address.rstrip("/").endswith(f":{settings.port}"):
        return f"{where} is where this data folder's server listens"
    raise CheckFailed(
        f"something else listens on {where}, or the address is not this machine's; choose another "
        f"with {PREFIX}HOST and {PREFIX}PORT"
    )


def _can_listen(settings: Settings) -> bool:
    """Whether the address belongs to this machine and is free."""
    try:
        candidates = socket.getaddrinfo(settings.host, settings.port, type=socket.SOCK_STREAM)
        family, kind, protocol, _, address = candidates[0]
        with socket.socket(family, kind, protocol) as probe:
            if sys.platform != "win32":
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
            probe.listen(1)
    except OSError:
        return False
    return True


def _is_locked(folder: Path) -> bool:
    if not (folder / LOCK_FILE).exists():
        return False
    try:
        with lock_folder(folder):
            return False
    except FolderInUse:
        return True


_CHECKS: Mapping[str, Callable[[Settings], str]] = {
    "data folder": _folder,
    "room": _disk_space,
    "lock": _lock,
    "database": _database,
    "rows": _rows,
    "robots": _robots,
    "address": _address,
}


def data_checks(settings: Settings) -> Mapping[str, Callable[[Settings], str]]:
    """Return the checks by their titles, with those of the features that can be loaded."""
    checks = {"features": _features, **_CHECKS}
    with suppress(HexapodError):
        for feature in load(settings.without).classes:
            checks |= _checks_of(feature)
    return checks


def _checks_of(feature: type[Feature]) -> Mapping[str, Callable[[Settings], str]]:
    """Return the checks of a feature; one that tells how it failed, if it cannot say them."""
    try:
        with blaming(feature, "`checks`"):
            return feature.checks()
    except HexapodError as error:
        failure = str(error)

    def fail(settings: Settings) -> str:
        del settings
        raise CheckFailed(failure)

    return {feature.name: fail}


def _features(settings: Settings) -> str:
    names = [feature.name for feature in load(settings.without).classes]
    without = f"; left out: {', '.join(settings.without)}" if settings.without else ""
    return f"{', '.join(names) or 'none'}{without}"
