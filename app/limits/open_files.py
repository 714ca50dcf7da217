"""Raise the limit of file descriptors, and divide them between connections and other uses."""

import os
import sys

from app.limits.connections import OPERATOR_SLOTS, ConnectionTable
from app.limits.listener import ACCEPTS_AT_ONCE
from app.settings import Settings

MAX_CONNECTIONS = 2000
"""Default maximum of connections, which bounds their memory; the settings can raise it."""
_MAX_FILES = 65_536
_OWN_FILES, _OWN_FILES_PER_CORE = 224, 8
"""Reserved for the database, threads that read artifacts, viser, and pipes of job processes."""


def raise_file_limit() -> int:
    """Raise the soft limit of open files (RLIMIT_NOFILE) to the hard one; return the new limit."""
    if sys.platform == "win32":
        return _MAX_FILES
    import resource  # noqa: PLC0415 - not on Windows

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _MAX_FILES if hard == resource.RLIM_INFINITY else min(hard, _MAX_FILES)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        soft = wanted
    return _MAX_FILES if soft == resource.RLIM_INFINITY else soft


def connection_table(settings: Settings, file_limit: int) -> ConnectionTable:
    """Create a connection table whose limit leaves the server the files that it needs itself.

    Args:
        settings: with the wanted limits, which the number of files may lower.
        file_limit: maximum of files that the process may open.
    """
    reserved = _OWN_FILES + _OWN_FILES_PER_CORE * (os.cpu_count() or 1) + OPERATOR_SLOTS
    # With a very low file limit the reserve cannot be met; connections then get a quarter.
    possible = max(file_limit - reserved - ACCEPTS_AT_ONCE, file_limit // 4, 1)
    limit = min(settings.max_connections or MAX_CONNECTIONS, possible)
    half = max(1, limit // 2)
    return ConnectionTable(limit, min(settings.max_connections_per_address or half, limit))
