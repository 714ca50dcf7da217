"""Fixtures for every test: a real browser with WebGL2 in software, and a real PostgreSQL.

`make test` and `make promises` run the tests in several processes (pytest-xdist).
"""

import gc
import threading
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import hypothesis
import pytest
from playwright.sync_api import Browser, BrowserType, Page, sync_playwright
from xdist.remote import Producer

from tests import tiers
from tests.forked import start_fork_server
from tests.in_parallel import FileByFile
from tests.install_browser import HOW_TO_GET_ONE, find_browser
from tests.postgresql import PostgresServer, postgres_server

# Until all tests are collected: nothing is thrown away before, and to look for it takes a seventh
# of that time.
gc.disable()

# One commit gives one verdict, and a busy machine is no failure.
hypothesis.settings.register_profile("gate", derandomize=True, deadline=None)
hypothesis.settings.load_profile("gate")

_CHROMIUM_OPTIONS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
# Mesa's software renderer takes half the time of Chromium's own, SwiftShader. What is no 3D view is
# drawn as without WebGL: by that renderer it takes longer than the 3D view itself.
_WITH_WEBGL = [
    "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
    "--disable-gpu-compositing",
    "--webgl-antialiasing-mode=none",
]
_FEW_PICTURES = """if (window !== top) {
    const atNextPicture = requestAnimationFrame;
    window.requestAnimationFrame = (draw) => setTimeout(() => atNextPicture(draw), 230);
    window.cancelAnimationFrame = clearTimeout;
}"""
_WITHOUT_WEBGL = ["--disable-gpu", "--disable-software-rasterizer"]
"""A page without a 3D view is drawn with a sixth less work of the processor."""
_OF_APPS = ("stage", "ownership", "pool worker")
"""Beginnings of the names of threads that end when an app and its store are closed."""
_WITHOUT_EVENT_LOOPS = ("agents", "domain", "runs")
"""Folders whose tests start none in the main thread."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare `--tier`."""
    tiers.add_option(parser)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Import no file of which no test is selected."""
    return True if tiers.is_left_out(collection_path, config) else None


def pytest_itemcollected(item: pytest.Item) -> None:
    """Give each test the marker of its tier."""
    tiers.mark(item)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Select the tests of the tiers that are asked for, and order their files.

    The order is such that the processes that run them have work until the end.

    Promises wait a lot, for servers and time-outs: they are spread among the others. Then come
    browser tests. Playwright's synchronous interface keeps an event loop running in the main thread
    for as long as it is open, and in that time no other test can `asyncio.run` there: what follows
    are tests that need no event loop. Of both kinds the longest files are first, since a long one
    at the very end would leave the other processes without work.
    """
    config.stash[tiers.COLLECTED] = list(items)
    tiers.select(config, items)
    files = list(dict.fromkeys(item.path for item in items))
    promises = [file for file in files if "promises" in file.parts]
    other_files = [file for file in files if "promises" not in file.parts]
    turns = {
        file: number / len(group)
        for group in (promises, other_files)
        for number, file in enumerate(group)
    }

    def place(item: pytest.Item) -> tuple[int, float, str]:
        size = item.path.stat().st_size
        if "chromium" in getattr(item, "fixturenames", ()):
            return 1, -size, str(item.path)
        if item.path.parent.name in _WITHOUT_EVENT_LOOPS:
            return 2, -size, str(item.path)
        return 0, turns[item.path], str(item.path)

    items.sort(key=place)


def pytest_collection_finish() -> None:
    """Take imported modules out of garbage collection, which would scan them again and again.

    The processes of servers and jobs are forked from one that has imported what they need.
    """
    gc.collect()
    gc.freeze()
    gc.enable()
    start_fork_server()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(
    item: pytest.Item, nextitem: pytest.Item | None
) -> Generator[None, None, None]:
    """Fail the last test of a folder after which an app is still open in this process.

    Its stages would go on drawing beside all the tests that follow. A folder below it may use the
    same app.
    """
    yield
    if nextitem is None or not nextitem.path.is_relative_to(item.path.parent):
        threads = threading.enumerate()
        left = [thread.name for thread in threads if thread.name.startswith(_OF_APPS)]
        assert left == [], "a test in this folder has left an app open"


def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> FileByFile:
    """Keep the tests of a file in one process, and their order."""
    return FileByFile(config, log)


@pytest.fixture(scope="session")
def chromium() -> Iterator[BrowserType]:
    """Playwright's driver of Chromium."""
    with sync_playwright() as playwright:
        yield playwright.chromium


@pytest.fixture(scope="session")
def browser(chromium: BrowserType) -> Iterator[Browser]:
    """Chromium with a fresh profile. Having none is a failure: these tests are never skipped."""
    with _launched(chromium, _CHROMIUM_OPTIONS + _WITH_WEBGL) as launched:
        yield launched


@pytest.fixture(scope="session")
def flat_browser(chromium: BrowserType) -> Iterator[Browser]:
    """Chromium that cannot draw in 3D."""
    with _launched(chromium, _CHROMIUM_OPTIONS + _WITHOUT_WEBGL) as launched:
        yield launched


def _launched(chromium: BrowserType, options: list[str]) -> Browser:
    path = find_browser()
    if path is None:
        pytest.fail(HOW_TO_GET_ONE, pytrace=False)
    return chromium.launch(executable_path=path, headless=True, args=options)


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """An empty tab with cookies and storage of its own."""
    with new_page(browser) as page:
        yield page


@contextmanager
def new_page(browser: Browser, **options: Any) -> Iterator[Page]:
    """Yield an empty tab with cookies and storage of its own, and close it.

    It has half as many pixels as it says, and the 3D view in the dashboard draws four pictures a
    second: WebGL in software takes most of the time of these tests.

    Args:
        browser: with WebGL or without.
        options: of `Browser.new_context`.
    """
    with browser.new_context(device_scale_factor=0.5, **options) as context:
        context.add_init_script(_FEW_PICTURES)
        yield context.new_page()


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgresServer]:
    """A PostgreSQL server. Having none is a failure: these tests are never skipped."""
    with postgres_server() as server:
        yield server
