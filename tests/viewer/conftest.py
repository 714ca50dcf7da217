"""Fixtures: a real in-process viser server, and robots drawn on it.

Imported when used: where a new viser breaks an import of the app, `test_assumptions` still runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.stage.conftest import parts

if TYPE_CHECKING:
    from hexapods.drawing.viser_internals.server import InProcessViser
    from tests.viewer.serving import Robots

__all__ = ["parts"]


@pytest.fixture
def viser_server() -> Iterator[InProcessViser]:
    from tests.viewer.serving import start_viser

    server = start_viser()
    yield server
    server.stop()


@pytest.fixture
def server() -> Iterator[InProcessViser]:
    """A viser without a scene."""
    from hexapods.drawing.viser_internals.server import in_process_viser

    with in_process_viser() as started:
        yield started


@pytest.fixture
def robots(viser_server: InProcessViser) -> Robots:
    from tests.viewer.serving import Robots

    return Robots(viser_server)
