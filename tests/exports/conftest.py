"""A store with runs for the tests of exports."""

from collections.abc import Iterator

import pytest

from app.storage.run import Run
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
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
    return recorded_walks(parts, run)


def recorded_walks(parts: StageParts, run: Run) -> RecordedWalks:
    """Return what is recorded of a race or training."""
    if isinstance(run.config, RaceConfig):
        return RecordedWalks.of_race(run.config, parts.recordings.race(run.id) or ())
    assert isinstance(run.config, TrainingConfig)
    practice = parts.recordings.training(run.id)
    assert practice is not None
    return RecordedWalks.of_training(run.config, practice)
