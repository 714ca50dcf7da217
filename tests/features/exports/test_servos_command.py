"""`hexapods runs servos`, as a user runs it: the file, and what is said of the servos' speed."""

import json
from pathlib import Path

import pytest

from tests.cli.running import in_process, output, refusal
from tests.exports.servo_maps import map_text
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened

TRAINING, RACED = "00000000000t1", "00000000000r1"
MAP = ("--map", "mine.yaml")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a map of servos of 100 °/s, and a data folder with a race."""
    with opened(tmp_path / "data", None) as store:
        ended_training(store, TRAINING)
        ended_race(store, RACED, TRAINING)
    (tmp_path / "mine.yaml").write_text(map_text("speed_deg_s: 100"))
    return tmp_path


def servos(*arguments: str, folder: Path) -> str:
    done = in_process("runs", "servos", RACED, *arguments, "--data", "data", folder=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_walk_is_written_in_each_form(folder: Path) -> None:
    for ending in ("csv", "json", "h"):
        out = ("--out", f"w.{ending}", "--data", "data")
        result = output("runs", "servos", RACED, *MAP, *out, folder=folder, run=in_process)
        assert result["bytes"] == (folder / f"w.{ending}").stat().st_size
        assert (result["lane"], result["steps"]) == (0, [1, 8])
    assert (folder / "w.csv").read_text().startswith("time_s,leg1_coxa_us,leg1_femur_us")
    assert len((folder / "w.csv").read_text().splitlines()) == result["frames"] + 1
    assert json.loads((folder / "w.json").read_text())["joint_names"][0] == "leg1_coxa"
    assert "PROGMEM" in (folder / "w.h").read_text()


def test_servos_that_cannot_follow_are_named_and_the_walk_is_slowed_down(folder: Path) -> None:
    said = servos(*MAP, "--lane", "1", "--out", "w.csv", folder=folder).splitlines()
    assert said[0].startswith(f"Race {RACED}, lane 1 (greedy), steps 1 to 8: 129 frames of 20 ms,")
    assert "servos cannot follow at 70 % of the no-load speed, which is counted on:" in said[1]
    assert " needs " in said[2]
    assert said[2].startswith("  leg")
    assert " of 70 °/s at " in said[2]
    assert said[-1].endswith("times as long: --slow-down does that.")

    slowly = servos(*MAP, "--lane", "1", "--slow-down", "--out", "w.csv", folder=folder)
    assert "Slowed down: it takes " in slowly
    assert "cannot" not in slowly
    out = ("--lane", "1", "--slow-down", "--out", "w.csv", "--data", "data")
    result = output("runs", "servos", RACED, *MAP, *out, folder=folder, run=in_process)
    assert result["slowed"] == result["slow_enough"] > 1
    assert result["too_slow"] == []


def test_servos_that_can_follow_or_have_no_known_speed_are_reported(folder: Path) -> None:
    fast_servo = "{board: 9, channel: 9, us_at_zero: 1500, us_per_rad: 400, speed_deg_s: 9000}"
    for text, sentence in (
        (map_text("speed_deg_s: 9000"), "The servos can follow at 70 % of the no-load speed; the"),
        (map_text(), "The map has no speed_deg_s: whether the servos can follow is not known."),
        (
            map_text(leg1_coxa=fast_servo),
            "leg6_tibia the map has no speed_deg_s: they are not checked.",
        ),
    ):
        (folder / "mine.yaml").write_text(text)
        assert sentence in servos(*MAP, "--out", "w.csv", folder=folder)


def test_what_is_wrong_is_refused_and_nothing_is_written(folder: Path) -> None:
    def refused(*arguments: str, run: str = RACED) -> str:
        command = ("runs", "servos", run, *arguments, "--data", "data")
        return refusal(*command, folder=folder, run=in_process)

    (folder / "bad.yaml").write_text(map_text(leg3_coxa=None))
    beyond = "{board: 9, channel: 9, us_at_zero: 9000, us_per_rad: 500}"
    (folder / "far.yaml").write_text(map_text(leg3_coxa=beyond))
    assert "must end with .csv or .json or .h: w.ros" in refused(*MAP, "--out", "w.ros")
    assert "lane must be from 0 to 1, not 2" in refused(*MAP, "--lane", "2", "--out", "w.h")
    assert "bad.yaml, line 2: no servo is given for leg3_coxa;" in refused(
        "--map", "bad.yaml", "--out", "w.h"
    )
    assert "leg3_coxa (board 9, channel 9) would get " in refused(
        "--map", "far.yaml", "--out", "w.h"
    )
    assert "the servo map none.yaml cannot be read" in refused("--map", "none.yaml", "--out", "w.h")
    assert "no run 'nope'" in refused(*MAP, "--out", "w.h", run="nope")
    assert "cannot write no/w.h" in refused(*MAP, "--out", "no/w.h")
    assert not [*folder.glob("w.*")]
