"""`hexapods runs`, `export` and `import`, as a user runs them."""

import json
import os
import pty
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.storage.database.store import RunStore
from app.storage.run import TABLE
from tests.cli.running import ROOT, in_process, output, refusal
from tests.storage.ended_runs import ended_experiment, ended_race, ended_training
from tests.storage.stores import opened, training

TRAINING, RACED = "00000000000t1", "00000000000r1"


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """Return a data folder with a finished training and race."""
    folder = tmp_path / "data"
    with opened(folder, None) as store:
        ended_training(store, TRAINING, "[b]old[/b]")
        ended_race(store, RACED, TRAINING)
    return folder


@pytest.fixture
def locked_store(data: Path) -> Iterator[RunStore]:
    """Return the open store of the data folder, which holds its lock as a server does."""
    with opened(data, None) as store:
        yield store


def test_runs_are_listed(data: Path, tmp_path: Path) -> None:
    here = ("--data", str(data))
    listed = output("runs", "list", *here, folder=tmp_path)
    assert [run["id"] for run in listed["items"]] == [TRAINING, RACED]
    assert listed["next_cursor"] is None
    for filters, ids in (
        (("--kind", "race"), [RACED]),
        (("--state", "failed"), []),
        (("--limit", "1"), [TRAINING]),
    ):
        listed = output("runs", "list", *here, *filters, folder=tmp_path, run=in_process)
        assert [run["id"] for run in listed["items"]] == ids
    lines = in_process("runs", "list", *here, folder=tmp_path).stdout.splitlines()
    assert lines[0].split("\t")[:4] == [TRAINING, "training", "finished", "120"]
    assert lines[1].split("\t")[4] == "Greedy"
    assert "at least 1" in refusal(
        "runs", "list", *here, "--limit", "0", folder=tmp_path, run=in_process
    )


def test_runs_are_printed_as_a_table_in_a_terminal(data: Path, tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "app.cli", "runs", "list", "--data", str(data)]
    environment = {"PYTHONPATH": str(ROOT), "TERM": "xterm", "COLUMNS": "120"}
    subprocess.run(command, stdout=theirs, cwd=tmp_path, env=environment, check=True, timeout=60)
    os.close(theirs)
    shown = os.read(ours, 100_000).decode()
    os.close(ours)
    assert "Newest first" in shown
    assert "[b]old[/b]" in shown


def test_run_is_shown_as_json_and_text(data: Path, tmp_path: Path) -> None:
    here = ("--data", str(data))
    shown = output("runs", "show", TRAINING, *here, folder=tmp_path, run=in_process)
    assert shown["name"] == "[b]old[/b]"
    assert len(shown["curve"]) == 24
    text = in_process("runs", "show", RACED, *here, folder=tmp_path).stdout
    assert "Ranked at time-out, paper clock" in text
    assert "16 of 16" in text


@pytest.mark.parametrize("verb", [("runs", "show"), ("runs", "delete"), ("export", "--out", "x")])
def test_unknown_run_is_refused_with_a_hint(
    verb: tuple[str, ...], data: Path, tmp_path: Path
) -> None:
    for folder in (data, tmp_path / "empty"):
        sentence = refusal(*verb, "../nope", "--data", str(folder), folder=tmp_path, run=in_process)
        assert "no run '../nope'" in sentence
        assert "`hexapods runs list`" in sentence
    assert not (tmp_path / "x").exists()
    assert not (tmp_path / "empty").exists()


def test_run_is_deleted(data: Path, tmp_path: Path) -> None:
    here = ("--data", str(data))
    assert output("runs", "delete", RACED, *here, folder=tmp_path) == {"deleted": RACED}
    listed = output("runs", "list", *here, folder=tmp_path, run=in_process)
    assert [run["id"] for run in listed["items"]] == [TRAINING]


def test_exported_run_is_imported_into_another_folder(data: Path, tmp_path: Path) -> None:
    for run_id in (TRAINING, RACED):
        out = ("--out", "run.zip", "--data", str(data))
        assert output("export", run_id, *out, folder=tmp_path)["id"] == run_id
        other = ("--data", str(tmp_path / "other"))
        assert output("import", "run.zip", *other, folder=tmp_path, run=in_process)["id"] == run_id
        there = [
            output("runs", "show", run_id, *at, folder=tmp_path, run=in_process)
            for at in (out[2:], other)
        ]
        assert there[0] == there[1]
        again = output("import", "run.zip", *other, folder=tmp_path, run=in_process)
        assert again["id"] != run_id
    imported = in_process("import", "run.zip", "--data", str(data), folder=tmp_path)
    assert "is race " in imported.stdout
    with opened(tmp_path / "other", None) as store:
        assert store.artifact(TRAINING, TABLE) is not None
        assert len(store.list().items) == 4


def test_walk_is_written_as_a_file(data: Path, tmp_path: Path) -> None:
    def write(*arguments: str) -> str:
        return refusal("runs", "trajectory", *arguments, *here, folder=tmp_path, run=in_process)

    here = ("--data", str(data))
    told = output("runs", "trajectory", RACED, "--out", "w.csv", *here, folder=tmp_path)
    assert (told["id"], told["bytes"]) == (RACED, (tmp_path / "w.csv").stat().st_size)
    head, *rows = (tmp_path / "w.csv").read_text().splitlines()
    assert head.startswith("lane,step,time_s,body_x_m")
    assert {row.split(",")[0] for row in rows} == {"0", "1"}
    log = output("runs", "mcap", RACED, "--out", "r.mcap", *here, folder=tmp_path, run=in_process)
    assert log["bytes"] == (tmp_path / "r.mcap").stat().st_size
    video = ("--out", "r.gif", "--width", "64", "--height", "64", "--fps", "1")
    output("runs", "video", RACED, *video, *here, folder=tmp_path, run=in_process)
    assert (tmp_path / "r.gif").read_bytes()[:6] == b"GIF89a"
    assert "must end with .csv or .parquet: w.txt" in write(RACED, "--out", "w.txt")
    assert "lane must be from 0 to 1, not 2" in write(RACED, "--lane", "2", "--out", "w.csv")
    assert "no run 'nope'" in write("nope", "--out", "w.csv")
    assert f"{TRAINING} is finished and has no recording" in write(TRAINING, "--out", "w.csv")
    done = in_process("runs", "page", RACED, "--out", "r.html", *here, folder=tmp_path)
    assert re.fullmatch(rf"Race {RACED} is in r.html \(\d+ kB\).\n", done.stdout)


def test_video_without_opengl_names_its_packages(data: Path, tmp_path: Path) -> None:
    video = ("runs", "video", RACED, "--out", "r.mp4", "--data", str(data))
    sentence = refusal(*video, folder=tmp_path, MUJOCO_GL="milk")
    assert "does not work here by milk" in sentence
    assert "apt-get install libegl1 libgl1-mesa-dri" in sentence


def test_runs_are_listed_by_tag_search_and_order(data: Path, tmp_path: Path) -> None:
    with opened(data, None) as store:
        store.update(RACED, tags=("ice",), notes="slips")

    def listed(*options: str) -> list[str]:
        given = ("runs", "list", "--data", str(data), *options)
        return [run["id"] for run in output(*given, folder=tmp_path, run=in_process)["items"]]

    assert listed("--sort", "oldest") == listed()[::-1] == sorted((RACED, TRAINING))
    assert listed("--tag", "ICE") == listed("--search", "slip") == [RACED]
    shown = in_process("runs", "show", RACED, "--data", str(data), folder=tmp_path).stdout
    assert "slips" in shown


def test_several_runs_are_exported_and_imported_together(data: Path, tmp_path: Path) -> None:
    out = ("--out", "runs.zip", "--data", str(data))
    exported = output("export", RACED, TRAINING, *out, folder=tmp_path, run=in_process)
    assert exported["ids"] == [RACED, TRAINING]
    other = ("--data", str(tmp_path / "other"))
    imported = output("import", "runs.zip", *other, folder=tmp_path, run=in_process)
    assert [run["id"] for run in imported["items"]] == [RACED, TRAINING]


def test_invalid_archive_or_output_is_refused_in_one_sentence(data: Path, tmp_path: Path) -> None:
    here = ("--data", str(data))
    (tmp_path / "junk.zip").write_text("milk")
    (tmp_path / "folder").mkdir()
    for file, names in (
        ("junk.zip", "junk.zip is no archive of a run"),
        ("missing.zip", "cannot read missing.zip"),
        ("folder", "cannot read folder"),
    ):
        assert names in refusal("import", file, *here, folder=tmp_path, run=in_process)
    for out, names in (("no/such/x.zip", "can be written"), ("folder", "it is a folder")):
        sentence = refusal("export", TRAINING, "--out", out, *here, folder=tmp_path, run=in_process)
        assert names in sentence


def test_reading_commands_work_beside_a_server(
    locked_store: RunStore, data: Path, tmp_path: Path
) -> None:
    here = ("--data", str(data))
    locked_store.create(training("zz", state="running"))
    listed = output("runs", "list", *here, "--state", "running", folder=tmp_path)
    assert [run["id"] for run in listed["items"]] == ["zz"]
    assert "stop it first" in refusal("export", "zz", "--out", "x", *here, folder=tmp_path)
    assert output("export", RACED, "--out", "x", *here, folder=tmp_path)["id"] == RACED
    assert locked_store.get("zz").state == "running"


def test_changes_are_refused_without_a_server_address(
    locked_store: RunStore, data: Path, tmp_path: Path
) -> None:
    here = ("--data", str(data))
    output("export", RACED, "--out", "x.zip", *here, folder=tmp_path)
    for command in (("runs", "delete", RACED), ("import", "x.zip")):
        sentence = refusal(*command, *here, folder=tmp_path)
        assert f"another process has the data folder {data}" in sentence
    (data / "server.address").write_text(json.dumps({"address": "http://127.0.0.1:1/"}))
    sentence = refusal("runs", "delete", RACED, *here, folder=tmp_path)
    assert "does not answer at http://127.0.0.1:1/" in sentence
    assert [run.id for run in locked_store.list().items] == [TRAINING, RACED]


def test_experiment_is_listed_shown_moved_and_deleted(tmp_path: Path) -> None:
    data, other = tmp_path / "data", tmp_path / "other"
    with opened(data, None) as store:
        ended_experiment(store, "00000000000e1")
    here = ("--data", str(data))
    listed = in_process("runs", "list", "--kind", "experiment", *here, folder=tmp_path).stdout
    assert listed.split("\t")[:4] == ["00000000000e1", "experiment", "finished", "4 trials"]
    shown = in_process("runs", "show", "00000000000e1", *here, folder=tmp_path).stdout
    assert "4 of 4" in shown
    archive = str(tmp_path / "run.zip")
    in_process("export", "00000000000e1", "--out", archive, *here, folder=tmp_path)
    in_process("import", archive, "--data", str(other), folder=tmp_path)
    moved = output(
        "runs", "show", "00000000000e1", "--data", str(other), folder=tmp_path, run=in_process
    )
    assert moved["result"]["trials"]["done"] == 4
    in_process("runs", "delete", "00000000000e1", *here, folder=tmp_path)
    assert output("runs", "list", *here, folder=tmp_path, run=in_process)["items"] == []
