"""`benchmarks/best_known.py`, which computes the distances that are stored."""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hexapods import __version__
from tests.timeouts import LONG_S

pytestmark = pytest.mark.promises

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "benchmarks" / "best_known.py"
FLAT = ("--gait", "left-right-origin", "--world", "flat", "--by", "beam", "--width", "1")


def search(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the script in a folder, where it writes `known.json`."""
    return subprocess.run(
        [sys.executable, str(SCRIPT), *arguments, "--out", "known.json"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=LONG_S,
        check=False,
    )


def rows_of(folder: Path) -> list[dict[str, Any]]:
    """Return the rows of `known.json`."""
    rows: list[dict[str, Any]] = json.loads((folder / "known.json").read_text("utf-8"))["distances"]
    return rows


def test_a_farther_walk_replaces_a_shorter_one(tmp_path: Path) -> None:
    walk = {"robot": "stiff", "world": "flat", "gait": "left-right-origin"}
    for distance_m in (0.1, 9.0):
        old = {**walk, "found_by": "beam", "width": 1, "version": "0", "distance_m": distance_m}
        (tmp_path / "known.json").write_text(json.dumps({"distances": [old]}))
        done = search(tmp_path, *FLAT)
        assert done.returncode == 0, done.stderr
        [row] = rows_of(tmp_path)
        if distance_m < 1.0:
            assert 0.4 < row["distance_m"] < 0.6
            assert row["version"] == __version__
            assert f"stiff flat left-right-origin beam 1: {row['distance_m']:.3f} m" in done.stdout
            assert search(tmp_path, *FLAT).stdout == "", "it is not computed again"
        else:
            assert row == old


def test_each_search_and_agent_has_a_row_that_says_who_walked(tmp_path: Path) -> None:
    by = ("--by", "bonus-beam,wave,greedy", "--width", "1,2")
    done = search(tmp_path, "--gait", "tripod", "--world", "flat", *by)
    assert done.returncode == 0, done.stderr

    rows = rows_of(tmp_path)
    walkers = [(row["found_by"], row.get("width")) for row in rows]
    assert walkers == [("bonus-beam", 1), ("bonus-beam", 2), ("wave", None), ("greedy", None)]
    assert rows[1]["distance_m"] > rows[2]["distance_m"] > 0.1


def test_walks_of_reports_are_added_but_not_those_of_built_robots(tmp_path: Path) -> None:
    report = tmp_path / "report"
    shutil.copytree(ROOT / "docs" / "reproduction" / "table1", report)
    assert search(tmp_path, "--reports", "report").returncode == 0

    rows = rows_of(tmp_path)
    far_m = {(row["robot"], row["gait"], row["found_by"]): row["distance_m"] for row in rows}
    assert len(far_m) == len(rows) == 2 * 4 * 3  # robots, gaits, agents
    assert far_m["stiff", "left-right-origin", "greedy"] == pytest.approx(0.510744)

    summary = json.loads((report / "summary.json").read_text("utf-8"))
    summary["config"]["tolerance"] = 0.03
    (report / "summary.json").write_text(json.dumps(summary), "utf-8")
    (tmp_path / "known.json").unlink()
    assert search(tmp_path, "--reports", "report").returncode == 0
    assert rows_of(tmp_path) == []


@pytest.mark.parametrize(
    ("arguments", "names"),
    [(("--world", "moon"), "limp-pair"), (("--width", "8,0"), "from 1 to 4,096")],
)
def test_invalid_search_is_refused(arguments: tuple[str, ...], names: str, tmp_path: Path) -> None:
    done = search(tmp_path, *arguments)
    assert done.returncode == 2
    assert names in done.stderr
