"""Fixtures: servers and pages, shared with the API's and the browser's tests."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.api.conftest import api, data, serve, trained
from tests.browser.conftest import dashboard, page, server
from tests.browser.serving import Serving, serving
from tests.served import Served, serving_from

__all__ = ["api", "dashboard", "data", "page", "serve", "server", "trained"]


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[Callable[..., Served]]:
    """A function that starts `hexapods serve` on this test's data folder; may be called again."""
    with serving_from(tmp_path) as make:
        yield make


@pytest.fixture(scope="session")
def quiet_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """A shared server, for tests that start no runs on it."""
    with serving(tmp_path_factory.mktemp("data")) as shared:
        yield shared
