"""Fixtures: a viser server without a port, and a stage with a clock of its own.

Imported when used: where a new viser breaks an import of the app, `test_assumptions` still runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.stage.conftest import parts

if TYPE_CHECKING:
    from hexapods.drawing.viser_internals.server import RecordedViser

__all__ = ["parts"]


@pytest.fixture
def server() -> Iterator[RecordedViser]:
    """A viser without a scene."""
    from hexapods.drawing.viser_internals.server import recorded_viser

    with recorded_viser() as started:
        yield started
