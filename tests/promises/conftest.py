"""The promises are held against the same servers and pages as everything else."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.api.conftest import api, data, serve, trained
from tests.browser.conftest import dashboard, server
from tests.browser.serving import Serving, serving
from tests.served import Served, serving_from

__all__ = ["api", "dashboard", "data", "serve", "server", "trained"]


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[Callable[..., Served]]:
    """Starts `hexapods serve` on this test's data folder, again and again if need be."""
    with serving_from(tmp_path) as make:
        yield make


@pytest.fixture(scope="session")
def quiet_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """For the tests that start nothing on it."""
    with serving(tmp_path_factory.mktemp("data")) as shared:
        yield shared
