"""`hexapods runs`, as a user runs it."""

import json
import os
import pty
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.storage.database.store import RunStore
from tests.cli.running import ROOT, in_process, output, refusal
from tests.storage.ended_runs import ended_race, ended_training
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
    data_option = ("--data", str(data))
    listed = output("runs", "list", *data_option, folder=tmp_path)
    assert [run["id"] for run in listed["items"]] == [TRAINING, RACED]
    assert listed["next_cursor"] is None
    for filters, ids in (
        (("--kind", "race"), [RACED]),
        (("--state", "failed"), []),
        (("--limit", "1"), [TRAINING]),
    ):
        listed = output("runs", "list", *data_option, *filters, folder=tmp_path, run=in_process)
        assert [run["id"] for run in listed["items"]] == ids
    lines = in_process("runs", "list", *data_option, folder=tmp_path).stdout.splitlines()
    assert lines[0].split("\t")[:4] == [TRAINING, "training", "finished", "120"]
    assert lines[1].split("\t")[4] == "Greedy"
    assert "at least 1" in refusal(
        "runs", "list", *data_option, "--limit", "0", folder=tmp_path, run=in_process
    )


def test_runs_are_printed_as_a_table_in_a_terminal(data: Path, tmp_path: Path) -> None:
    controller, terminal = pty.openpty()
    command = [sys.executable, "-m", "app.cli", "runs", "list", "--data", str(data)]
    environment = {"PYTHONPATH": str(ROOT), "TERM": "xterm", "COLUMNS": "120"}
    subprocess.run(command, stdout=terminal, cwd=tmp_path, env=environment, check=True, timeout=60)
    os.close(terminal)
    shown = os.read(controller, 100_000).decode()
    os.close(controller)
    assert "Newest first" in shown
    assert "[b]old[/b]" in shown


def test_run_is_shown_as_json_and_text(data: Path, tmp_path: Path) -> None:
    data_option = ("--data", str(data))
    shown = output("runs", "show", TRAINING, *data_option, folder=tmp_path, run=in_process)
    assert shown["name"] == "[b]old[/b]"
    assert len(shown["curve"]) == 24
    text = in_process("runs", "show", RACED, *data_option, folder=tmp_path).stdout
    assert "Ranked at time-out, paper clock" in text
    assert "16 of 16" in text


@pytest.mark.parametrize("verb", ["show", "delete"])
def test_unknown_run_is_refused_with_a_hint(verb: str, data: Path, tmp_path: Path) -> None:
    for folder in (data, tmp_path / "empty"):
        arguments = ("runs", verb, "../nope", "--data", str(folder))
        sentence = refusal(*arguments, folder=tmp_path, run=in_process)
        assert "no run '../nope'" in sentence
        assert "`hexapods runs list`" in sentence
    assert not (tmp_path / "empty").exists()


def test_run_is_deleted(data: Path, tmp_path: Path) -> None:
    data_option = ("--data", str(data))
    assert output("runs", "delete", RACED, *data_option, folder=tmp_path) == {"deleted": RACED}
    listed = output("runs", "list", *data_option, folder=tmp_path, run=in_process)
    assert [run["id"] for run in listed["items"]] == [TRAINING]


def test_runs_are_listed_by_tag_search_and_order(data: Path, tmp_path: Path) -> None:
    with opened(data, None) as store:
        store.update(RACED, tags=("ice",), notes="slips")

    def listed(*options: str) -> list[str]:
        arguments = ("runs", "list", "--data", str(data), *options)
        return [run["id"] for run in output(*arguments, folder=tmp_path, run=in_process)["items"]]

    assert listed("--sort", "oldest") == listed()[::-1] == sorted((RACED, TRAINING))
    assert listed("--tag", "ICE") == listed("--search", "slip") == [RACED]
    shown = in_process("runs", "show", RACED, "--data", str(data), folder=tmp_path).stdout
    assert "slips" in shown


def test_reading_commands_work_beside_a_server(
    locked_store: RunStore, data: Path, tmp_path: Path
) -> None:
    data_option = ("--data", str(data))
    locked_store.create(training("zz", state="running"))
    listed = output("runs", "list", *data_option, "--state", "running", folder=tmp_path)
    assert [run["id"] for run in listed["items"]] == ["zz"]
    assert locked_store.get("zz").state == "running"


def test_changes_are_refused_without_a_server_address(
    locked_store: RunStore, data: Path, tmp_path: Path
) -> None:
    data_option = ("--data", str(data))
    sentence = refusal("runs", "delete", RACED, *data_option, folder=tmp_path)
    assert f"another process has the data folder {data}" in sentence
    (data / "server.address").write_text(json.dumps({"address": "http://127.0.0.1:1/"}))
    sentence = refusal("runs", "delete", RACED, *data_option, folder=tmp_path)
    assert "does not answer at http://127.0.0.1:1/" in sentence
    assert [run.id for run in locked_store.list().items] == [TRAINING, RACED]
