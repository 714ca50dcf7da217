"""Colours of agents and values."""

import json
import re

import numpy as np

from hexapods import assets
from hexapods.drawing.colormap import VIRIDIS, rgb, value_colors


def test_page_and_stage_use_the_same_scale() -> None:
    script = (assets.static_dir() / "js" / "scale.js").read_text("utf-8")
    match = re.search(r"STOPS = (\[.*?\]);", script, re.DOTALL)
    assert match is not None
    stops = json.loads(re.sub(r",\s*\]", "]", match[1]))

    assert [tuple(stop) for stop in stops] == [rgb(color) for color in VIRIDIS]


def test_values_map_from_the_low_to_the_high_end() -> None:
    colors = value_colors(np.array([-1.0, 0.0, 0.05, 0.1, 9.0, np.nan]), 0.0, 0.1)

    assert tuple(colors[0]) == tuple(colors[1]) == tuple(colors[5]) == rgb(VIRIDIS[0])
    assert tuple(colors[2]) == rgb(VIRIDIS[5])
    assert tuple(colors[3]) == tuple(colors[4]) == rgb(VIRIDIS[-1])


def test_scale_without_extent_has_one_colour() -> None:
    assert np.ptp(value_colors(np.zeros((3, 5)), 0.0, 0.0), axis=(0, 1)).max() == 0
