"""Verbs of `hexapods runs` that write a run's walk to a file, as a user runs them."""

import re
from pathlib import Path

import pytest

from tests.cli.running import in_process, output, refusal
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened

TRAINING, RACED = "00000000000t1", "00000000000r1"


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """Return a data folder with a finished training and race."""
    folder = tmp_path / "data"
    with opened(folder, None) as store:
        ended_training(store, TRAINING)
        ended_race(store, RACED, TRAINING)
    return folder


def test_walk_is_written_as_a_file(data: Path, tmp_path: Path) -> None:
    def write(*arguments: str) -> str:
        return refusal(
            "runs", "trajectory", *arguments, *data_option, folder=tmp_path, run=in_process
        )

    data_option = ("--data", str(data))
    result = output("runs", "trajectory", RACED, "--out", "w.csv", *data_option, folder=tmp_path)
    assert (result["id"], result["bytes"]) == (RACED, (tmp_path / "w.csv").stat().st_size)
    head, *rows = (tmp_path / "w.csv").read_text().splitlines()
    assert head.startswith("lane,step,time_s,body_x_m")
    assert {row.split(",")[0] for row in rows} == {"0", "1"}
    log = output(
        "runs", "mcap", RACED, "--out", "r.mcap", *data_option, folder=tmp_path, run=in_process
    )
    assert log["bytes"] == (tmp_path / "r.mcap").stat().st_size
    video = ("--out", "r.gif", "--width", "64", "--height", "64", "--fps", "1")
    output("runs", "video", RACED, *video, *data_option, folder=tmp_path, run=in_process)
    assert (tmp_path / "r.gif").read_bytes()[:6] == b"GIF89a"
    assert "must end with .csv or .parquet: w.txt" in write(RACED, "--out", "w.txt")
    assert "lane must be from 0 to 1, not 2" in write(RACED, "--lane", "2", "--out", "w.csv")
    assert "no run 'nope'" in write("nope", "--out", "w.csv")
    assert f"{TRAINING} is finished and has no recording" in write(TRAINING, "--out", "w.csv")
    done = in_process("runs", "page", RACED, "--out", "r.html", *data_option, folder=tmp_path)
    assert re.fullmatch(rf"Race {RACED} is in r.html \([\d.,]+ [kM]B\).\n", done.stdout)


def test_video_without_opengl_names_its_packages(data: Path, tmp_path: Path) -> None:
    video = ("runs", "video", RACED, "--out", "r.mp4", "--data", str(data))
    sentence = refusal(*video, folder=tmp_path, MUJOCO_GL="milk")
    assert "does not work here by milk" in sentence
    assert "apt-get install libegl1 libgl1-mesa-dri" in sentence
