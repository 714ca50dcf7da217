"""How every figure looks, and how it becomes a file."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from typing import Any, NamedTuple

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK, MUTED, FAINT, PAPER = "#1f2329", "#646b75", "#dfe2e6", "#fffffe"
"""Text, quiet text, grid lines, and the ground; a page gives them its own colours."""
CSS_NAMES: Mapping[str, str] = {INK: "ink", MUTED: "muted", FAINT: "line", PAPER: "paper"}

AGENT_COLOURS: Mapping[str, str] = {
    "q-learning": "#E69F00",
    "greedy": "#56B4E9",
    "two-step": "#009E73",
}
FURTHER_COLOURS = ("#CC79A7", "#D55E00", "#F0E442", "#0072B2")
"""Okabe and Ito: told apart by colour-blind people too."""

FORMATS = ("png", "svg", "pdf")
_UNDATED: Mapping[str, Mapping[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
_LOOK = {
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
    "text.parse_math": False,  # a $ in a name is a $
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "legend.frameon": False,
    "svg.hashsalt": "hexapods",
}


class Picture(NamedTuple):
    """A figure with the words that stand for it."""

    name: str
    """Of its files."""
    title: str
    alt: str
    """What it shows, for who does not see it."""
    figure: Figure


@contextmanager
def look() -> Iterator[None]:
    """Within it, figures are made in the one style; matplotlib's own settings stay as they are."""
    with rc_context(_LOOK):  # type: ignore[arg-type]
        yield


def figure(width_in: float, height_in: float) -> Figure:
    """An empty figure that needs no display."""
    made = Figure(figsize=(width_in, height_in), layout="constrained")
    FigureCanvasAgg(made)
    return made


def colours(agents: Sequence[str]) -> dict[str, str]:
    """One colour an agent; those that are not the paper's share the further ones in order."""
    own = [agent for agent in agents if agent not in AGENT_COLOURS]
    further = {
        agent: FURTHER_COLOURS[place % len(FURTHER_COLOURS)] for place, agent in enumerate(own)
    }
    return {**AGENT_COLOURS, **further}


def rendered(made: Figure, kind: str) -> bytes:
    """The bytes of a file, the same for the same numbers: without dates and random names."""
    out = BytesIO()
    with look(), rc_context({"svg.fonttype": "path"}):
        made.savefig(out, format=kind, dpi=150, metadata=dict(_UNDATED[kind]))
    return out.getvalue()


def inlined(made: Figure, prefix: str) -> str:
    """SVG to stand in a page: its text as text, its greys the page's own, its names its own.

    Args:
        made: a figure.
        prefix: before every id, because a page has several figures.
    """
    out = BytesIO()
    with look(), rc_context({"svg.fonttype": "none", "svg.hashsalt": prefix}):
        made.savefig(out, format="svg", transparent=True, metadata=dict(_UNDATED["svg"]))
    text = out.getvalue().decode()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r'(\bid="|"#|url\(#)', rf"\g<1>{prefix}-", text)
    text = re.sub(r' (?:width|height)="[\d.]+pt"', "", text, count=2)
    # The text's font is the page's.
    text = re.sub(r"font: ((?:[\w.]+ )*?)([\d.]+)px [^;\"]+", _font, text)
    for grey, name in CSS_NAMES.items():
        text = text.replace(grey, f"var(--{name})")
    return re.sub(r"\n\s*", "\n", text)


def _font(found: re.Match[str]) -> str:
    weight = "700" if "bold" in found[1] or "700" in found[1] else "400"
    return f"font-weight: {weight}; font-size: {found[2]}px"


def spread(count: int, height: float) -> list[float]:
    """Where to put points beside their line so that they hide each other little, −height to it.

    Always the same, and with no two neighbours alike: multiples of the golden ratio.
    """
    return [height * (2 * ((place * 0.618034) % 1) - 1) for place in range(count)]


def quiet(ax: Axes, along: str) -> None:
    """Grid lines along one axis only, under everything, and no tick marks."""
    ax.grid(axis=along, linewidth=0.8)  # type: ignore[arg-type]
    ax.set_axisbelow(True)
    ax.tick_params(length=0)
    for side in ax.spines.values():
        side.set_visible(False)
