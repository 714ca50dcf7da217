"""The paper: it builds, its references resolve, and its numbers are those that are computed."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from paper.build import build, with_numbers
from paper.computed import FIGURES, PAPER, PAPER_FIGURES, RESULTS, SWEEP, block, draw, with_block

pytestmark = pytest.mark.promises

TEXT = (PAPER / "paper.md").read_text("utf-8")


def test_it_builds_with_every_citation_and_picture(tmp_path: Path) -> None:
    html, pdf = build(tmp_path)
    shown = html.read_text("utf-8")
    assert pdf.read_bytes().startswith(b"%PDF-")
    assert shown.count('class="csl-entry"') == len(re.findall(r"^@", bibliography(), re.MULTILINE))
    assert shown.count('src="data:image/png;base64,') == len(PAPER_FIGURES)
    assert "autoref" not in shown
    assert "???" not in shown


def bibliography() -> str:
    return (PAPER / "paper.bib").read_text("utf-8")


def test_each_work_of_the_bibliography_is_cited_and_can_be_found() -> None:
    for entry in re.split(r"^@", bibliography(), flags=re.MULTILINE)[1:]:
        key = entry.partition("{")[2].partition(",")[0]
        assert f"@{key}" in TEXT, key
        assert re.search(r"\b(doi|isbn|url|booktitle)\s*=", entry), key


def test_a_citation_that_is_in_no_bibliography_fails_the_build(tmp_path: Path) -> None:
    copy = tmp_path / "paper.md"
    copy.write_text(TEXT.replace("@Hake1998", "@Nobody1998"), "utf-8")
    pandoc = [sys.executable, "-c", "import pypandoc; print(pypandoc.get_pandoc_path())"]
    path = subprocess.run(pandoc, capture_output=True, text=True, check=True).stdout.strip()
    options = ("--citeproc", "--fail-if-warnings", "--bibliography", PAPER / "paper.bib")
    done = subprocess.run([path, copy, *options], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "Nobody1998" in done.stderr


def test_a_reference_to_no_figure_is_refused_with_those_that_there_are() -> None:
    figure, reference = "![A.\\label{fig:a}](a.png)", "\\autoref{fig:a} "
    with pytest.raises(ValueError, match=r"fig:nothing; there are \['fig:a'\]"):
        with_numbers(figure + "\\autoref{fig:nothing}", has_captions_numbered=True)
    shown = with_numbers(reference + figure, has_captions_numbered=False)
    assert shown == "Figure 1 ![Figure 1. A.](a.png)"
    assert with_numbers(reference + figure, has_captions_numbered=True) == "Figure 1 ![A.](a.png)"


def test_the_results_are_of_the_experiment_that_is_repeated() -> None:
    config = json.loads((RESULTS / "summary.json").read_text("utf-8"))["config"]
    assert config["seeds"] == 30
    asked_for = dict(zip(SWEEP[1::2], SWEEP[2::2], strict=True))
    assert ",".join(config["observations"]) == asked_for["--observation"]
    assert config["settings"]["alpha"] == [float(v) for v in asked_for["--alpha"].split(",")]
    assert [str(steps) for steps in config["steps"]] == [asked_for["--steps"]]


def test_captions_and_statistics_are_those_that_are_drawn_from_the_results(tmp_path: Path) -> None:
    captions = {}
    for figure in PAPER_FIGURES:
        files = draw(figure, RESULTS, tmp_path)
        captions[figure.name] = files["caption.txt"].decode().strip()
        assert (FIGURES / f"{figure.name}.csv").read_bytes() == files["statistics.csv"]
        assert (FIGURES / f"{figure.name}.png").read_bytes().startswith(b"\x89PNG")
    assert with_block(TEXT, block(captions)) == TEXT


def test_the_text_says_of_each_figure_whether_its_seeds_settle_it() -> None:
    settled = {}
    for figure in PAPER_FIGURES:
        rows = csv.DictReader((FIGURES / f"{figure.name}.csv").read_text("utf-8").splitlines())
        [difference] = [row for row in rows if row["setting"] == "difference"]
        settled[figure.name] = float(difference["low"]) > 0 or float(difference["high"]) < 0
    assert settled == {"observation": True, "alpha": False}
    assert "In \\autoref{fig:observation} thirty settle it" in TEXT
    assert "In \\autoref{fig:alpha} thirty robots" in TEXT
    assert "thirty name none" in TEXT
