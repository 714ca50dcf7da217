"""The figure of a sweep: each combination's share of greedy's distance, over all gaits."""

from collections.abc import Mapping, Sequence
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.experiments.claims.cases import Case
from hexapods.experiments.formatting import percent
from hexapods.experiments.narrative.sweep import combination_name
from hexapods.experiments.report.drawing import (
    INK,
    MUTED,
    THIN,
    Picture,
    agent_colours,
    figure,
    style_axes,
)
from hexapods.extras import needs

with needs("experiments", "the report of an experiment"):
    from matplotlib.axes import Axes

MOST = 40
"""Maximal number of rows of a figure; of more combinations the best are drawn."""
_ROW_IN = 0.27


def panel(case: Case, name: str) -> Picture:
    """Draw one row per combination, in the order of the grid."""
    rows, left_out = chosen(case)
    one = figure(4.8, 1.0 + _ROW_IN * max(1, len(rows)))
    ax = one.subplots()
    _draw(ax, rows, case)
    title = case.label
    if left_out:
        title += f", the best {MOST} of {MOST + left_out}"
    return Picture(name, title, _alt(rows, case), one)


def chosen(case: Case) -> tuple[list[Mapping[str, Any]], int]:
    """Return the combinations to draw, and the number of those left out."""
    pools = [one for one in case.pooled if one["relative"]]
    best = sorted(pools, key=lambda one: -float(one["relative"]["iqm"]))[:MOST]
    return [one for one in pools if one in best], len(pools) - len(best)


def _draw(ax: Axes, rows: Sequence[Mapping[str, Any]], case: Case) -> None:
    shade = agent_colours([one["agent"] for one in case.pooled])
    for place, one in enumerate(rows):
        middle, known = one["relative"], one["best_known_relative"]
        if known is not None:
            # It depends on the grid: rows with the same value draw one line.
            ax.plot([known] * 2, [-place - 0.5, -place + 0.5], color=INK, lw=THIN)
        if middle["low"] is not None:
            ax.plot([middle["low"], middle["high"]], [-place] * 2, color=INK, lw=2)
        ax.plot([middle["iqm"]], [-place], "o", ms=7, color=shade[one["agent"]], mec=INK, mew=0.8)
    ax.plot([1, 1], [1.1, -len(rows)], color=shade["greedy"], lw=2, ls=(0, (4, 2)))
    ax.text(0.99, 0.75, "greedy", size=9, color=MUTED, ha="right", va="center")
    known = [one["best_known_relative"] for one in rows if one["best_known_relative"]]
    if known:
        ax.text(max(known), 1.4, "best known", size=9, color=MUTED, ha="right", va="center")
    ax.set_yticks(
        [-place for place in range(len(rows))],
        [combination_name(one, case) for one in rows],
    )
    ax.set_ylim(-len(rows) + 0.4, 1.8 if known else 1.1)
    lowest = min((one["relative"]["low"] or one["relative"]["iqm"] for one in rows), default=0)
    ax.set_xlim(min(0, lowest) - 0.02, 1.05 * max([1, *known]))
    ax.xaxis.set_major_formatter(lambda value, _: percent(value))
    ax.set_xlabel("share of greedy's distance")
    style_axes(ax, "x")


def _alt(rows: Sequence[Mapping[str, Any]], case: Case) -> str:
    sentences = [
        f"{title_of(one['agent'])} {combination_name(one, case)}: {percent(one['relative']['iqm'])}"
        + (f" of {percent(known)} best known" if (known := one["best_known_relative"]) else "")
        for one in rows
    ]
    return (
        f"Share of greedy's distance with {case.label}. {'; '.join(sentences) or 'No trials yet'}."
    )
