"""Figures: readable files, the same bytes each time, and words for who does not see them."""

import re
from itertools import pairwise
from typing import Any
from xml.etree import ElementTree

import pytest

from app.experiments.report.drawing import (
    AGENT_COLOURS,
    CSS_NAMES,
    FORMATS,
    FURTHER_COLOURS,
    colours,
    figure,
    inlined,
    rendered,
    spread,
)
from app.experiments.report.figures import panels, sheets
from app.experiments.summary import summarise
from tests.experiments.made import ROBOTS, around, config, made_up, summary_of

EXPERIMENTS = ("table1", "figure4", "sweep")
_BEGINS = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}


def small(experiment: str, seeds: int = 3) -> dict[str, Any]:
    only = {"gaits": ("left-right-origin",), "observations": ("measured",), "robots": ROBOTS[:1]}
    return summary_of(experiment, lambda _: around(0.3), seeds=seeds, **only)


@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_a_figure_is_the_same_bytes_each_time_and_has_no_date(experiment: str) -> None:
    summary = small(experiment)
    for kind in FORMATS:
        first, second = ([rendered(one.figure, kind) for one in sheets(summary)] for _ in range(2))
        assert first == second
        assert all(one.startswith(_BEGINS[kind]) for one in first)
        assert not any(re.search(rb"CreationDate|dc:date|Creation Time", one) for one in first)


@pytest.mark.parametrize("experiment", EXPERIMENTS)
@pytest.mark.parametrize("done", [0, 2, 5])
def test_what_is_not_there_yet_is_not_drawn(experiment: str, done: int) -> None:
    tried = config(experiment, seeds=2, gaits=("left-right-origin",), robots=ROBOTS[:1])
    results = made_up(tried, lambda _: around(0.3))
    summary = summarise(tried, dict(list(results.items())[:done]))
    for _, group in panels(summary):
        for one in group:
            ElementTree.fromstring(inlined(one.figure, one.name))
            assert done or "No trials yet" in one.alt
    for one in sheets(summary):
        assert rendered(one.figure, "png")


@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_every_picture_says_in_words_what_it_shows(experiment: str) -> None:
    summary = summary_of(experiment, lambda _: around(0.3, 0.0), seeds=3)
    for one in [picture for _, group in panels(summary) for picture in group] + sheets(summary):
        alt = one.alt.replace("\xa0", " ")
        assert "0.30 m" in alt or "60 %" in alt


def test_every_seed_is_drawn() -> None:
    few, many = (
        inlined(panels(small("table1", seeds))[0][1][0].figure, "t").count("<use")
        for seeds in (4, 14)
    )
    assert many - few == 2 * 10  # after 500 and after 1,000 steps


def test_what_stands_in_a_page_takes_its_greys_and_shares_no_names() -> None:
    shown = [
        inlined(one.figure, one.name) for _, group in panels(small("table1")) for one in group
    ] + [inlined(one.figure, one.name) for _, group in panels(small("figure4")) for one in group]
    names = [name for one in shown for name in re.findall(r'\bid="([^"]+)"', one)]
    assert len(names) == len(set(names))
    for one in shown:
        assert "<script" not in one
        assert "http" not in re.sub(r'xmlns(:\w+)?="[^"]+"', "", one)
        assert not any(grey in one for grey in CSS_NAMES)
        assert "var(--ink)" in one
        for name in re.findall(r"url\(#([^)]+)\)|href=\"#([^\"]+)", one):
            assert "".join(name) in names


def test_a_name_is_text_in_a_figure_too() -> None:
    made = figure(2, 1)
    made.subplots().set_title("$x^{ <b>one</b> & another")
    shown = inlined(made, "t")
    assert "$x^{ &lt;b&gt;one&lt;/b&gt; &amp; another" in shown
    rendered(made, "pdf")


def test_an_agent_keeps_its_colour() -> None:
    shade = colours(["q-learning", "mine:One", "mine:Two"])
    assert shade["q-learning"] == AGENT_COLOURS["q-learning"] == "#E69F00"
    assert (shade["mine:One"], shade["mine:Two"]) == FURTHER_COLOURS[:2]
    assert shade["greedy"] == "#56B4E9"


def test_neighbours_lie_apart() -> None:
    heights = spread(30, 1)
    assert all(-1 <= height <= 1 for height in heights)
    assert min(abs(a - b) for a, b in pairwise(heights)) > 0.5
