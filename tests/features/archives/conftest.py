"""Fixtures of the tests of archives, and of the API's, for those of this feature's routes."""

from collections.abc import Iterator

import pytest

from app.storage.database.store import RunStore
from tests.api.conftest import api, data, made_once, serve, shared, trained
from tests.storage.stores import temporary_store

__all__ = ["api", "data", "made_once", "serve", "shared", "trained"]


@pytest.fixture
def store() -> Iterator[RunStore]:
    with temporary_store() as opened_store:
        yield opened_store
