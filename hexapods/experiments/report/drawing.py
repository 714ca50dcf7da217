"""Common style of the figures, and their rendering as PNG, PDF and SVG."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from typing import Any, NamedTuple

from hexapods.agents.appearance import colors_of
from hexapods.agents.registry import BUILT_IN
from hexapods.extras import needs

with needs("experiments", "the report of an experiment"):
    from matplotlib import rc_context
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

INK, MUTED, FAINT, PAPER = "#1f2329", "#646b75", "#dfe2e6", "#fffffe"
"""Colours of text, secondary text, grid lines and background.

The page replaces them by its CSS variables, see `CSS_NAMES`.
"""
CSS_NAMES: Mapping[str, str] = {INK: "ink", MUTED: "muted", FAINT: "line", PAPER: "paper"}

THIN = 0.8
"""Width of the line of the best known distance."""
FORMATS = ("png", "svg", "pdf")
_NO_METADATA: Mapping[str, Mapping[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
_STYLE = {
    "font.size": 10,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": MUTED,
    "axes.titlecolor": INK,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "none",
    "figure.facecolor": PAPER,
    "grid.color": FAINT,
    "text.color": INK,
    "text.parse_math": False,  # names are user input: a $ is literal
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "legend.frameon": False,
    "svg.hashsalt": "hexapods",
}


class Picture(NamedTuple):
    """A figure with its file name, title and alternative text."""

    name: str
    """Base name of its files."""
    title: str
    alt: str
    """Alternative text, for screen readers."""
    figure: Figure


@contextmanager
def figure_style() -> Iterator[None]:
    """Apply the figures' style within the context; Matplotlib's global settings do not change."""
    with rc_context(_STYLE):  # type: ignore[arg-type]
        yield


def figure(width_in: float, height_in: float) -> Figure:
    """Create an empty figure with the Agg canvas, which needs no display."""
    fig = Figure(figsize=(width_in, height_in), layout="constrained")
    FigureCanvasAgg(fig)
    return fig


def agent_colours(agents: Sequence[str]) -> dict[str, str]:
    """Return a colour for each agent, and for each of ours."""
    every = list(dict.fromkeys([*BUILT_IN, *agents]))
    return dict(zip(every, colors_of(every), strict=True))


def render(fig: Figure, kind: str) -> bytes:
    """Render a figure to bytes, reproducibly: without dates and with a fixed hash salt.

    Args:
        fig: the figure.
        kind: one of `FORMATS`.
    """
    out = BytesIO()
    with figure_style(), rc_context({"svg.fonttype": "path"}):
        fig.savefig(out, format=kind, dpi=150, metadata=dict(_NO_METADATA[kind]))
    return out.getvalue()


def inline_svg(fig: Figure, prefix: str) -> str:
    """Render a figure as SVG for embedding in the page.

    Text stays text in the page's font, the greys become CSS variables, and ids are unique.

    Args:
        fig: the figure.
        prefix: prefix of every id, since a page has several figures.
    """
    out = BytesIO()
    with figure_style(), rc_context({"svg.fonttype": "none", "svg.hashsalt": prefix}):
        fig.savefig(out, format="svg", transparent=True, metadata=dict(_NO_METADATA["svg"]))
    text = out.getvalue().decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'(\bid="|"#|url\(#)', rf"\g<1>{prefix}-", text)
    text = re.sub(r' (?:width|height)="[\d.]+pt"', "", text, count=2)
    # Drop the font family, so that text inherits the page's.
    text = re.sub(r"font: ((?:[\w.]+ )*?)([\d.]+)px [^;\"]+", _font, text)
    for grey, name in CSS_NAMES.items():
        text = text.replace(grey, f"var(--{name})")
    return re.sub(r"\n\s*", "\n", text)


def _font(match: re.Match[str]) -> str:
    weight = "700" if "bold" in match[1] or "700" in match[1] else "400"
    return f"font-weight: {weight}; font-size: {match[2]}px"


def jitter(count: int, height: float) -> list[float]:
    """Return deterministic jitter in [−height, height], so that points overlap little.

    A low-discrepancy sequence: multiples of the golden ratio, modulo 1.
    """
    return [height * (2 * ((place * 0.618034) % 1) - 1) for place in range(count)]


def draw_best_known(ax: Axes, last: float, best_known_m: float | None) -> None:
    """Draw the best known distance as a thin line from 0 to `last`, captioned at its end.

    It is drawn over greedy's line, which may be as far.
    """
    if best_known_m is None:
        return
    ax.plot([0, last], [best_known_m] * 2, color=INK, lw=THIN, zorder=3)
    ax.annotate(
        "best known",
        (last, best_known_m),
        (0, 2),
        textcoords="offset points",
        ha="right",
        size=8,
        color=MUTED,
    )


def style_axes(ax: Axes, along: str) -> None:
    """Draw grid lines along one axis only, below the data; hide tick marks and spines."""
    ax.grid(axis=along, linewidth=0.8)  # type: ignore[arg-type]
    ax.set_axisbelow(True)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
