"""A store with runs for the tests of exports."""

from collections.abc import Iterator

import pytest

from app.exports.stored_walks import recorded_walks
from hexapods.exports.recorded_walks import RecordedWalks
from tests.stage.stage_parts import StageParts
from tests.storage.stores import temporary_store

AGENTS = ("greedy", "wave")


@pytest.fixture(scope="package")
def parts() -> Iterator[StageParts]:
    with temporary_store() as store:
        yield StageParts(store)


@pytest.fixture(scope="package")
def raced(parts: StageParts) -> RecordedWalks:
    """Return a race with physics."""
    run = parts.finished_race(AGENTS, steps=6, simulator="mujoco")
    return recorded_walks(parts.store.find(run.id), parts.recordings)
