"""Find a browser for the tests, or install one: `.venv/bin/python tests/install_browser.py`.

Debian's Chromium where apt-get may install it, else Playwright's own. Its headless shell comes
first: the same engine without the windows of a desktop, which Chromium draws unseen as pages of
their own, in two fifths of the browser tests' time. A browser counts only if it starts, because
Ubuntu's `chromium` may be a stub that asks for snap, and Playwright's own may lack system
libraries. Videos, which are drawn off screen, need OpenGL by EGL too.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from ctypes.util import find_library
from pathlib import Path

ENVIRONMENT_NAME = "HEXAPODS_TEST_BROWSER"

HOW_TO_GET_ONE = (
    "The browser tests need Chromium, and none was found. Install it (on Debian: "
    "apt-get install chromium-headless-shell), or run '.venv/bin/python -m playwright install "
    f"chromium', or set {ENVIRONMENT_NAME} to the path of one."
)

WHAT_PLAYWRIGHT_NEEDS = (
    "Playwright, which drives the browser of the tests, does not start; it says why above. "
    "On Debian: apt-get install libatomic1."
)

# Names of packages and of their commands.
_HEADLESS_SHELL, _CHROMIUM = "chromium-headless-shell", "chromium"
# Playwright's driver needs libatomic, which a slim Debian has not; videos are drawn with EGL.
_LIBRARIES = ["libatomic1", "libegl1", "libgl1-mesa-dri"]

_PLAYWRIGHT_VERSION = [sys.executable, "-m", "playwright", "--version"]

_ASK_PLAYWRIGHT = """
from playwright.sync_api import sync_playwright
with sync_playwright() as playwright:
    print(playwright.chromium.executable_path)
"""


def find_browser() -> Path | None:
    """The browser that the tests use: the one that is asked for, Debian's, or Playwright's own."""
    asked_for = os.environ.get(ENVIRONMENT_NAME)
    if asked_for:
        # No fallback: who names a browser wants the tests to run in that one.
        return Path(asked_for) if _starts(asked_for) else None
    for candidate in (shutil.which(_HEADLESS_SHELL), shutil.which(_CHROMIUM)):
        if candidate and _starts(candidate):
            return Path(candidate)
    playwrights_own = _playwrights_own()
    return Path(playwrights_own) if playwrights_own and _starts(playwrights_own) else None


def main() -> int:
    """Print the path of a browser that starts, after installing one where there is none."""
    browser = find_browser()
    is_asked_for = bool(os.environ.get(ENVIRONMENT_NAME))
    if browser is None and is_asked_for:
        return _give_up(f"{ENVIRONMENT_NAME} names no browser that starts.")
    is_missing = browser is None or (browser.name == _CHROMIUM and not is_asked_for)
    if is_missing or not _succeeds(_PLAYWRIGHT_VERSION) or find_library("EGL") is None:
        _install_debian_packages()
        browser = find_browser()
    if not _succeeds(_PLAYWRIGHT_VERSION):
        _run(_PLAYWRIGHT_VERSION)
        return _give_up(WHAT_PLAYWRIGHT_NEEDS)
    if browser is None:
        _install_playwrights_own()
        browser = find_browser()
    if browser is None:
        return _give_up(HOW_TO_GET_ONE)
    print(f"Browser for the tests: {browser}")
    return 0


def _give_up(why: str) -> int:
    print(why, file=sys.stderr)
    return 1


def _install_debian_packages() -> None:
    print(f"Tests of the page and of videos need {_HEADLESS_SHELL} and {' and '.join(_LIBRARIES)}.")
    as_root = _as_root()
    if shutil.which("apt-get") is None or as_root is None:
        print("apt-get cannot install them: it is not here, or needs root or passwordless sudo.")
        return
    # The lists may be missing or old. If updating fails, the install says what is wrong.
    _run([*as_root, "apt-get", "update", "--quiet"])
    install = ["install", "--yes", "--quiet", "--no-install-recommends"]
    wait_for_others = ["--option", "DPkg::Lock::Timeout=300"]
    ask_nothing = ["env", "DEBIAN_FRONTEND=noninteractive"]
    # One after the other: Debian's relatives lack the first, which must not keep the rest out.
    for packages in ([_HEADLESS_SHELL], _LIBRARIES):
        _run([*as_root, *ask_nothing, "apt-get", *wait_for_others, *install, *packages])


def _install_playwrights_own() -> None:
    print("Still no browser: installing Playwright's own Chromium.")
    _run([sys.executable, "-m", "playwright", "install", "--no-shell", "chromium"])


def _as_root() -> list[str] | None:
    """Return the prefix of commands that need root; None where there is no root."""
    if os.geteuid() == 0:
        return []
    if shutil.which("sudo") and _succeeds(["sudo", "--non-interactive", "true"]):
        return ["sudo", "--non-interactive"]
    return None


def _playwrights_own() -> str | None:
    completed = subprocess.run(
        [sys.executable, "-c", _ASK_PLAYWRIGHT], capture_output=True, text=True, check=False
    )
    return completed.stdout.strip() or None


def _starts(browser: str) -> bool:
    return _succeeds([browser, "--version"])


def _succeeds(command: Sequence[str]) -> bool:
    try:
        done = subprocess.run(command, capture_output=True, timeout=60, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def _run(command: Sequence[str]) -> None:
    """Run a command in view. Its failure shows in the end, by there being no browser."""
    print("$", " ".join(command), flush=True)
    subprocess.run(command, check=False)


if __name__ == "__main__":
    sys.exit(main())
