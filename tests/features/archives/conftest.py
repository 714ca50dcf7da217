"""Fixtures of the archive's tests."""

from collections.abc import Iterator

import pytest

from app.storage.database.store import RunStore
from tests.storage.stores import temporary_store


@pytest.fixture
def store() -> Iterator[RunStore]:
    with temporary_store() as opened_store:
        yield opened_store
