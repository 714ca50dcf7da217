"""The figure of Figure 4: learning curves of all seeds, their interquartile mean and interval."""

from collections.abc import Mapping, Sequence
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.text import metres
from hexapods.experiments.claims.cases import Case
from hexapods.experiments.labels import gait_name
from hexapods.experiments.report.drawing import (
    INK,
    MUTED,
    THIN,
    Picture,
    agent_colours,
    draw_best_known,
    figure,
    style_axes,
)
from hexapods.extras import needs

with needs("experiments", "the report of an experiment"):
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

Curve = Mapping[str, Any]
PANEL_IN = (3.0, 2.7)


def panels(case: Case, highest_m: float, name: str) -> list[Picture]:
    """Draw one picture per gait."""
    pictures = []
    for number, gait in enumerate(_gaits(case)):
        one = figure(*PANEL_IN)
        ax = one.subplots()
        draw(ax, case, gait, highest_m)
        ax.set_title(gait_name(gait), pad=12)
        pictures.append(Picture(f"{name}-{number + 1}", gait_name(gait), _alt(case, gait), one))
    return pictures


def sheet(cases: Sequence[Case]) -> Picture:
    """Draw one sheet, with a row of gaits for each case."""
    columns = max(len(_gaits(case)) for case in cases)
    width, height = PANEL_IN
    one = figure(columns * width * 0.85, len(cases) * height + 0.9)
    rows = one.subfigures(len(cases), 1, squeeze=False).ravel()
    limit = highest(cases)
    for row, case in zip(rows, cases, strict=True):
        row.suptitle(
            case.label[:1].upper() + case.label[1:], x=0.01, ha="left", weight="bold", color=INK
        )
        axes = row.subplots(1, columns, squeeze=False, sharey=True).ravel()
        for ax, gait in zip(axes, _gaits(case), strict=False):
            draw(ax, case, gait, limit)
            ax.set_title(gait_name(gait), size=10, weight="normal", pad=12)
            if ax is not axes[0]:
                ax.set_ylabel("")
    _key(one, cases)
    alt = " ".join(_alt(case, gait) for case in cases for gait in _gaits(case))
    return Picture("figure4", "Distance against practice", alt, one)


IN_ONE_GO = (0, (1.5, 1.5))
"""Dashes of a practice in one go, shorter than those of greedy's line."""


def highest(cases: Sequence[Case]) -> float:
    """Return the common upper limit of the distance axes [m]."""
    references = [
        one[field]
        for case in cases
        for one in case.curves
        for field in ("greedy_m", "best_known_m")
        if one[field]
    ]
    points = [
        point
        for case in cases
        for one in (*case.curves, *case.in_one_go)
        for block in one["points_m"]
        for point in block
    ]
    return float(1.08 * max([0.05, *references, *points]))


def draw(ax: Axes, case: Case, gait: str, highest_m: float) -> None:
    """Draw the curves of all agents in one gait."""
    curves = [one for one in case.curves if one["gait"] == gait]
    colour = agent_colours([one["agent"] for one in curves])
    for one in curves:
        _curve(ax, one, colour[one["agent"]], alone=len(curves) == 1)
    for one in case.in_one_go:
        if one["gait"] == gait and one["steps"]:
            _one_go(ax, one, INK if len(curves) == 1 else colour[one["agent"]])
    greedy, best_known = (
        next((one[field] for one in curves if one[field]), None)
        for field in ("greedy_m", "best_known_m")
    )
    steps = max((one["steps"][-1] for one in curves if one["steps"]), default=2000)
    draw_best_known(ax, steps, best_known)
    if greedy is not None:
        ax.plot([0, steps], [greedy] * 2, color=agent_colours([])["greedy"], lw=2, ls=(0, (4, 2)))
        # Below its line, since the best known is above it; curves begin further down.
        ax.text(0, greedy - 0.02 * highest_m, "greedy", va="top", size=9, color=MUTED)
    ax.set_xlim(0, steps * 1.02)
    ax.set_ylim(min(0.0, *_lowest(curves)), highest_m)
    ax.set_xticks([0, steps / 2, steps], ["0", f"{steps // 2:,}", f"{steps:,}"])
    ax.set_xlabel("steps of practice")
    ax.set_ylabel("distance [m]")
    style_axes(ax, "y")


def _curve(ax: Axes, one: Curve, colour: str, alone: bool) -> None:
    if not one["steps"]:
        return
    faint = min(0.7, (9 if alone else 4) / len(one["points_m"][0]))
    for seed in zip(*one["points_m"], strict=True):
        ax.plot(one["steps"], seed, color=colour, lw=0.7, alpha=faint)
    if one["low_m"][0] is not None:
        ax.fill_between(one["steps"], one["low_m"], one["high_m"], color=colour, alpha=0.4, lw=0)
    ax.plot(one["steps"], one["iqm_m"], color=INK if alone else colour, lw=2, marker="o", ms=3.5)


def _one_go(ax: Axes, one: Curve, colour: str) -> None:
    """Draw a practice in one go: its middle, and its interval as bars, without its seeds."""
    ax.plot(one["steps"], one["iqm_m"], color=colour, lw=1.6, ls=IN_ONE_GO)
    if one["low_m"][0] is not None:
        below, above = (
            [abs(limit - middle) for limit, middle in zip(one[name], one["iqm_m"], strict=True)]
            for name in ("low_m", "high_m")
        )
        ax.errorbar(
            *(one["steps"], one["iqm_m"], [below, above]),
            fmt="none",
            ecolor=colour,
            elinewidth=0.8,
            capsize=2,
        )


def _lowest(curves: Sequence[Curve]) -> list[float]:
    return [0.0, *(min(block) * 1.1 for one in curves for block in one["points_m"])]


def _gaits(case: Case) -> list[str]:
    return list(dict.fromkeys(one["gait"] for one in case.curves))


def _key(one: Figure, cases: Sequence[Case]) -> None:
    agents = list(dict.fromkeys(c["agent"] for case in cases for c in case.curves))
    colour, alone = agent_colours(agents), len(agents) == 1
    handles: list[Any] = []
    for agent in agents:
        shade, name = colour[agent], title_of(agent)
        line = INK if alone else shade
        handles += [
            Line2D(
                [], [], color=line, lw=2, marker="o", ms=4, label=f"{name}, middle of the seeds"
            ),
            Patch(color=shade, alpha=0.4, lw=0, label="its 95 % interval"),
            Line2D([], [], color=shade, lw=0.9, alpha=0.6, label="one seed"),
        ]
    for agent in dict.fromkeys(c["agent"] for case in cases for c in case.in_one_go):
        label = f"{title_of(agent)} in one go: ε falls once"
        shade = INK if alone else colour[agent]
        handles.append(Line2D([], [], color=shade, lw=1.6, ls=IN_ONE_GO, label=label))
    if any(c["best_known_m"] for case in cases for c in case.curves):
        handles.append(Line2D([], [], color=INK, lw=THIN, label="best known"))
    one.legend(handles=handles, loc="outside lower center", ncols=3, labelcolor=MUTED)


def _alt(case: Case, gait: str) -> str:
    sentences = [
        f"{title_of(one['agent'])}{', in one go' if one['blocks'] == 1 else ''}: "
        + ", ".join(
            f"{metres(middle)} after {steps:,} steps"
            for steps, middle in zip(one["steps"], one["iqm_m"], strict=True)
        )
        + (f"; greedy {metres(one['greedy_m'])}" if one["greedy_m"] else "")
        + (f"; best known {metres(one['best_known_m'])}." if one["best_known_m"] else ".")
        for one in (*case.curves, *case.in_one_go)
        if one["gait"] == gait and one["steps"]
    ]
    return f"{gait_name(gait)} with {case.label}. {' '.join(sentences) or 'No trials yet.'}"
