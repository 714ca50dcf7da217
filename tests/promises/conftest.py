"""The promises are held against the same servers and pages as everything else."""

import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.api.conftest import api, data, serve, trained
from tests.browser.conftest import dashboard, server
from tests.browser.serving import Serving, serving
from tests.served import Served

__all__ = ["api", "dashboard", "data", "serve", "server", "trained"]


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[Callable[..., Served]]:
    """Starts `hexapods serve` on this test's data folder, again and again if need be."""
    served: list[Served] = []

    def make(**variables: str) -> Served:
        served.append(Served(tmp_path, **variables))
        return served[-1]

    yield make
    for one in served:
        one.end(signal.SIGKILL)


@pytest.fixture(scope="session")
def quiet_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """For the tests that start nothing on it."""
    with serving(tmp_path_factory.mktemp("data")) as shared:
        yield shared
