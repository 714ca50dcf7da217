"""A store on each database."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.storage.database.store import RunStore
from tests.storage.stores import BACKENDS, copy_new_database, database_url, opened


@pytest.fixture(params=BACKENDS)
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[RunStore]:
    """An empty store, with its files in `tmp_path`."""
    is_sqlite = request.param == "sqlite"
    if is_sqlite:
        copy_new_database(tmp_path)
    server = None if is_sqlite else request.getfixturevalue("postgresql")
    with database_url(request.param, server) as url, opened(tmp_path, url) as opened_store:
        yield opened_store
