"""Experiments in the commands for runs."""

from pathlib import Path

from tests.cli.running import in_process, output
from tests.features.experiments.ended_experiments import ended_experiment
from tests.storage.stores import opened


def test_experiment_is_listed_shown_moved_and_deleted(tmp_path: Path) -> None:
    data, other = tmp_path / "data", tmp_path / "other"
    with opened(data, None) as store:
        ended_experiment(store, "00000000000e1")
    data_option = ("--data", str(data))
    listed = in_process(
        "runs", "list", "--kind", "experiment", *data_option, folder=tmp_path
    ).stdout
    assert listed.split("\t")[:4] == ["00000000000e1", "experiment", "finished", "4 trials"]
    shown = in_process("runs", "show", "00000000000e1", *data_option, folder=tmp_path).stdout
    assert "4 of 4" in shown
    archive = str(tmp_path / "run.zip")
    in_process("export", "00000000000e1", "--out", archive, *data_option, folder=tmp_path)
    in_process("import", archive, "--data", str(other), folder=tmp_path)
    moved = output(
        "runs", "show", "00000000000e1", "--data", str(other), folder=tmp_path, run=in_process
    )
    assert moved["result"]["trials"]["done"] == 4
    in_process("runs", "delete", "00000000000e1", *data_option, folder=tmp_path)
    assert output("runs", "list", *data_option, folder=tmp_path, run=in_process)["items"] == []
