"""Every test has one tier, and every tier has its command."""

import os
import re
import subprocess
from pathlib import Path

import pytest

from tests.tiers import COLLECTED, TESTS, TIERS, tier_of_file

# In the first tier other files than its own are not collected.
pytestmark = pytest.mark.test

ROOT = TESTS.parent
_OWN_LENGTH = re.compile(r"^from tests\.(?:promises\.length|figures) import", re.MULTILINE)


@pytest.fixture(scope="module")
def collected(request: pytest.FixtureRequest) -> list[pytest.Item]:
    """All tests that pytest has collected, of all tiers."""
    return request.config.stash[COLLECTED]


def commands_of(target: str) -> list[list[str]]:
    """Return the command lines of pytest that `make` would run."""
    environment = {name: value for name, value in os.environ.items() if "MAKE" not in name}
    done = subprocess.run(
        ["make", "--dry-run", target],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    lines = done.stdout.replace("\\\n", " ").splitlines()
    return [line.split() for line in lines if "-m pytest" in line]


def tiers_of(target: str) -> list[str]:
    """Return the tiers that a target selects, which is all that it says about tests."""
    [command] = commands_of(target)
    at = command.index("pytest")
    assert [word for word in command[at + 1 :] if word.startswith("tests")] == []
    return [word.removeprefix("--tier=") for word in command if word.startswith("--tier=")]


def test_each_test_has_exactly_one_tier(collected: list[pytest.Item]) -> None:
    for item in collected:
        # A marker of a test is before that of its module.
        marked = {mark.name for mark in item.own_markers} & set(TIERS)
        assert len(marked) == 1, f"{item.nodeid} has the tiers {sorted(marked)}"


def test_make_check_imports_all_files_that_have_its_tests(collected: list[pytest.Item]) -> None:
    """It imports no others, so a test elsewhere that is marked `check` would not run."""
    for item in collected:
        if item.get_closest_marker("check"):
            assert tier_of_file(item.path) == "check", item.nodeid


def test_the_commands_select_all_tiers() -> None:
    assert tiers_of("check") == ["check"]
    assert tiers_of("test") == ["check", "test"]
    assert tiers_of("promises") == ["promises"]
    run = (ROOT / ".ci" / "run").read_text()
    assert "make test && make promises" in run


def test_make_soak_runs_what_has_no_short_form_and_all_that_has_two_lengths(
    collected: list[pytest.Item],
) -> None:
    [command] = commands_of("soak")
    paths = [ROOT / word for word in command if word.startswith("tests/")]

    def runs(file: Path) -> bool:
        return any(file == path or path in file.parents for path in paths)

    files = {item.path for item in collected if item.get_closest_marker("soak")}
    files |= {file for file in TESTS.rglob("test_*.py") if _OWN_LENGTH.search(file.read_text())}
    assert [str(file) for file in sorted(files) if not runs(file)] == []
