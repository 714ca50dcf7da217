"""`hexapods export` and `import`, as a user runs them."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.storage.database.store import RunStore
from app.storage.run import TABLE
from tests.cli.running import in_process, output, refusal
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


def test_exported_run_is_imported_into_another_folder(data: Path, tmp_path: Path) -> None:
    for run_id in (TRAINING, RACED):
        out = ("--out", "run.zip", "--data", str(data))
        assert output("export", run_id, *out, folder=tmp_path)["id"] == run_id
        other = ("--data", str(tmp_path / "other"))
        assert output("import", "run.zip", *other, folder=tmp_path, run=in_process)["id"] == run_id
        shown = [
            output("runs", "show", run_id, *at, folder=tmp_path, run=in_process)
            for at in (out[2:], other)
        ]
        assert shown[0] == shown[1]
        again = output("import", "run.zip", *other, folder=tmp_path, run=in_process)
        assert again["id"] != run_id
    imported = in_process("import", "run.zip", "--data", str(data), folder=tmp_path)
    assert "is race " in imported.stdout
    with opened(tmp_path / "other", None) as store:
        assert store.artifact(TRAINING, TABLE) is not None
        assert len(store.list().items) == 4


def test_several_runs_are_exported_and_imported_together(data: Path, tmp_path: Path) -> None:
    out = ("--out", "runs.zip", "--data", str(data))
    exported = output("export", RACED, TRAINING, *out, folder=tmp_path, run=in_process)
    assert exported["ids"] == [RACED, TRAINING]
    other = ("--data", str(tmp_path / "other"))
    imported = output("import", "runs.zip", *other, folder=tmp_path, run=in_process)
    assert [run["id"] for run in imported["items"]] == [RACED, TRAINING]


def test_an_unknown_run_is_refused_with_a_hint(data: Path, tmp_path: Path) -> None:
    arguments = ("export", "--out", "x", "../nope", "--data", str(data))
    sentence = refusal(*arguments, folder=tmp_path, run=in_process)
    assert "no run '../nope'" in sentence
    assert "`hexapods runs list`" in sentence
    assert not (tmp_path / "x").exists()


def test_invalid_archive_or_output_is_refused_in_one_sentence(data: Path, tmp_path: Path) -> None:
    data_option = ("--data", str(data))
    (tmp_path / "junk.zip").write_text("milk")
    (tmp_path / "folder").mkdir()
    for file, names in (
        ("junk.zip", "junk.zip is no archive of a run"),
        ("missing.zip", "cannot read missing.zip"),
        ("folder", "cannot read folder"),
    ):
        assert names in refusal("import", file, *data_option, folder=tmp_path, run=in_process)
    for out, names in (("no/such/x.zip", "can be written"), ("folder", "it is a folder")):
        sentence = refusal(
            "export", TRAINING, "--out", out, *data_option, folder=tmp_path, run=in_process
        )
        assert names in sentence


def test_export_works_beside_a_server_and_import_needs_its_address(
    locked_store: RunStore, data: Path, tmp_path: Path
) -> None:
    data_option = ("--data", str(data))
    locked_store.create(training("zz", state="running"))
    assert "stop it first" in refusal("export", "zz", "--out", "x", *data_option, folder=tmp_path)
    assert output("export", RACED, "--out", "x.zip", *data_option, folder=tmp_path)["id"] == RACED
    sentence = refusal("import", "x.zip", *data_option, folder=tmp_path)
    assert f"another process has the data folder {data}" in sentence
