"""The tier of each test, which says with what command it runs: the one rule for all tests.

`make check` runs the first tier, `make test` the first two, `make promises` the third; `make soak`
runs promises and the last tier, at full length. CONTRIBUTING.md says which tier a new test gets.
"""

import re
from functools import cache
from pathlib import Path

import pytest

from tests.promises.length import IS_WHOLE

TIERS = ("check", "test", "promises", "soak")
TESTS = Path(__file__).parent
COLLECTED = pytest.StashKey[list[pytest.Item]]()
"""Key of all tests that were collected, selected or not."""
_LIBRARY = TESTS.parent / "hexapods"
_SLOW_FOLDERS = {"browser", "docs", "promises"}
"""They open browsers, run programs as long as these say, and start servers and kill them."""
_SLOW_FIXTURES = {"chromium": "promises", "postgresql": "test"}
"""The browser, a database server: what a test that uses them waits for."""
_NOT_LIBRARY_IN_PROCESS = re.compile(
    r"^(?:from|import) (?:app|subprocess|tests\.(?:api|browser|cli|forked|served|stage|storage))\b",
    re.MULTILINE,
)
"""Imports of a test of the dashboard, or of one that starts processes."""


def tier_of(item: pytest.Item) -> str:
    """Return the tier of a test: that of its closest marker, or else that of the rule."""
    marked = [mark.name for mark in item.iter_markers() if mark.name in TIERS]
    if marked:
        return marked[0]
    tiers = [tier_of_file(item.path)]
    tiers += [_SLOW_FIXTURES.get(name, "check") for name in getattr(item, "fixturenames", ())]
    return max(tiers, key=TIERS.index)


@cache
def tier_of_file(path: Path) -> str:
    """Return the tier of the tests of a file that have no marker and no slow fixture."""
    folders = path.relative_to(TESTS).parts[:-1]
    if _SLOW_FOLDERS & set(folders):
        return "promises"
    # Tests mirror the tree; those of no folder tell by their imports.
    is_of_library = not folders or (_LIBRARY / folders[0]).exists()
    if is_of_library and not _NOT_LIBRARY_IN_PROCESS.search(path.read_text("utf-8")):
        return "check"
    return "test"


def mark(item: pytest.Item) -> None:
    """Give a test the marker of its tier; what is shown at full length alone is skipped else."""
    tier = tier_of(item)
    item.add_marker(tier)
    if tier == "soak" and not IS_WHOLE:
        item.add_marker(pytest.mark.skip(reason="in full by make soak"))


def add_option(parser: pytest.Parser) -> None:
    """Declare `--tier`, which may be repeated."""
    parser.addoption(
        "--tier", action="append", choices=TIERS, help="run only the tests of this tier"
    )


def is_left_out(path: Path, config: pytest.Config) -> bool:
    """Whether no test of a file is selected: with the first tier alone others are not imported."""
    is_test = path.name.startswith("test_") and path.suffix == ".py"
    return is_test and config.getoption("tier") == ["check"] and tier_of_file(path) != "check"


def select(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave the tests of the tiers that are asked for, or all."""
    tiers = config.getoption("tier")
    if tiers is None:
        return
    selected = [item for item in items if tier_of(item) in tiers]
    if len(selected) < len(items):
        config.hook.pytest_deselected(items=[item for item in items if tier_of(item) not in tiers])
    items[:] = selected
