"""Fixtures: a store and jobs of a demo, its visitors, and its clock."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from app.events.bus import EventBus
from app.features.demo.allowance import Allowance
from app.features.demo.visitors import Visitors
from app.jobs.jobs import Jobs
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from tests.api.conftest import api, data, made_once, serve, shared, trained
from tests.features.demo.clock import Clock
from tests.storage.stores import opened

__all__ = ["SMALL", "api", "data", "made_once", "serve", "shared", "trained"]
SMALL = Allowance(
    steps_per_hour=100, steps_per_start=60, least_steps=10, kept=4, visitors_per_address=3
)
"""An allowance that a few short runs use up."""


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    with opened(tmp_path, None) as opened_store:
        yield opened_store


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def make_visitors(store: RunStore, clock: Clock) -> Callable[[], Visitors]:
    """Returns the visitors as a server that starts finds them."""
    return lambda: Visitors(store, SMALL, now=clock.time)


@pytest.fixture
def visitors(make_visitors: Callable[[], Visitors]) -> Visitors:
    return make_visitors()


@pytest.fixture
def jobs(store: RunStore, visitors: Visitors) -> Iterator[Jobs]:
    jobs = Jobs(store, Recordings(store), EventBus(), cores=1, owner_of=visitors.owner_of)
    jobs.open()
    yield jobs
    jobs.close()
