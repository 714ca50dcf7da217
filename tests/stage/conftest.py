"""Fixtures: a stage with a clock of its own."""

from collections.abc import Iterator

import pytest

from tests.stage.stage_parts import StageParts
from tests.storage.stores import temporary_store


@pytest.fixture
def parts() -> Iterator[StageParts]:
    with temporary_store() as store:
        yield StageParts(store)
