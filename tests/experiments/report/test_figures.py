"""Figures: reproducible files, and alternative text for screen readers."""

import re
from itertools import pairwise
from typing import Any
from xml.etree import ElementTree

import pytest

from hexapods.experiments.report.drawing import (
    CSS_NAMES,
    FORMATS,
    agent_colours,
    figure,
    inline_svg,
    jitter,
    render,
)
from hexapods.experiments.report.figures import panels, sheets
from hexapods.experiments.summary import summarise
from tests.experiments.sample_experiments import ROBOTS, around, config, sample_results, summary_of

EXPERIMENTS = ("table1", "figure4", "sweep")
_BEGINS = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}


def small(experiment: str, seeds: int = 3, **given: Any) -> dict[str, Any]:
    only = {"gaits": ("left-right-origin",), "observations": ("measured",), "robots": ROBOTS[:1]}
    return summary_of(experiment, lambda _: around(0.3), seeds=seeds, **only, **given)


@pytest.mark.test
@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_a_figure_renders_to_the_same_bytes_each_time_without_a_date(experiment: str) -> None:
    summary = small(experiment)
    for kind in FORMATS:
        first, second = (
            [render(sheet.figure, kind) for sheet in sheets(summary)] for _ in range(2)
        )
        assert first == second
        assert all(one.startswith(_BEGINS[kind]) for one in first)
        assert not any(re.search(rb"CreationDate|dc:date|Creation Time", one) for one in first)


@pytest.mark.test
@pytest.mark.parametrize("experiment", EXPERIMENTS)
@pytest.mark.parametrize("done", [0, 2, 5])
def test_figures_of_an_incomplete_experiment_can_be_drawn(experiment: str, done: int) -> None:
    tried = config(experiment, seeds=2, gaits=("left-right-origin",), robots=ROBOTS[:1])
    results = sample_results(tried, lambda _: around(0.3))
    summary = summarise(tried, dict(list(results.items())[:done]))
    for _, group in panels(summary):
        for sheet in group:
            ElementTree.fromstring(inline_svg(sheet.figure, sheet.name))
            assert done or "No trials yet" in sheet.alt
            assert "1 seeds" not in sheet.alt
    for sheet in sheets(summary):
        assert render(sheet.figure, "png")


@pytest.mark.test
@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_every_picture_has_its_numbers_in_the_alternative_text(experiment: str) -> None:
    summary = summary_of(experiment, lambda _: around(0.3, 0.0), seeds=3)
    for one in [picture for _, group in panels(summary) for picture in group] + sheets(summary):
        alt = one.alt.replace("\xa0", " ")
        assert "0.30 m" in alt or "60 %" in alt


@pytest.mark.parametrize(
    ("experiment", "words"),
    [("table1", "best known 0.51"), ("figure4", "best known 0.51"), ("sweep", "102 % best known")],
)
def test_the_best_known_distance_is_in_the_picture_and_its_text(
    experiment: str, words: str
) -> None:
    known, unknown = small(experiment, simulator="mujoco"), small(experiment)
    for summary, is_known in ((known, True), (unknown, False)):
        one = panels(summary)[0][1][0]
        assert (words in one.alt.replace("\xa0", " ")) == is_known
        if experiment != "table1":  # there the key names the line
            assert ("best known" in inline_svg(one.figure, "t")) == is_known


def test_every_seed_is_drawn() -> None:
    few, many = (
        inline_svg(panels(small("table1", seeds))[0][1][0].figure, "t").count("<use")
        for seeds in (4, 14)
    )
    assert many - few == 2 * 10  # after 500 and after 1,000 steps


def test_inline_svg_uses_css_variables_and_unique_ids() -> None:
    shown = [
        inline_svg(one.figure, one.name) for _, group in panels(small("table1")) for one in group
    ] + [inline_svg(one.figure, one.name) for _, group in panels(small("figure4")) for one in group]
    names = [name for one in shown for name in re.findall(r'\bid="([^"]+)"', one)]
    assert len(names) == len(set(names))
    for one in shown:
        assert "<script" not in one
        assert "http" not in re.sub(r'xmlns(:\w+)?="[^"]+"', "", one)
        assert not any(grey in one for grey in CSS_NAMES)
        assert "var(--ink)" in one
        for name in re.findall(r"url\(#([^)]+)\)|href=\"#([^\"]+)", one):
            assert "".join(name) in names


def test_names_are_escaped_in_figures() -> None:
    made = figure(2, 1)
    made.subplots().set_title("$x^{ <b>one</b> & another")
    shown = inline_svg(made, "t")
    assert "$x^{ &lt;b&gt;one&lt;/b&gt; &amp; another" in shown
    render(made, "pdf")


def test_the_papers_agents_have_fixed_colours() -> None:
    shade = agent_colours(["q-learning", "mine:One", "mine:Two"])
    assert (shade["q-learning"], shade["greedy"]) == ("#E69F00", "#56B4E9")
    assert len(set(shade.values())) == len(shade)


def test_neighbouring_points_have_different_jitter() -> None:
    heights = jitter(30, 1)
    assert all(-1 <= height <= 1 for height in heights)
    assert min(abs(a - b) for a, b in pairwise(heights)) > 0.5
