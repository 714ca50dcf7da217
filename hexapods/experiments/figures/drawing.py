"""Draws a figure for a paper by Matplotlib. The same content gives the same bytes."""

import io
import logging
import textwrap
import threading
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hexapods.experiments.figures.content import FigureContent, Row
from hexapods.experiments.figures.style import (
    DIM,
    FAINT,
    INK,
    LINES,
    MM,
    PNG_DPI,
    RC,
    SMALL_PT,
    WIDTHS_MM,
)
from hexapods.experiments.profiles import Profile, band_beyond
from hexapods.experiments.statistics import Interval
from hexapods.extras import needs

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ENDINGS = ("pdf", "svg", "png")
_METADATA: Mapping[str, Mapping[str, Any]] = {
    "pdf": {"CreationDate": None, "Creator": "racing-hexapods"},
    "svg": {"Date": None, "Creator": "racing-hexapods"},
    "png": {"Software": "racing-hexapods"},
}
_STRIP_MM = 8.8
"""Height of a setting's dots, mean and interval, without its name."""
_LINE_MM = 3.0
"""Height of a line of text."""
_CHAR_MM = 1.45
"""Width of a character of small text, at most on average."""
_TOP_MM, _DOTS_MM, _TYPICAL_MM = 0.8, 5.2, 1.8
"""Of the name from the top of a row; of dots, and of the mean, from its bottom."""
_DOT_PT = 2.6
_MM_PER_PT = 25.4 / 72
_LANE_MM = 0.95
"""Distance of dots that lie above each other."""
_LANES = (0, 1, -1, 2, -2)
_AXIS_MM = 11.0
_PROFILE_MM = 50.0
_MARGIN_MM = 3.0
_Y_AXIS_MM = 16.0
_MARKERS = 5
"""Markers on a profile, besides its dashes."""
_LOCK = threading.Lock()
"""Settings of Matplotlib are global."""
logging.getLogger("fontTools").setLevel(logging.WARNING)
"""For each PDF, Matplotlib has it embed fonts, and it tells each table of them as information."""


def draw(content: FigureContent) -> dict[str, bytes]:
    """Return the pictures by the endings of their files.

    Raises:
        MissingExtra: if Matplotlib is not installed.
    """
    with needs("figures", "a figure for a paper"):
        import matplotlib as mpl  # noqa: PLC0415 - an extra
        from matplotlib.figure import Figure  # noqa: PLC0415
    with _LOCK, mpl.rc_context(RC):
        figure = Figure()
        width_mm = WIDTHS_MM[content.config.columns]
        if content.config.kind == "profile":
            _draw_profiles(figure, content, width_mm)
        else:
            _draw_seeds(figure, content, width_mm)
        return {ending: _encoded(figure, ending, content.axis_title) for ending in ENDINGS}


def _encoded(figure: "Figure", ending: str, title: str) -> bytes:
    out = io.BytesIO()
    metadata = {**_METADATA[ending], "Title": title}
    figure.savefig(out, format=ending, dpi=PNG_DPI, metadata=metadata)
    return out.getvalue()


def _axes(
    figure: "Figure", *, left_mm: float, bottom_mm: float, width_mm: float, height_mm: float
) -> "Axes":
    """Return axes at a place of the figure."""
    full_width, full_height = figure.get_size_inches()
    return figure.add_axes(
        (
            left_mm * MM / full_width,
            bottom_mm * MM / full_height,
            width_mm * MM / full_width,
            height_mm * MM / full_height,
        )
    )


# ---- seeds


def _draw_seeds(figure: "Figure", content: FigureContent, width_mm: float) -> None:
    rows, comparison = content.rows, content.comparison
    inner_mm = width_mm - 2 * _MARGIN_MM
    names = [_wrapped(_name_with_seeds(row), inner_mm) for row in rows]
    row_mm = _STRIP_MM + _LINE_MM * max(1 + name.count("\n") for name in names)
    difference = "" if comparison is None else f"{comparison.a.name} minus {comparison.b.name}"
    difference = _wrapped(difference, inner_mm)
    difference_mm = _STRIP_MM / 2 + _LINE_MM * (1 + difference.count("\n"))
    below_mm = _AXIS_MM + (0 if comparison is None else difference_mm + _AXIS_MM)
    height_mm = len(rows) * row_mm
    figure.set_size_inches(width_mm * MM, (height_mm + below_mm + _MARGIN_MM) * MM)
    axes = _axes(
        figure, left_mm=_MARGIN_MM, bottom_mm=below_mm, width_mm=inner_mm, height_mm=height_mm
    )
    low, high = _span([value for row in rows for value in row.group.points], content.best_known)
    _style_strip(axes, content.axis_title, low, high, height_mm)
    if content.best_known is not None:
        _draw_best_known(axes, content.best_known)
    for place, (row, name) in enumerate(zip(rows, names, strict=True)):
        bottom_mm = height_mm - (place + 1) * row_mm
        if place:
            axes.axhline(bottom_mm + row_mm, color=FAINT, linewidth=0.4, zorder=0)
        _write(axes, name, bottom_mm + row_mm - _TOP_MM)
        _draw_row(axes, row, bottom_mm, (high - low) / inner_mm)
    if comparison is not None:
        below = _axes(
            figure,
            left_mm=_MARGIN_MM,
            bottom_mm=_AXIS_MM,
            width_mm=inner_mm,
            height_mm=difference_mm,
        )
        ends = [limit for limit in comparison.difference if limit is not None]
        title = f"Difference ({content.axis_title.partition('(')[2]}"
        _style_strip(below, title, *_span(ends, None), difference_mm)
        below.axvline(0, color=DIM, linewidth=0.6, dashes=(4, 2), zorder=0)
        _draw_typical(below, comparison.difference, _TYPICAL_MM)
        _write(below, difference, difference_mm - _TOP_MM)


def _wrapped(name: str, width_mm: float) -> str:
    """Return a name in lines that fit into a width."""
    return "\n".join(textwrap.wrap(name, int(width_mm / _CHAR_MM)))


def _write(axes: "Axes", text: str, top_mm: float) -> None:
    """Write small text at the left, below a height in a strip; a line behind it is interrupted."""
    axes.annotate(
        text,
        (0, top_mm),
        xycoords=("axes fraction", "data"),
        va="top",
        fontsize=SMALL_PT,
        linespacing=1.15,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3},
    )


def _span(values: Sequence[float], more: float | None) -> tuple[float, float]:
    """Return where an axis begins and ends: at 0 if all values are positive."""
    every = [*values, *([] if more is None else [more])]
    least, most = min(0.0, *every), max(0.0, *every)
    margin = 0.03 * (most - least or 1.0)
    return least - margin, most + margin


def _style_strip(axes: "Axes", title: str, low: float, high: float, height_mm: float) -> None:
    """Set the axes of strips: distances across, and millimetres up."""
    axes.set_xlim(low, high)
    axes.set_ylim(0, height_mm)
    axes.set_xlabel(title)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)


def _draw_best_known(axes: "Axes", distance: float) -> None:
    axes.axvline(distance, color=DIM, linewidth=0.6, dashes=(4, 2), zorder=0)
    axes.annotate(
        "best known ",
        (distance, 1),
        xycoords=("data", "axes fraction"),
        ha="right",
        va="top",
        fontsize=SMALL_PT,
        color=DIM,
    )


def _draw_row(axes: "Axes", row: Row, bottom_mm: float, units_per_mm: float) -> None:
    """Draw the seeds of a setting, and below them their interquartile mean and interval."""
    middle_mm = bottom_mm + _DOTS_MM
    if row.group.is_deterministic:
        axes.plot([row.typical.value], [middle_mm], marker="D", markersize=4, color=INK)
        return
    apart = 1.1 * _DOT_PT * _MM_PER_PT * units_per_mm
    points = sorted(row.group.points)
    axes.plot(
        points,
        [middle_mm + lane * _LANE_MM for lane in _swarm(points, apart)],
        linestyle="none",
        marker="o",
        markersize=_DOT_PT,
        markerfacecolor="none",
        markeredgecolor=DIM,
        markeredgewidth=0.5,
    )
    _draw_typical(axes, row.typical, bottom_mm + _TYPICAL_MM)


def _name_with_seeds(row: Row) -> str:
    seeds = "" if row.group.is_deterministic else f" (n = {len(row.group.points):,})"
    return f"{row.group.name}{seeds}"


def _swarm(ascending: Sequence[float], apart: float) -> list[int]:
    """Return a lane for each of ascending points, so that dots in one lane do not overlap."""
    last = dict.fromkeys(_LANES, float("-inf"))
    lanes = []
    for value in ascending:
        free = (lane for lane in _LANES if value - last[lane] >= apart)
        lane = next(free, min(_LANES, key=lambda lane: last[lane]))
        last[lane] = value
        lanes.append(lane)
    return lanes


def _draw_typical(axes: "Axes", typical: Interval, y: float) -> None:
    value, low, high = typical
    if low is not None and high is not None:
        axes.plot([low, high], [y, y], color=INK, linewidth=1.6, solid_capstyle="butt")
    axes.plot([value], [y], marker="|", markersize=7, markeredgewidth=1.4, color=INK)


# ---- performance profiles


def _draw_profiles(figure: "Figure", content: FigureContent, width_mm: float) -> None:
    profiles = content.profiles
    names = [
        _wrapped(_name_with_seeds(row), width_mm - _Y_AXIS_MM - 2 * _MARGIN_MM)
        for row in content.rows
    ]
    legend_mm = 1.2 * _LINE_MM * sum(1 + name.count("\n") for name in names)  # whole numbers
    height_mm = _PROFILE_MM + legend_mm + _AXIS_MM + 2 * _MARGIN_MM
    figure.set_size_inches(width_mm * MM, height_mm * MM)
    axes = _axes(
        figure,
        left_mm=_Y_AXIS_MM,
        bottom_mm=_AXIS_MM,
        width_mm=width_mm - _Y_AXIS_MM - _MARGIN_MM,
        height_mm=_PROFILE_MM,
    )
    low, high = _span([at for profile in profiles for at in profile.at], None)
    axes.set_xlim(low, high)
    axes.set_ylim(-0.02, 1.02)
    axes.set_xlabel(f"{content.axis_title.replace('Distance', 'Distance τ', 1)}")
    axes.set_ylabel("Share of seeds that reach τ")
    axes.set_yticks([0, 0.25, 0.5, 0.75, 1], ["0", "25 %", "50 %", "75 %", "100 %"])
    for row, name, profile, style in zip(content.rows, names, profiles, LINES, strict=False):
        xs, ys = [low, *profile.at, high], [profile.share[0], *profile.share, 0.0]
        _draw_band(axes, row, profile, xs, style.color)
        [line] = axes.step(
            xs,
            ys,
            where="pre",
            color=style.color,
            marker=style.marker,
            markersize=3,
            markevery=(1, max(1, len(xs) // _MARKERS)),
            label=name,
        )
        if style.dashes:
            line.set_dashes(style.dashes)
    figure.legend(
        loc="upper left",
        bbox_to_anchor=(_MARGIN_MM / width_mm, 1 - 0.5 * _MARGIN_MM / height_mm),
        frameon=False,
        borderpad=0,
        borderaxespad=0,
        handlelength=4,
        labelspacing=0.35,
    )


def _draw_band(axes: "Axes", row: Row, profile: Profile, xs: Sequence[float], color: str) -> None:
    beyond = band_beyond(row.group)
    if profile.low[0] is None or beyond is None:
        return
    lows = [profile.low[0], *profile.low, 0.0]
    highs = [profile.high[0], *profile.high, beyond]
    axes.fill_between(
        xs,
        [0.0 if low is None else low for low in lows],
        [1.0 if high is None else high for high in highs],
        step="pre",
        color=color,
        alpha=0.15,
        linewidth=0,
    )
