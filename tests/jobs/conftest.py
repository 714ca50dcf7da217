"""Fixtures of the jobs' tests: a store in memory, and jobs that run one process at a time."""

from collections.abc import Iterator

import pytest

from app.events.bus import EventBus
from app.jobs.jobs import Jobs
from app.storage.memory_store import MemoryStore
from app.storage.recordings import Recordings


@pytest.fixture
def store() -> MemoryStore:
    return MemoryStore()


@pytest.fixture
def jobs(store: MemoryStore) -> Iterator[Jobs]:
    jobs = Jobs(store, Recordings(), EventBus(), cores=1)
    jobs.open()
    yield jobs
    jobs.close()
