"""How many files the process may have open, and how many of them are for connections."""

import os
import sys

from app.limits.connections import OPERATOR_SLOTS, ConnectionTable
from app.limits.listener import ACCEPTS_AT_ONCE
from app.settings import Settings

MOST_CONNECTIONS = 2000
"""Unless the settings say more: each costs memory as well."""
_MOST_FILES = 65_536
_OWN_FILES, _OWN_FILES_PER_CORE = 224, 8
"""Kept for the database, the threads that read artifacts, viser, and the pipes of jobs."""


def raise_file_limit() -> int:
    """Let the process open as many files as it may. Returns how many that are."""
    if sys.platform == "win32":
        return _MOST_FILES
    import resource  # noqa: PLC0415 - not on Windows

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _MOST_FILES if hard == resource.RLIM_INFINITY else min(hard, _MOST_FILES)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        soft = wanted
    return _MOST_FILES if soft == resource.RLIM_INFINITY else soft


def connection_table(settings: Settings, file_limit: int) -> ConnectionTable:
    """A table that leaves the server the files that it needs for its own work.

    Args:
        settings: may ask for fewer connections, or for more as far as there are files.
        file_limit: how many files the process may have open.
    """
    own = _OWN_FILES + _OWN_FILES_PER_CORE * (os.cpu_count() or 1) + OPERATOR_SLOTS
    # With very few files everything is short of them; connections then have a quarter.
    possible = max(file_limit - own - ACCEPTS_AT_ONCE, file_limit // 4, 1)
    limit = min(settings.max_connections or MOST_CONNECTIONS, possible)
    half = max(1, limit // 2)
    return ConnectionTable(limit, min(settings.max_connections_per_address or half, limit))
