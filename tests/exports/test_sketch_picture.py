"""The picture of a robot's file: what is drawn, by its pixels."""

import io
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from hexapods.drawing.colormap import rgb
from hexapods.drawing.sketch import GROUP_COLORS
from hexapods.exports.sketch_picture import sketch_png
from hexapods.imports.choices import AS_FOUND
from hexapods.imports.compiling import silence_mujoco
from hexapods.imports.imported import Sketch
from hexapods.imports.reading import read_in_this_process
from tests.imports.robots import FOUR, HOME, dog

pytestmark = pytest.mark.promises

TROT = ((1, 3), (2, 4))
ORANGE = "#ffb020"


def sketch(text: str) -> Sketch:
    silence_mujoco()
    return read_in_this_process(text.encode(), "dog.xml", AS_FOUND).sketch


def drawn(of: Sketch, groups: tuple[tuple[int, ...], ...] = ()) -> NDArray[np.uint8]:
    png = sketch_png(of, groups, width=640, height=400)
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def share_of(picture: NDArray[np.uint8], color: str) -> float:
    """Return the share of pixels with the hue of a colour, however they are lit."""
    wanted, pixels = np.array(rgb(color), float), picture.reshape(-1, 3).astype(float)
    lengths = np.linalg.norm(pixels, axis=1) * np.linalg.norm(wanted)
    return float((pixels @ wanted > 0.985 * lengths).mean())


def test_groups_have_their_colours_and_feet_are_marked() -> None:
    spot = sketch(dog(keyframes={"home": HOME}))

    picture = drawn(spot, TROT)

    assert picture.shape == (400, 640, 3)
    assert all(share_of(picture, color) > 0.002 for color in GROUP_COLORS[:2])
    assert share_of(picture, ORANGE) > 0.001
    assert share_of(drawn(spot), GROUP_COLORS[1]) < 0.001, "without groups all have one colour"


def test_what_has_no_legs_is_drawn_with_possible_feet() -> None:
    two = sketch(dog({leg: FOUR[leg] for leg in ("FL", "FR")}))

    picture = drawn(two)

    assert share_of(picture, ORANGE) > 0.001
    assert share_of(picture, GROUP_COLORS[0]) < 0.001


def test_a_robot_of_any_size_fills_the_picture() -> None:
    spot = sketch(dog(keyframes={"home": HOME}))

    def filled(of: Sketch) -> float:
        picture = drawn(of, TROT).astype(int)
        return float((np.abs(picture - picture[0, 0]).sum(axis=2) > 20).mean())

    feet = [
        replace(foot, at_m=(10 * foot.at_m[0], 10 * foot.at_m[1], 10 * foot.at_m[2]))
        for foot in spot.feet
    ]
    large = Sketch((), tuple(replace(foot, radius_m=10 * foot.radius_m) for foot in feet))
    small = Sketch((), spot.feet)
    assert filled(large) == pytest.approx(filled(small), rel=0.02)
    assert filled(spot) > 0.25
