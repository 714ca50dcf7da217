"""Fixtures: a real in-process viser server, and robots drawn on it."""

from collections.abc import Iterator

import pytest

from app.viewer.in_process import InProcessViser
from tests.stage.conftest import parts
from tests.viewer.serving import Robots, start_viser

__all__ = ["parts"]


@pytest.fixture
def viser_server() -> Iterator[InProcessViser]:
    server = start_viser()
    yield server
    server.stop()


@pytest.fixture
def robots(viser_server: InProcessViser) -> Robots:
    return Robots(viser_server)
