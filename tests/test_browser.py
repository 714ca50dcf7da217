"""The browser that the other tests stand on."""

import asyncio
from pathlib import Path

import pytest
from playwright.sync_api import Page

from tests import install_browser


def test_a_page_opens_and_has_webgl2(page: Page) -> None:
    page.goto("data:text/html,<title>Hexapods</title><canvas></canvas>")

    assert page.title() == "Hexapods"
    assert page.evaluate("document.querySelector('canvas').getContext('webgl2') !== null")


def test_tests_without_a_browser_run_before_it_opens() -> None:
    asyncio.run(asyncio.sleep(0))


def test_a_browser_that_is_asked_for_is_not_replaced(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(install_browser.ENVIRONMENT_NAME, str(tmp_path / "absent"))

    assert install_browser.find_browser() is None
    assert install_browser.main() == 1
    assert install_browser.ENVIRONMENT_NAME in capsys.readouterr().err


def test_a_playwright_that_does_not_start_is_said_clearly(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(install_browser, "_PLAYWRIGHT_VERSION", ["false"])
    monkeypatch.setattr(install_browser, "_install_debian_packages", lambda: None)

    assert install_browser.main() == 1
    assert "libatomic1" in capfd.readouterr().err


def test_no_browser_to_be_had_is_said_clearly(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv(install_browser.ENVIRONMENT_NAME, raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(install_browser, "_playwrights_own", lambda: None)
    monkeypatch.setattr(install_browser, "_install_playwrights_own", lambda: None)

    assert install_browser.main() == 1
    assert "apt-get install chromium-headless-shell" in capfd.readouterr().err
