"""A server for the tests that do not mind each other's runs, and pages that must not complain."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import BrowserType, Page

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving, serving
from tests.conftest import new_page


@pytest.fixture(scope="session")
def shared_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """Whatever the tests before left on stage is still there."""
    with serving(tmp_path_factory.mktemp("data")) as server:
        yield server


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Serving]:
    """A server that nobody has used."""
    with serving(tmp_path) as fresh:
        yield fresh


@pytest.fixture
def page(chromium: BrowserType, request: pytest.FixtureRequest) -> Iterator[Page]:
    """An empty tab, of a browser that can draw in 3D only in tests marked `looks_at_3d`."""
    name = "browser" if _looks_at_3d(request) else "flat_browser"
    with new_page(request.getfixturevalue(name)) as page:
        yield page


@pytest.fixture
def dashboard(page: Page, request: pytest.FixtureRequest) -> Iterator[Dashboard]:
    """A page that fails its test if it complained: on the console, or about an answer.

    Its 3D view loads only in tests marked `looks_at_3d`.
    """
    watched = Dashboard(page, has_3d=_looks_at_3d(request))
    yield watched
    assert watched.complaints == []


def _looks_at_3d(request: pytest.FixtureRequest) -> bool:
    return request.node.get_closest_marker("looks_at_3d") is not None
