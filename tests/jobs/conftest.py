"""Fixtures of the jobs' tests: a store, and jobs that run one process at a time."""

from collections.abc import Iterator

import pytest

from app.events.bus import EventBus
from app.jobs.jobs import Jobs
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from tests.storage.stores import temporary_store


@pytest.fixture
def store() -> Iterator[RunStore]:
    with temporary_store() as opened_store:
        yield opened_store


@pytest.fixture
def jobs(store: RunStore) -> Iterator[Jobs]:
    jobs = Jobs(store, Recordings(store), EventBus(), cores=1)
    jobs.open()
    yield jobs
    jobs.close()
