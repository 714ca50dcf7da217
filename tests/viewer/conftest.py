"""viser itself: what the hub reads here is what it reads on stage."""

from collections.abc import Iterator

import pytest
import viser

from tests.viewer.serving import Robots, start_viser


@pytest.fixture
def stage() -> Iterator[viser.ViserServer]:
    server = start_viser()
    yield server
    server.stop()


@pytest.fixture
def robots(stage: viser.ViserServer) -> Robots:
    return Robots(stage)
