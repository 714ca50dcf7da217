"""What is painted on a lane: the chequered finish, marks with distances, a tint that fades out."""

import numpy as np
import pytest
from numpy.typing import NDArray

from hexapods.drawing.colormap import rgb
from hexapods.drawing.lane_marks import distance_marks, distances, finish_line, start_line, tint
from hexapods.runs.clocks import FINISH_LINE_M
from tests.drawing.test_glb import array, read

WIDTH_M = 0.62


def painted(glb: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Return vertices, (v, 3) [m], and their colours, (v, 4)."""
    description, binary = read(glb)
    return array(description, binary, 0), array(description, binary, 1)


def test_finish_is_chequered_across_the_lane_and_goes_on_in_the_next() -> None:
    vertices, colors = painted(finish_line(WIDTH_M))
    corners = vertices[colors[:, 0] < 100].reshape(-1, 4, 3)
    centers = corners.mean(axis=1)
    rows = np.unique(centers[:, 1].round(4))
    side = np.ptp(corners[0, :, 0])

    assert len(rows) == 3
    assert vertices[:, 0].min() == pytest.approx(-WIDTH_M / 2)
    assert vertices[:, 0].max() == pytest.approx(WIDTH_M / 2)
    for number, row in enumerate(rows):
        xs = np.sort(centers[centers[:, 1].round(4) == row, 0])
        assert np.diff(xs) == pytest.approx(2 * side, abs=1e-6), "each second square"
        assert xs[0] == pytest.approx(-WIDTH_M / 2 + (number % 2 + 0.5) * side, abs=1e-6)
        assert (xs[0] + WIDTH_M) - xs[-1] == pytest.approx(2 * side, abs=1e-5), "over the border"


def test_start_is_green_on_white() -> None:
    vertices, colors = painted(start_line(WIDTH_M))
    green = colors[:, 1] > 2 * colors[:, 0].astype(int)

    assert green.sum() == 4
    assert np.abs(vertices[green, 1]).max() < np.abs(vertices[~green, 1]).max()
    assert vertices[green, 2].min() > vertices[~green, 2].max()


def test_marks_leave_the_lines_free_and_are_longer_each_ten_centimetres() -> None:
    vertices, _ = painted(distance_marks(WIDTH_M))
    quads = vertices.reshape(-1, 4, 3)
    middles, widths = quads.mean(axis=1), np.ptp(quads[..., 0], axis=1)
    is_long = np.isclose(widths, 0.05, atol=1e-4)
    ys = np.sort(middles[is_long, 1])

    assert np.diff(ys[ys > 0]) == pytest.approx(0.1, abs=1e-5)
    assert 0.5 in ys.round(5)
    assert not np.isclose(middles[:, 1], FINISH_LINE_M, atol=0.02).any()
    assert (vertices[:, 0] >= -WIDTH_M / 2).all()
    assert np.abs(vertices[:, 0]).max() < WIDTH_M / 2


@pytest.mark.parametrize("from_front", [False, True])
def test_distances_are_beside_the_longer_marks_and_leave_the_lines_free(from_front: bool) -> None:
    vertices, _ = painted(distances(WIDTH_M, from_front=from_front))
    middles = vertices.reshape(-1, 4, 3).mean(axis=1)
    near = middles[np.abs(middles[:, 1] - 0.2) < 0.03]

    assert len(near) == 6 + 1 + 5, "0.2 in segments"
    assert np.abs(vertices[:, 1] % 0.1 - 0.05).min() > 0.029, "as high as 0.04 m"
    assert vertices[:, 0].min() > -WIDTH_M / 2 + 0.06
    assert vertices[:, 0].max() < 0
    assert not (np.abs(vertices[:, 1]) < 0.04).any()
    assert not (np.abs(vertices[:, 1] - FINISH_LINE_M) < 0.03).any()


def test_distances_from_the_front_are_those_from_behind_turned_in_their_places() -> None:
    behind, front = (painted(distances(WIDTH_M, from_front=side))[0] for side in (False, True))
    for y in (0.1, 0.7, 1.2):
        numbers = [vertices[np.abs(vertices[:, 1] - y) < 0.04] for vertices in (behind, front)]
        low, high = numbers[0].min(axis=0), numbers[0].max(axis=0)
        turned = (low + high)[:2] - numbers[1][:, :2]

        assert turned == pytest.approx(numbers[0][:, :2], abs=1e-6)


def test_tint_is_pale_in_the_agents_hue_and_fades_out_at_both_ends() -> None:
    vertices, colors = painted(tint(WIDTH_M, rgb("#0072B2")))
    first, last = vertices[:, 1].argsort()[[0, -1]]

    assert colors[first, 3] == colors[last, 3] == 0
    assert colors[:, 3].max() == 255
    assert colors[0, 0] < colors[0, 1] < colors[0, 2], "blue"
    assert colors[0, :3].min() > 128, "pale"
