"""Checks of `hexapods doctor` that depend on settings: machine, stored data, address."""

import os
import shutil
import socket
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

from sqlalchemy import MetaData, inspect

from app.cli.machine_checks import CheckFailed
from app.events.damage import damaged_rows, damaged_runs
from app.feature import Feature, blaming
from app.installed_features import load
from app.setting_fields import PREFIX
from app.settings import ROBOTS_FOLDER, Settings
from app.storage.database.opening import ENTRIES
from app.storage.database.read_only import open_read_only
from app.storage.database.robots import damaged_robots
from app.storage.database.store import RunStore
from app.storage.database.stored_rows import MAX_NAMED
from app.storage.disk_space import MB, DiskSpace
from app.storage.private_folder import exposed_paths
from app.storage.server_lock import LOCK_FILE, FolderInUse, lock_folder, read_address_file
from hexapods import machine
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
    "baselines": "nothing needs to be done: they are measured again",
    "idempotency_keys": "nothing needs to be done: a repeated request with such a key is refused",
    "sessions": "nothing needs to be done: the next start of a server with a token deletes them, "
    "and who had one opens the address with the token again",
    "robots": "import the files of these robots again, or put a backup back",
}
"""By table of the core what helps against its damaged rows."""


def _machine(settings: Settings) -> str:
    """Check the room on the disk and in the quota; say what cores and memory may be used."""
    folder = next(path for path in (settings.data, *settings.data.parents) if path.exists())
    free_mb = shutil.disk_usage(folder).free // MB
    if free_mb < WANTED_FREE_MB:
        raise CheckFailed(
            f"the disk has {free_mb:,} MB left, and runs need some: make room for "
            f"{WANTED_FREE_MB} MB at least, or delete runs"
        )
    used_mb = DiskSpace(settings.data).used_bytes() // MB if folder == settings.data else 0
    quota_mb = settings.quota_mb
    if quota_mb is not None and used_mb >= _NEARLY_FULL * quota_mb:
        raise CheckFailed(
            f"{used_mb:,} MB of {quota_mb:,} MB are used: delete runs, or raise {PREFIX}QUOTA_MB"
        )
    return ", ".join(
        [
            f"{counted(machine.cores(), 'core')} for a job each",
            f"{machine.memory_bytes() // MB:,} MB of memory",
            f"{used_mb:,} MB {f'of {quota_mb:,} MB ' if quota_mb is not None else ''}used on disk",
            f"{free_mb:,} MB free",
        ]
    )


def _data(settings: Settings) -> str:
    """Check that the data folder is writable and closed to others, and all stored data readable."""
    folder = settings.data
    existing = next(path for path in (folder, *folder.parents) if path.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise CheckFailed(
            f"{existing} cannot be written by this user; give it to this user, or choose another "
            f"data folder with --data or {PREFIX}DATA"
        )
    if existing == folder:
        with tempfile.TemporaryFile(dir=folder):
            pass
        if exposed := exposed_paths(folder, ENTRIES):
            raise CheckFailed(
                f"other users of this machine can open {', '.join(map(str, exposed))}, and stop "
                "all writes by a lock: take their permissions with `chmod go-rwx`"
            )
    features = load(settings.without).classes
    with open_read_only(settings) as store:
        existing_tables = store.database.read(lambda database: inspect(database).get_table_names())
        for feature in features:
            tables = MetaData() if feature.tables is None else feature.tables
            # Those of a feature are made when a server that has it starts.
            if tables.tables and tables.tables.keys().isdisjoint(existing_tables):
                continue
            store.database.tables += tables.sorted_tables
            # What the rows stand for is known to those who read them.
            with blaming(feature, "`read_rows`"):
                feature.read_rows(store)
        damage = [*_damaged_runs(store), *_damaged_robots(store, folder)]
        damage += _damaged_rows(store, features)
    if damage:
        raise CheckFailed(". ".join(damage))
    # The URL is not shown, because it may contain a password.
    kind = "SQLite" if settings.database_url is None else "PostgreSQL"
    state = "all rows can be read" if existing == folder else "made when a server starts"
    return f"{folder} with {kind}, {state}"


def _damaged_runs(store: RunStore) -> Iterator[str]:
    if damaged := damaged_runs(store):
        reasons = "; ".join(
            f"{run.kind or 'run'} {run.id}: {run.damaged}" for run in damaged[:_MAX_NAMED]
        )
        yield (
            f"{len(damaged):,} of the runs cannot be shown, {reasons}; remove them with `hexapods "
            "runs delete`, or put a backup back"
        )


def _damaged_robots(store: RunStore, folder: Path) -> Iterator[str]:
    robots = store.robots.stored(hidden=True)
    if damaged := damaged_robots(robots):
        names = {robot.id: robot.name for robot in robots}
        reasons = "; ".join(
            f"{names[robot_id]} ({robot_id}): {reason}"
            for robot_id, reason in [*damaged.items()][:_MAX_NAMED]
        )
        yield (
            f"{len(damaged):,} of the stored robots cannot be read, {reasons}; put a backup of "
            f"{folder / ROBOTS_FOLDER} back, or import their files again"
        )


def _damaged_rows(store: RunStore, features: Iterable[type[Feature]]) -> Iterator[str]:
    for table, rows in damaged_rows(store).items():
        if rows:
            yield (
                f"{counted(len(rows), 'row')} of {table} cannot be read: "
                f"{'; '.join(map(str, rows[:MAX_NAMED]))}: "
                f"{advice(features).get(table, _BACKUP)}"
            )


def advice(features: Iterable[type[Feature]]) -> Mapping[str, str]:
    """Return by table of the database what helps against its damaged rows."""
    return {
        **_ADVICE,
        **{t: text for feature in features for t, text in feature.damage_advice.items()},
    }


def _address(settings: Settings) -> str:
    """Check that the port is free, or the data folder's own server's, and operators are known."""
    address = f"{settings.host} port {settings.port}"
    if settings.public_url is not None and settings.token is None:
        raise CheckFailed(
            f"{PREFIX}PUBLIC_URL offers the server at {settings.public_url}, and without a token "
            f"anyone who reaches it is an operator; set {PREFIX}TOKEN"
        )
    if _can_listen(settings):
        return f"{address} is free"
    recorded_address = read_address_file(settings.data) or ""
    if _is_locked(settings.data) and recorded_address.rstrip("/").endswith(f":{settings.port}"):
        return f"{address} is where this data folder's server listens"
    raise CheckFailed(
        f"something else listens on {address}, or the address is not this machine's; choose "
        f"another with {PREFIX}HOST and {PREFIX}PORT"
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


CHECKS: Mapping[str, Callable[[Settings], str]] = {
    "machine": _machine,
    "data": _data,
    "address": _address,
}
