"""The picture of a moment of a run: what is drawn, by its pixels."""

import io

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from app.stage.playback import Replays
from hexapods.drawing.colormap import rgb
from hexapods.exports.export_format import StagePicture
from hexapods.exports.stage_picture import in_ascii, stage_picture
from tests.stage.stage_parts import StageParts


def pixels_of(picture: StagePicture) -> NDArray[np.uint8]:
    return np.asarray(Image.open(io.BytesIO(picture.png)).convert("RGB"))


def columns_of(pixels: NDArray[np.uint8], color: str) -> NDArray[np.intp]:
    """Return the columns that have pixels with the hue of a colour, however they are lit."""
    wanted, flat = np.array(rgb(color), float), pixels.astype(float)
    lengths = np.linalg.norm(flat, axis=2) * np.linalg.norm(wanted)
    return np.flatnonzero((flat @ wanted > 0.995 * lengths).any(axis=0))


def test_robots_stand_on_their_lanes_in_their_colours(parts: StageParts) -> None:
    run = parts.finished_race(("greedy", "wave"))
    replay = Replays(parts.store, parts.recordings).get(run.id, "paper")
    picture = stage_picture(replay)
    pixels = pixels_of(picture)
    left, right = (columns_of(pixels, lane.color) for lane in replay.show.spec.lane_specs)

    assert pixels.shape == (450, 800, 3)
    assert min(len(left), len(right)) > 100
    assert np.median(left) + 200 < np.median(right)
    assert "Greedy 0." in picture.description
    assert stage_picture(replay) == picture


def test_a_training_is_shown_at_its_end(parts: StageParts) -> None:
    run = parts.finished_training(steps=30)
    picture = stage_picture(Replays(parts.store, parts.recordings).get(run.id, "free"))

    assert picture.description.startswith("At the end: Q-learning ")
    assert len(np.unique(pixels_of(picture).reshape(-1, 3), axis=0)) > 100


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("Q-learning, α\u00a00.3", "Q-learning, alpha 0.3"),
        ("Élodie", "Elodie"),
        ("−0.01\u00a0m", "-0.01 m"),
        ("走", "?"),
    ],
)
def test_names_have_letters_that_every_machine_can_draw(name: str, written: str) -> None:
    assert in_ascii(name) == written
