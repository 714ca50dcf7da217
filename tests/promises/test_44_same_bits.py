"""Promise 44: the same seed gives the same bits.

In every Python that is on a machine: `make pythons`, which `make promises` runs, runs
tests/test_reproducible.py in each, and tests/domain/test_sums.py refuses what differs between them.
With other instructions of the processor it is said from which step on results differ, and whether
the ranks hold: here NumPy is denied all that newer processors have, in a process of its own.
"""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hexapods.tournaments.tournament_file import TournamentFile, write_file
from tests.digests import COMMON_INSTRUCTIONS, ROOT
from tests.promises.length import at_length
from tests.quick_robot import HASTY
from tests.tournaments.sample_tournaments import judged, rules_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `t.json`, a tournament in MuJoCo that was judged with all instructions."""
    place = tmp_path_factory.mktemp("tournament")
    (place / "t.json").write_bytes(write_file(_tournament()))
    return place


def _tournament() -> TournamentFile:
    options: dict[str, Any] = at_length({"robot": HASTY, "steps": 10}, {"steps": 500})
    return judged(rules_of(simulator="mujoco", gait="tripod", **options), [])


def _verify(file: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Verify in a process that has not yet loaded NumPy, which chooses its instructions then."""
    return subprocess.run(
        [sys.executable, "-m", "app.cli", "verify", str(file), *options],
        cwd=ROOT,
        env={**os.environ, **COMMON_INSTRUCTIONS},
        capture_output=True,
        text=True,
        check=False,
    )


def test_with_other_instructions_it_is_said_from_which_step_on_and_that_ranks_hold(
    folder: Path,
) -> None:
    done = _verify(folder / "t.json")
    assert done.returncode == 0, done.stdout + done.stderr
    lines = done.stdout.splitlines()[-3:]
    assert lines[0].startswith("Distances differ in their last digits alone, by at most ")
    assert "e-1" in lines[0]
    assert "all ranks hold; the random walk on draw 1 differs from its step " in lines[0]
    assert lines[1].startswith("This is processor ")
    assert lines[2] == f"{folder / 't.json'} repeats but for the last digits of distances."


def test_a_changed_file_is_reported_with_other_instructions_too(folder: Path) -> None:
    tournament = _tournament()
    entry = tournament.entries[0]
    better = (replace(entry.judgements[0], distance_m=9.0), *entry.judgements[1:])
    entries = (replace(entry, judgements=better), *tournament.entries[1:])
    (folder / "changed.json").write_bytes(write_file(replace(tournament, entries=entries)))
    done = _verify(folder / "changed.json", "--json")
    assert done.returncode == 1
    shown = json.loads(done.stdout)
    assert (shown["repeats"], shown["rounding"]) == (False, None)
    assert any("9.0 m in the file" in difference for difference in shown["differences"])


def _add_tools(folder: Path) -> None:
    """Add to a folder, which is all of a PATH, what `.ci/find-python` needs."""
    for tool in ("sh", "ls", "sed", "sort"):
        path = shutil.which(tool)
        assert path is not None
        (folder / tool).symlink_to(path)


def test_a_machine_with_one_python_says_that_nothing_was_compared(tmp_path: Path) -> None:
    (tmp_path / f"python3.{sys.version_info[1]}").symlink_to(sys.executable)
    _add_tools(tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "tests.other_pythons"],
        cwd=ROOT,
        env={"PATH": str(tmp_path), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("alone is here: its results were compared with no other's\n")


@pytest.mark.parametrize("minor", [13, 14, 23])
def test_newer_pythons_are_found(minor: int, tmp_path: Path) -> None:
    says_its_version = f'[ "$1" != --version ] || echo "Python 3.{minor}.0"'
    (tmp_path / f"python3.{minor}").write_text(f"#!/bin/sh\n{says_its_version}\n")
    (tmp_path / f"python3.{minor}").chmod(0o755)
    _add_tools(tmp_path)
    done = subprocess.run(
        ["/bin/sh", str(ROOT / ".ci" / "find-python")],
        env={"PATH": str(tmp_path), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.strip() == f"python3.{minor}", done.stderr
