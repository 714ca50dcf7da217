"""Dump a database of this version: `.venv/bin/python -m tests.promises.released`.

To be run once for every new schema; a dump that is there is never changed.
"""

import sqlite3
import sys
import tempfile
from contextlib import closing
from pathlib import Path

from app.storage.database.migration import newest_revision
from app.storage.database.opening import DATABASE_FILE
from tests.postgresql import PostgresServer, postgres_server
from tests.promises.released import sample
from tests.storage.stores import BACKENDS, database_url, opened

FOLDER = Path(__file__).parent


def main() -> None:
    with postgres_server() as server:
        for backend in BACKENDS:
            path = FOLDER / f"{newest_revision()}.{backend}.sql"
            if path.exists():
                sys.exit(f"{path.name} is there already; a released schema never changes")
            with tempfile.TemporaryDirectory() as folder:
                path.write_text(dump(backend, server, Path(folder)))


def dump(backend: str, server: PostgresServer, folder: Path) -> str:
    with database_url(backend, server) as url:
        with opened(folder, url) as store:
            sample.put(store)
        if url is None:
            with closing(sqlite3.connect(folder / DATABASE_FILE)) as connection:
                return "\n".join([*connection.iterdump(), ""])
        return server.dump(url)


if __name__ == "__main__":
    main()
