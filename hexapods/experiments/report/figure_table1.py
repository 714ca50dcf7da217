"""The figure of Table 1: every seed of every setting, with greedy and the printed number."""

from collections.abc import Mapping, Sequence
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.text import counted, metres
from hexapods.experiments.claims.cases import Case
from hexapods.experiments.labels import gait_name, gait_name_with_papers
from hexapods.experiments.report.drawing import (
    INK,
    MUTED,
    PAPER,
    THIN,
    Picture,
    agent_colours,
    figure,
    jitter,
    style_axes,
)
from hexapods.extras import needs

with needs("experiments", "the report of an experiment"):
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Setting = Mapping[str, Any]
PANEL_IN = (4.7, 4.6)
_ROW, _HEAD, _GAP = 1.0, 0.85, 0.35
_POINTS = 0.28
"""Vertical jitter of the points about their row."""


def panels(cases: Sequence[Case]) -> list[Picture]:
    """Draw one picture per case."""
    pictures = []
    limits = _limits(cases)
    for number, case in enumerate(cases):
        one = figure(*_size(case))
        draw(one.subplots(), case, limits)
        pictures.append(Picture(f"table1-{number + 1}", case.label, _alt(case), one))
    return pictures


def sheet(cases: Sequence[Case]) -> Picture:
    """Draw all cases on one sheet, in two columns."""
    columns = min(2, len(cases))
    rows = -(-len(cases) // columns)
    width, height = _size(cases[0])
    one = figure(columns * width, rows * height + 0.5)
    axes = one.subplots(rows, columns, squeeze=False).ravel()
    limits = _limits(cases)
    for ax, case in zip(axes, cases, strict=False):
        draw(ax, case, limits)
        ax.set_title(case.label[:1].upper() + case.label[1:], pad=10)
    for ax in axes[len(cases) :]:
        ax.set_visible(False)
    one.get_layout_engine().set(hspace=0.05, wspace=0.04)  # type: ignore[union-attr,call-arg]
    _key(one)
    alt = " ".join(_alt(case) for case in cases)
    return Picture("table1", "Total distance, every seed", alt, one)


def draw(ax: Axes, case: Case, limits: tuple[float, float]) -> None:
    """Draw a block of rows for each gait, from top to bottom."""
    learners = [one for one in case.settings if one["role"] == "learner"]
    colour = agent_colours([one["agent"] for one in learners])
    y, ticks, names = 0.0, [], []
    for gait in dict.fromkeys(one["gait"] for one in learners):
        rows = [one for one in learners if one["gait"] == gait]
        ax.text(0, y, gait_name_with_papers(gait), va="center", weight="bold", color=INK)
        bottom = y - _HEAD - _ROW * (len(rows) - 1)
        _greedy(ax, case.setting(gait, 0, "greedy"), y - 0.35, bottom - 0.45)
        _best_known(ax, rows[0], y - 0.35, bottom - 0.45)
        for place, one in enumerate(rows):
            at = y - _HEAD - _ROW * place
            ticks.append(at)
            names.append(f"{one['steps']:,} steps")
            _row(ax, one, at, colour[one["agent"]])
        y = bottom - _ROW - _GAP
    ax.set_yticks(ticks, names)
    ax.set_ylim(y + 0.3, 0.5)
    ax.set_xlim(*limits)
    ax.set_xlabel("distance in 50 steps [m]")
    style_axes(ax, "x")


def _row(ax: Axes, one: Setting, at: float, colour: str) -> None:
    distances = one["total"]
    if distances is not None:
        points = sorted(distances["points_m"])
        heights = [at + off for off in jitter(len(points), _POINTS)]
        ax.plot(points, heights, "o", ms=4, mew=0, color=colour, alpha=0.55)
        if distances["low_m"] is not None:
            ax.plot([distances["low_m"], distances["high_m"]], [at, at], color=INK, lw=2.2)
        ax.plot([distances["iqm_m"]], [at], "o", ms=5.5, color=INK)
    if one["published"] and one["published"]["total_m"] is not None:
        ax.plot([one["published"]["total_m"]], [at], "D", ms=7.5, mfc=PAPER, mec=INK, mew=1.4)


def _best_known(ax: Axes, one: Setting, top: float, bottom: float) -> None:
    if one["best_known_m"] is not None:
        ax.plot([one["best_known_m"]] * 2, [bottom, top], color=INK, lw=THIN, zorder=3)


def _greedy(ax: Axes, greedy: Setting | None, top: float, bottom: float) -> None:
    if greedy is None:
        return
    blue = agent_colours([])["greedy"]
    ax.plot([greedy["total"]["iqm_m"]] * 2, [bottom, top], color=blue, lw=2.4)
    if greedy["finished"] is not None:
        ax.plot(
            [greedy["finished"]["iqm_m"]] * 2, [bottom, top], color=blue, lw=1.8, ls=(0, (2, 2))
        )


def key_lines() -> list[Line2D]:
    """Return the legend's entries."""
    blue, orange = agent_colours([])["greedy"], agent_colours([])["q-learning"]
    return [
        Line2D([], [], ls="", marker="o", ms=5, mew=0, color=orange, label="a seed of Q-learning"),
        Line2D([], [], color=INK, lw=2.2, marker="o", ms=5.5, label="middle, 95 % interval"),
        Line2D([], [], ls="", marker="D", ms=7, mfc=PAPER, mec=INK, label="printed in the paper"),
        Line2D([], [], color=blue, lw=2.4, label="greedy, 50 steps"),
        Line2D([], [], color=blue, lw=1.8, ls=(0, (2, 2)), label="greedy, when Q-learning ends"),
        Line2D([], [], color=INK, lw=THIN, label="best known, 50 steps"),
    ]


def _key(one: Figure) -> None:
    one.legend(handles=key_lines(), loc="outside lower center", ncols=3, labelcolor=MUTED)


def _size(case: Case) -> tuple[float, float]:
    gaits = {one["gait"] for one in case.settings}
    rows = sum(one["role"] == "learner" for one in case.settings)
    return PANEL_IN[0], 0.8 + 0.3 * (rows + len(gaits) * (_HEAD + _GAP))


def _limits(cases: Sequence[Case]) -> tuple[float, float]:
    """Return the common limits of the distance axes [m], which include zero."""
    totals = [s["total"] for case in cases for s in case.settings if s["total"]]
    points = [point for one in totals for point in one["points_m"]] or [0.5]
    points += [s["best_known_m"] for case in cases for s in case.settings if s["best_known_m"]]
    return min(0.0, *points) - 0.015, max(0.05, *points) * 1.04


def _alt(case: Case) -> str:
    sentences = [
        f"{gait_name(one['gait'])}, {title_of(one['agent'])} after {one['steps']:,} steps: "
        f"{counted(one['n'], 'seed')} from {metres(min(one['total']['points_m']))} to "
        f"{metres(max(one['total']['points_m']))}, middle {metres(one['total']['iqm_m'])}."
        for one in case.settings
        if one["role"] == "learner" and one["total"]
    ]
    best_m = {one["gait"]: one["best_known_m"] for one in case.settings if one["best_known_m"]}
    if sentences:
        sentences += [
            f"{gait_name(gait)}, best known {metres(far)}." for gait, far in best_m.items()
        ]
    return f"Distances with {case.label}. {' '.join(sentences) or 'No trials yet.'}"
