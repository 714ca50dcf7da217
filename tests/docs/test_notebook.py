"""The notebook runs from top to bottom, and shows what it says."""

from pathlib import Path
from typing import Any

import nbclient
import nbformat
import pytest

from tests.cli.running import ROOT

NOTEBOOK = ROOT / "docs" / "notebooks" / "reproduce.ipynb"


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> list[Any]:
    """Return the outputs of every cell in order, on few seeds, in a kernel of its own."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]
    folder: Path = tmp_path_factory.mktemp("notebook")
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("HEXAPODS_SEEDS", "2")
        # Settings of whoever runs the tests shall not count, nor be added to.
        environment.setenv("IPYTHONDIR", str(folder))
        environment.setenv("JUPYTER_DATA_DIR", str(folder))
        environment.delenv("HEXAPODS_SIMULATOR", raising=False)
        nbclient.NotebookClient(
            notebook, timeout=100, resources={"metadata": {"path": str(folder)}}
        ).execute()
    return [output for cell in notebook.cells for output in cell.get("outputs", [])]


def test_one_seed_and_another(outputs: list[Any]) -> None:
    lines = outputs[0]["text"].splitlines()
    distances_m = [line.split()[-2] for line in lines]

    assert lines[0] == "greedy             0.497 m"
    assert len(set(distances_m)) == 6


def test_both_figures_have_words_for_who_does_not_see_them(outputs: list[Any]) -> None:
    figures = [output for output in outputs if "image/png" in output.get("data", {})]
    alts = [figure["metadata"]["image/png"]["alt"] for figure in figures]

    assert len(alts) == 2
    assert "front-back-vertical, commanded: " in alts[0]
    assert "2 seeds from" in alts[1]


def test_its_tables_and_verdicts(outputs: list[Any]) -> None:
    tables = [
        output["data"]["text/markdown"]
        for output in outputs
        if "text/markdown" in output.get("data", {})
    ]
    numbers, claims = tables

    assert "| front-back-vertical | commanded | 1,000 | 0.275 |" in numbers
    assert "feet measured: **" in claims
