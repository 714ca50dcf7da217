"""Fixtures of the archive's tests."""

from collections.abc import Iterator

import pytest

from app.storage.database.store import SqlStore
from tests.storage.stores import temporary_store


@pytest.fixture
def store() -> Iterator[SqlStore]:
    with temporary_store() as opened_store:
        yield opened_store
