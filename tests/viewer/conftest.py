"""viser itself: what the hub reads here is what it reads on stage."""

from collections.abc import Iterator

import pytest

from app.viewer.in_process import InProcessViser
from tests.viewer.serving import Robots, start_viser


@pytest.fixture
def stage() -> Iterator[InProcessViser]:
    server = start_viser()
    yield server
    server.stop()


@pytest.fixture
def robots(stage: InProcessViser) -> Robots:
    return Robots(stage)
