"""Figures for papers: size, text that is text, caption, data, command, and the same bytes again."""

import csv
import io
import logging
import re
import sys
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.experiments.figures.config import FigureConfig, Kind
from hexapods.experiments.figures.files import PaperFigure, paper_figure
from hexapods.experiments.figures.style import LINES, PNG_DPI, WIDTHS_MM
from hexapods.extras import MissingExtra
from tests.experiments.sample_experiments import alpha_of, around, summary_of

pytest.importorskip("matplotlib")
ALPHAS = (0.1, 0.2, 0.3)


@pytest.fixture(scope="module")
def summary() -> dict[str, Any]:
    """Three learning rates with twelve seeds each."""
    return summary_of(
        "sweep",
        lambda setting: around(alpha_of(setting)),
        seeds=12,
        gaits=("left-right-origin",),
        alpha=ALPHAS,
    )


@pytest.fixture(scope="module")
def compared(summary: Mapping[str, Any]) -> PaperFigure:
    """The first setting and the third, in one column."""
    return paper_figure(summary, FigureConfig(kind="comparison", settings=("α 0.3", "α 0.1")))


@pytest.mark.parametrize("columns", [1, 2])
@pytest.mark.parametrize("kind", ["seeds", "profile"])
def test_a_figure_is_as_wide_as_its_columns(
    summary: Mapping[str, Any], kind: Kind, columns: Any
) -> None:
    figure = paper_figure(summary, FigureConfig(kind=kind, columns=columns))
    picture = Image.open(io.BytesIO(figure.pictures["png"]))
    assert picture.size[0] * 25.4 / PNG_DPI == pytest.approx(WIDTHS_MM[columns], abs=0.1)
    width_pt = re.search(rb"/MediaBox \[ 0 0 ([\d.]+)", figure.pictures["pdf"])
    assert width_pt is not None
    assert float(width_pt[1]) * 25.4 / 72 == pytest.approx(WIDTHS_MM[columns], abs=0.1)
    assert f'width="{int(float(width_pt[1]))}.'.encode() in figure.pictures["svg"]


def test_text_is_text_in_an_embedded_font(compared: PaperFigure) -> None:
    pdf = compared.pictures["pdf"]
    assert b"/FontFile2" in pdf
    assert b"/Type3" not in pdf
    streams = re.findall(rb"stream\r?\n(.*?)endstream", pdf, re.DOTALL)
    contents = [zlib.decompressobj().decompress(data) for data in streams if data[:1] == b"x"]
    assert any(re.search(rb"\bT[jJ]\b", content) for content in contents)
    svg = compared.pictures["svg"].decode()
    for text in ("Distance in 50 steps (m)", "Difference (m)", "Q-learning, α 0.3 (n = 12)"):
        assert f">{text}</text>" in svg


def test_a_figure_leaves_no_lines_in_the_log(
    summary: Mapping[str, Any], caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO):
        paper_figure(summary, FigureConfig(kind="seeds", columns=1))
    assert [record.name for record in caplog.records if record.name.startswith("fontTools")] == []


def test_text_is_at_least_seven_points(compared: PaperFigure) -> None:
    sizes = re.findall(r"font-size: ([\d.]+)px", compared.pictures["svg"].decode())
    assert sizes
    assert min(map(float, sizes)) >= 7


def test_profiles_are_told_apart_without_colour() -> None:
    assert len({line.dashes for line in LINES}) == len(LINES)
    assert len({line.marker for line in LINES}) == len(LINES)


def test_the_caption_tells_signs_statistics_and_versions(compared: PaperFigure) -> None:
    caption = compared.caption
    assert caption.startswith("Distance in 50 steps, and its difference (Left-right, opposite, ")
    assert "Dots: seeds, 12 seeds each." in caption
    assert "95 % percentile bootstrap interval, 2,000 resamples" in caption
    assert "Q-learning, α 0.3 comes 0.200 m farther than Q-learning, α 0.1" in caption
    assert "ideal simulator without slip; racing-hexapods" in caption


def test_the_data_are_every_seed_and_the_statistics_what_is_drawn(
    summary: Mapping[str, Any], compared: PaperFigure
) -> None:
    rows = list(csv.DictReader(io.StringIO(compared.data)))
    assert len(rows) == 24
    assert [row["seed_number"] for row in rows] == [*map(str, range(12))] * 2
    [setting] = [entry for entry in summary["settings"] if entry["alpha"] == 0.1]
    points = [float(row["total_distance_m"]) for row in rows if row["setting"] == setting["key"]]
    assert points == setting["total"]["points_m"]
    statistics = list(csv.DictReader(io.StringIO(compared.statistics)))
    of_setting = next(row for row in statistics if row["setting"] == setting["key"])
    assert float(of_setting["iqm_total_distance_m"]) == setting["total"]["iqm_m"]
    assert (float(of_setting["low"]), float(of_setting["high"])) == (
        setting["total"]["low_m"],
        setting["total"]["high_m"],
    )
    assert [row["setting"] for row in statistics][2:] == [
        "difference",
        "probability of improvement",
    ]


def test_profiles_have_their_steps_as_statistics(summary: Mapping[str, Any]) -> None:
    figure = paper_figure(summary, FigureConfig(kind="profile", settings=("α 0.3", "greedy")))
    steps = list(csv.DictReader(io.StringIO(figure.statistics)))
    assert len(steps) == 12 + 1
    assert float(steps[0]["share"]) == 1
    assert steps[-1]["low"] == ""


def test_the_command_repeats_experiment_and_figure(compared: PaperFigure) -> None:
    experiment, figure = compared.command.splitlines()[1:]
    assert experiment.startswith("hexapods sweep ")
    assert experiment.endswith(" --out sweep-results")
    assert figure.startswith("hexapods figure sweep-results --kind comparison --columns 1 ")
    assert figure.count("--setting") == 2


def test_the_same_summary_gives_the_same_bytes_in_an_archive_with_all_files(
    summary: Mapping[str, Any], compared: PaperFigure, tmp_path: Path
) -> None:
    again = paper_figure(summary, FigureConfig(kind="comparison", settings=("α 0.3", "α 0.1")))
    assert again.to_bytes() == compared.to_bytes()
    with zipfile.ZipFile(compared.save(tmp_path / "figure.zip")) as archive:
        assert archive.namelist() == [
            "figure.pdf",
            "figure.svg",
            "figure.png",
            "caption.txt",
            "data.csv",
            "statistics.csv",
            "command.sh",
        ]
        assert archive.read("caption.txt").decode() == compared.caption
    assert compared.save(tmp_path / "figure.pdf").read_bytes() == compared.pictures["pdf"]
    with pytest.raises(InvalidInput, match=r"one of \.zip, \.pdf, \.svg, \.png, not \.gif"):
        compared.save(tmp_path / "figure.gif")


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"kind": "pie"}, "unknown kind of figure 'pie'; choose one of: seeds, comparison"),
        ({"columns": 3}, "fills 1 or 2 columns of a page, not 3"),
        ({"kind": "comparison", "settings": ("a",)}, "of two settings, and 1 are named"),
        ({"unit": "km"}, "choose one of: m, h, greedy"),
    ],
)
def test_what_a_figure_cannot_be_is_refused(values: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        FigureConfig(**values)


def test_settings_of_a_figure_are_known_few_and_named_once(summary: Mapping[str, Any]) -> None:
    with pytest.raises(UnknownName, match="unknown setting 'nobody'"):
        paper_figure(summary, FigureConfig(settings=("nobody",)))
    with pytest.raises(InvalidInput, match="is named twice"):
        paper_figure(summary, FigureConfig(settings=("α 0.1", "alpha=0.1")))
    wide = summary_of(
        "sweep",
        lambda setting: around(0.3),
        seeds=3,
        gaits=("left-right-origin",),
        alpha=tuple(0.1 * n for n in range(1, 8)),
    )
    with pytest.raises(InvalidInput, match="profiles shows at most 6 settings, not 8"):
        paper_figure(wide, FigureConfig(kind="profile"))


def test_without_matplotlib_the_line_that_installs_it_is_named(
    summary: Mapping[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingExtra, match=r'pip install "racing-hexapods\[figures\]"'):
        paper_figure(summary, FigureConfig())
