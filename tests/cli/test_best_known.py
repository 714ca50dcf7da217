"""`hexapods best-known`, as a user runs it."""

import json
import shutil
from pathlib import Path

import pytest

from hexapods import __version__
from tests.cli.running import ROOT, in_process, refusal

pytestmark = pytest.mark.promises

BEAM = ("--by", "beam", "--width", "1")


def test_distances_are_kept_and_not_computed_again(tmp_path: Path) -> None:
    command = ("best-known", "--gait", "left-right-origin", *BEAM, "--threads", "1")
    printed = []
    for worlds in ("flat", "flat,limp-pair"):
        done = in_process(*command, "--world", worlds, "--out", "known.json", folder=tmp_path)
        assert done.returncode == 0, done.stderr
        printed.append(done.stdout)

    rows = json.loads((tmp_path / "known.json").read_text("utf-8"))["distances"]
    assert [row["world"] for row in rows] == ["flat", "limp-pair"]
    for row, text in zip(rows, printed, strict=True):
        line = f"stiff {row['world']} left-right-origin beam 1: {row['distance_m']:.3f} m"
        assert line in text
    assert "flat" not in printed[1]


def test_farther_walk_replaces_a_shorter_one(tmp_path: Path) -> None:
    command = ("best-known", "--gait", "left-right-origin", "--world", "flat", *BEAM)
    found = []
    for distance_m in (0.1, 9.0):
        walk = {"robot": "stiff", "world": "flat", "gait": "left-right-origin"}
        row = {**walk, "found_by": "beam", "width": 1}
        old = {**row, "version": "0", "distance_m": distance_m}
        (tmp_path / "known.json").write_text(json.dumps({"distances": [old]}))
        assert in_process(*command, "--out", "known.json", folder=tmp_path).returncode == 0
        found.append(json.loads((tmp_path / "known.json").read_text("utf-8"))["distances"])

    ((farther,), (kept,)) = found
    assert (farther["version"], kept) == (__version__, old)
    assert 0.4 < farther["distance_m"] < 0.6


def test_each_search_and_agent_has_a_row_that_says_who_walked(tmp_path: Path) -> None:
    command = ("best-known", "--gait", "tripod", "--world", "flat", "--out", "known.json")
    by = ("--by", "bonus-beam,wave,greedy", "--width", "1,2")
    done = in_process(*command, *by, folder=tmp_path)
    assert done.returncode == 0, done.stderr

    rows = json.loads((tmp_path / "known.json").read_text("utf-8"))["distances"]
    finders = [(row["found_by"], row.get("width")) for row in rows]
    assert finders == [("bonus-beam", 1), ("bonus-beam", 2), ("wave", None), ("greedy", None)]
    assert rows[1]["distance_m"] > rows[2]["distance_m"] > 0.1
    assert f"stiff flat tripod wave: {rows[2]['distance_m']:.3f} m" in done.stdout


def test_walks_of_reports_are_added_but_not_those_of_built_robots(tmp_path: Path) -> None:
    report = tmp_path / "report"
    shutil.copytree(ROOT / "docs" / "reproduction" / "table1", report)
    command = ("best-known", "--reports", "report", "--out", "known.json")
    assert in_process(*command, folder=tmp_path).returncode == 0

    rows = json.loads((tmp_path / "known.json").read_text("utf-8"))["distances"]
    far_m = {(row["robot"], row["gait"], row["found_by"]): row["distance_m"] for row in rows}
    assert len(far_m) == len(rows) == 2 * 4 * 3  # robots, gaits, agents
    assert far_m["stiff", "left-right-origin", "greedy"] == pytest.approx(0.510744)

    summary = json.loads((report / "summary.json").read_text("utf-8"))
    summary["config"]["tolerance"] = 0.03
    (report / "summary.json").write_text(json.dumps(summary), "utf-8")
    (tmp_path / "known.json").unlink()
    assert in_process(*command, folder=tmp_path).returncode == 0
    assert json.loads((tmp_path / "known.json").read_text("utf-8"))["distances"] == []


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("--world", "moon"), "limp-pair"),
        (("--gait", "moonwalk"), "left-right-origin"),
        (("--robot", "steel"), "compliant"),
        (("--width", "0"), "from 1 to 4,096"),
        (("--width", "8,0"), "from 1 to 4,096"),
        (("--by", "beam,luck"), "bonus-beam"),
        (("--reports", "nowhere"), "--out"),
        (("--reports", "nowhere", "--out", "known.json"), "no report of an experiment"),
    ],
)
def test_invalid_search_is_refused(arguments: tuple[str, str], names: str, tmp_path: Path) -> None:
    assert names in refusal("best-known", *arguments, folder=tmp_path, run=in_process)
