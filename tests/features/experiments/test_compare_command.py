"""`hexapods compare` and `hexapods figure`, of a results folder."""

import json
from pathlib import Path

import pytest

from app.cli import main
from hexapods.experiments.report.files import report_files, write_files
from hexapods.experiments.summary import summarise
from tests.experiments.sample_experiments import alpha_of, around, config, sample_results


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results folder of two learning rates."""
    tried = config("sweep", seeds=10, gaits=("left-right-origin",), alpha=(0.1, 0.3))
    results = sample_results(tried, lambda setting: around(alpha_of(setting)))
    path = tmp_path_factory.mktemp("results")
    write_files(path, report_files(summarise(tried, results), results))
    return path


def test_two_settings_are_compared_in_sentences_and_as_json(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(folder), "α 0.3", "α 0.1"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("Q-learning, α 0.3 comes 0.200\u00a0m farther than Q-learning, α 0.1")
    assert len(said) == 4
    assert main(["compare", str(folder), "α 0.3", "α 0.1", "--unit", "greedy", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["difference"]["value"] == pytest.approx(0.4)
    assert data["ahead"] == "a"


def test_a_figure_is_written_with_its_caption(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")
    out = tmp_path / "figure.svg"
    options = ["--kind", "profile", "--columns", "2", "--setting", "α 0.3", "--setting", "greedy"]
    assert main(["figure", str(folder), *options, "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"The figure is in {out} (")
    assert "Performance profiles of the distance in 50 steps" in said
    assert "Share of seeds that reach τ" in out.read_text("utf-8")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["compare", "{folder}", "α 0.3", "α 0.9"], "unknown setting 'α 0.9'; choose one of: left"),
        (["compare", "{folder}", "α 0.3", "α 0.3"], "compared with itself"),
        (["compare", "{empty}", "a", "b"], "has no summary.json of an experiment"),
        (["compare", "{damaged}", "a", "b"], "is no summary of an experiment"),
        (["figure", "{folder}", "--out", "figure.gif"], "one of .zip, .pdf, .svg, .png, not .gif"),
        (["figure", "{folder}", "--kind", "comparison"], "of two settings, and 0 are named"),
    ],
)
def test_what_cannot_be_done_is_said(
    arguments: list[str],
    said: str,
    *,
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "damaged").mkdir()
    (tmp_path / "damaged" / "summary.json").write_text("{}")
    places = {"folder": folder, "empty": tmp_path, "damaged": tmp_path / "damaged"}
    assert main([argument.format(**places) for argument in arguments]) != 0
    assert said in capsys.readouterr().err
