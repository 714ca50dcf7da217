"""What is painted on a lane: its agent's tint, distances from the start line, start and finish.

All are meshes of one lane, with its centre line at x = 0 and the start line at y = 0.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.types import FloatArray
from hexapods.drawing.colormap import Rgb, mix
from hexapods.drawing.glb import unlit_glb
from hexapods.drawing.shapes import Shape, joined, strip
from hexapods.runs.clocks import FINISH_LINE_M

BEFORE_M, BEYOND_M = -0.5, 2.0
"""Start and end of the lanes along the track."""
BORDER_M = 0.03
"""Width at the borders of a lane where its ground is always seen."""
_GAP_M = 0.02
"""Between the tints of two lanes."""
_FADES_M = (0.35, 0.8)
"""Over how much the tint of a lane fades out before its start and towards its end."""
_TINT = 0.14
"""Share of the agent's colour in the tint, the rest is white."""
_STEP_M, _SHORT_M, _LONG_M, _THIN_M = 0.05, 0.03, 0.05, 0.003
"""Distance between marks, lengths of them and of each second, and their width."""
_DIGIT_M = (0.024, 0.04, 0.005)
"""Width, height and width of the strokes of a digit."""
_SPACE_M = 0.01
_HALF_TURN: FloatArray = np.diag([-1.0, -1.0, 1.0])
"""Rotation about the vertical."""
_FREE_M = 0.06
"""Distance from start and finish line within which there are no digits."""
_MARKED_M = (-0.15, 1.6)
"""Where the first and last marks are at most."""
_WHITE: Rgb = (255, 255, 255)
_BLACK: Rgb = (16, 18, 22)
_GREEN: Rgb = (0, 150, 64)
_START_M, _GREEN_M = 0.03, 0.012
"""Widths of the start line, and of the green on it."""
_ROWS, _SQUARE_M = 3, 0.031
_OVER_M = 0.0006
"""Height of a colour over the one below, against z-fighting."""
_SEGMENTS = "abcdefg"
"""Of a digit with seven of them: clockwise from the top, then the middle."""
_DIGITS = ("abcdef", "bc", "abdeg", "abcdg", "bcfg", "acdfg", "acdefg", "abc", _SEGMENTS, "abcdfg")


def tint(width_m: float, color: Rgb) -> NDArray[np.uint8]:
    """Return a lane in the tint of its agent, as GLB, which fades out at both ends."""
    half = (width_m - _GAP_M) / 2
    rows = np.array([BEFORE_M, BEFORE_M + _FADES_M[0], BEYOND_M - _FADES_M[1], BEYOND_M])
    vertices = np.array([[x, y, 0.0] for y in rows for x in (-half, half)], np.float32)
    first = [[corner, corner + 1, corner + 3] for corner in (0, 2, 4)]
    second = [[corner, corner + 3, corner + 2] for corner in (0, 2, 4)]
    faces = np.array(first + second, np.uint32)
    opacities = np.repeat([0.0, 1.0, 1.0, 0.0], 2)
    white = (255, 255, 255)
    return unlit_glb(
        Shape(vertices, faces), np.array(mix(white, color, _TINT), np.uint8), opacities
    )


def distance_marks(width_m: float) -> NDArray[np.uint8]:
    """Return the marks at the left border of a lane, as GLB, longer ones each 0.1 m.

    They are white: `static/viewer/light.js` gives them a colour of the theme.
    """
    left = -(width_m - _GAP_M) / 2
    lengths = {y: _LONG_M if is_long else _SHORT_M for y, is_long in _marked()}
    shapes = [_at(strip(length, _THIN_M), left + length / 2, y) for y, length in lengths.items()]
    return unlit_glb(joined(shapes), np.array(_WHITE, np.uint8))


def distances(width_m: float, *, from_front: bool = False) -> NDArray[np.uint8]:
    """Return the distances beside the longer marks of a lane [m], as GLB, white as these.

    Args:
        width_m: width of the lane [m].
        from_front: whether they are readable for who looks towards the start line, in place of
            those who look along the track.
    """
    x, shapes = -(width_m - _GAP_M) / 2 + _LONG_M + _SPACE_M, []
    for y, is_long in _marked():
        is_free = min(abs(y), abs(y - FINISH_LINE_M)) > _FREE_M
        if is_long and y > 0 and is_free:
            number = _number(f"{y:.1f}")
            if from_front:
                xs = number.vertices[:, 0]
                number = number.moved(_HALF_TURN, np.array([xs.min() + xs.max(), 0.0, 0.0]))
            shapes.append(_at(number, x, y))
    return unlit_glb(joined(shapes), np.array(_WHITE, np.uint8))


def _marked() -> Iterator[tuple[float, bool]]:
    """Yield where marks are along the track [m], and whether each is a longer one."""
    first, last = (round(end_m / _STEP_M) for end_m in _MARKED_M)
    for number in range(first, last + 1):
        y = round(number * _STEP_M, 9)
        if y not in (0.0, FINISH_LINE_M):
            yield y, number % 2 == 0


def start_line(width_m: float) -> NDArray[np.uint8]:
    """Return the start line across a lane, as GLB: green on white."""
    white, green = strip(width_m, _START_M), strip(width_m, _GREEN_M)
    return _two_colored([white], _WHITE, [_at(green, 0.0, 0.0)], _GREEN)


def finish_line(width_m: float) -> NDArray[np.uint8]:
    """Return the finish line across a lane, as GLB: chequered, in rows that go on in the next."""
    count = 2 * round(width_m / _SQUARE_M / 2)
    side = width_m / count
    black = [
        _at(strip(side, _SQUARE_M), (n + 0.5) * side - width_m / 2, (row - 1) * _SQUARE_M)
        for row in range(_ROWS)
        for n in range(row % 2, count, 2)
    ]
    return _two_colored([strip(width_m, _ROWS * _SQUARE_M)], _WHITE, black, _BLACK)


def _number(text: str) -> Shape:
    """Return a number such as `0.5`, readable towards +y, from x = 0 to the right [m]."""
    width, height, stroke = _DIGIT_M
    shapes, x = [], 0.0
    for letter in text:
        if letter == ".":
            shapes.append(_at(strip(stroke, stroke), x + stroke / 2, (stroke - height) / 2))
            x += stroke + _SPACE_M / 2
        else:
            shapes.append(_at(_digit(int(letter)), x + width / 2, 0.0))
            x += width + _SPACE_M / 2
    return joined(shapes)


def _digit(digit: int) -> Shape:
    """Return a digit of seven segments, centred on the origin."""
    width, height, stroke = _DIGIT_M
    side, tall = (width - stroke) / 2, (height - stroke) / 2
    across, upright = strip(width, stroke), strip(stroke, height / 2)
    places: dict[str, tuple[Shape, float, float]] = {
        "a": (across, 0.0, tall),
        "b": (upright, side, height / 4),
        "c": (upright, side, -height / 4),
        "d": (across, 0.0, -tall),
        "e": (upright, -side, -height / 4),
        "f": (upright, -side, height / 4),
        "g": (across, 0.0, 0.0),
    }
    return joined([_at(*places[segment]) for segment in _DIGITS[digit]])


def _at(shape: Shape, x: float, y: float) -> Shape:
    return shape.moved(np.eye(3), np.array([x, y, 0.0]))


def _two_colored(
    below: list[Shape], color: Rgb, above: list[Shape], color_above: Rgb
) -> NDArray[np.uint8]:
    """Return shapes in two colours, the second over the first."""
    up: FloatArray = np.array([0.0, 0.0, _OVER_M])
    first, second = joined(below), joined(above).moved(np.eye(3), up)
    colors = np.repeat(
        np.array([color, color_above], np.uint8),
        [len(first.vertices), len(second.vertices)],
        axis=0,
    )
    return unlit_glb(joined([first, second]), colors)
