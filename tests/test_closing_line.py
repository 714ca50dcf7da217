"""The last line of `.ci/run` is the sum of what pytest said, in its own form."""

import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.closing_line import closing_line, main, read

PASSES = "def test_passes():\n    pass\n"
OTHERS = """
import pytest

@pytest.mark.parametrize("number", range(3))
def test_passes(number): pass

def test_fails(): assert 1 + 1 == 3

def test_is_skipped(): pytest.skip("not here")

@pytest.fixture
def broken(): raise OSError

def test_has_no_fixture(broken): pass
"""


def run(folder: Path, name: str, tests: str) -> tuple[str, str]:
    """Run pytest on these tests alone; return its JUnit file and its closing line."""
    file, report = folder / f"test_{name}.py", folder / f"{name}.xml"
    file.write_text(tests)
    options = ["-p", "no:cacheprovider", "-c", "/dev/null", f"--junitxml={report}"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, str(file)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return str(report), done.stdout.splitlines()[-1]


def test_it_is_what_pytest_says_and_sums_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    failing, said = run(tmp_path, "others", OTHERS)
    passing, _ = run(tmp_path, "passing", PASSES)

    outcomes, _ = read(Path(failing))
    assert closing_line(outcomes, 0).split(" in ")[0].strip("= ") == said.split(" in ")[0].strip(
        "= "
    )
    assert main([passing]) == 0
    assert main([passing, failing]) == 1
    last = capsys.readouterr().out.splitlines()[-1]
    assert "= 1 failed, 4 passed, 1 skipped, 1 error in " in last


def test_hours_are_written_as_pytest_writes_them() -> None:
    line = closing_line(Counter(passed=6363), 3723.456)
    assert line.strip("=") == " 6363 passed in 3723.46s (1:02:03) "


def test_tests_that_did_not_run_are_a_failure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = str(tmp_path / "none.xml")
    assert main([missing]) == 1
    said, last = capsys.readouterr().out.splitlines()
    assert missing in said
    assert "= no tests ran in 0.00s =" in last
