"""`hexapods best-known`, as a user runs it."""

import json
from pathlib import Path

import pytest

from tests.cli.running import in_process, refusal


def test_distances_are_kept_and_not_computed_again(tmp_path: Path) -> None:
    command = ("best-known", "--gait", "left-right-origin", "--width", "1", "--threads", "1")
    printed = []
    for worlds in ("flat", "flat,limp-pair"):
        done = in_process(*command, "--world", worlds, "--out", "known.json", folder=tmp_path)
        assert done.returncode == 0, done.stderr
        printed.append(done.stdout)

    rows = json.loads((tmp_path / "known.json").read_text("utf-8"))["distances"]
    assert [row["world"] for row in rows] == ["flat", "limp-pair"]
    for row, text in zip(rows, printed, strict=True):
        line = f"stiff {row['world']} left-right-origin: {row['distance_m']:.3f} m"
        assert line in text
    assert "flat" not in printed[1]


def test_farther_walk_replaces_a_shorter_one(tmp_path: Path) -> None:
    command = ("best-known", "--gait", "left-right-origin", "--world", "flat", "--width", "1")
    found = []
    for distance_m in (0.1, 9.0):
        row = {"robot": "stiff", "world": "flat", "gait": "left-right-origin", "width": 48}
        old = {**row, "version": "0", "distance_m": distance_m}
        (tmp_path / "known.json").write_text(json.dumps({"distances": [old]}))
        assert in_process(*command, "--out", "known.json", folder=tmp_path).returncode == 0
        found.append(json.loads((tmp_path / "known.json").read_text("utf-8"))["distances"])

    ((farther,), (kept,)) = found
    assert (farther["width"], kept) == (1, old)
    assert 0.4 < farther["distance_m"] < 0.6


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("--world", "moon"), "limp-pair"),
        (("--gait", "moonwalk"), "left-right-origin"),
        (("--robot", "steel"), "compliant"),
        (("--width", "0"), "from 1 to 4,096"),
    ],
)
def test_invalid_search_is_refused(arguments: tuple[str, str], names: str, tmp_path: Path) -> None:
    assert names in refusal("best-known", *arguments, folder=tmp_path, run=in_process)
