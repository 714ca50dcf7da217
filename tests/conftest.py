"""Fixtures for every test: a real browser with WebGL2 in software, and a real PostgreSQL.

`make test` runs the tests in several processes (pytest-xdist).
"""

from collections.abc import Iterator

import hypothesis
import pytest
from playwright.sync_api import Browser, Page, sync_playwright
from xdist.remote import Producer

from tests.in_parallel import FileByFile
from tests.install_browser import HOW_TO_GET_ONE, find_browser
from tests.postgresql import PostgresServer, postgres_server

# One commit gives one verdict, and a busy machine is no failure.
hypothesis.settings.register_profile("gate", derandomize=True, deadline=None)
hypothesis.settings.load_profile("gate")

# `--use-gl=swiftshader` is left out on purpose: with it there is no WebGL at all.
_CHROMIUM_OPTIONS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put browser tests last, the longest files of them first.

    Playwright's synchronous interface keeps an event loop running in the main thread for as long
    as it is open, and in that time no other test can `asyncio.run` there. A long file at the very
    end would leave the other processes without work.
    """

    def place(item: pytest.Item) -> tuple[bool, int]:
        is_last = "browser" in getattr(item, "fixturenames", ())
        return is_last, -item.path.stat().st_size if is_last else 0

    items.sort(key=place)


def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> FileByFile:
    """Keep the tests of a file in one process, and their order."""
    return FileByFile(config, log)


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Chromium with a fresh profile. Having none is a failure: these tests are never skipped."""
    path = find_browser()
    if path is None:
        pytest.fail(HOW_TO_GET_ONE, pytrace=False)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=path, headless=True, args=_CHROMIUM_OPTIONS
        )
        yield chromium
        chromium.close()


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """An empty tab with cookies and storage of its own.

    It has half as many pixels as it says: WebGL in software takes most of the time of these tests.
    """
    with browser.new_context(device_scale_factor=0.5) as context:
        yield context.new_page()


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresServer]:
    """A PostgreSQL server. Having none is a failure: these tests are never skipped."""
    with postgres_server() as server:
        yield server
