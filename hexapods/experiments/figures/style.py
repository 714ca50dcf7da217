"""Sizes, fonts, colours and dashes of figures, which can be read in print without colour.

Widths are those of one and of two columns of most journals. Text is 7 to 8 pt at that size. Colours
are those of Okabe and Ito, in an order in which their lightness differs too; lines differ in their
dashes and markers as well.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

WIDTHS_MM: Mapping[int, float] = {1: 85.0, 2: 178.0}
"""Width of a figure by the columns that it fills."""
MM = 1 / 25.4
"""Inches of a millimetre."""
PNG_DPI = 600
TEXT_PT, SMALL_PT = 8.0, 7.0
INK, DIM, FAINT = "#000000", "#595959", "#b3b3b3"

RC: Any = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # Matplotlib brings it along
    "font.size": TEXT_PT,
    "axes.labelsize": TEXT_PT,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.labelsize": SMALL_PT,
    "ytick.labelsize": SMALL_PT,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "legend.fontsize": SMALL_PT,
    "lines.linewidth": 1.2,
    # Text stays text: fonts are embedded as TrueType in PDF, and named in SVG.
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    # Names of clip paths, which are random else.
    "svg.hashsalt": "racing-hexapods",
    "text.usetex": False,
}
"""Settings of Matplotlib."""


class LineStyle(NamedTuple):
    """How a profile is drawn."""

    color: str
    dashes: tuple[float, ...]
    """Lengths of dashes and gaps [widths of the line]; empty for a solid line."""
    marker: str


LINES: Sequence[LineStyle] = (
    LineStyle("#000000", (), "o"),
    LineStyle("#d55e00", (4, 1.5), "s"),
    LineStyle("#0072b2", (1.2, 1.2), "^"),
    LineStyle("#009e73", (6, 1.5, 1.2, 1.5), "D"),
    LineStyle("#cc79a7", (2.5, 1, 2.5, 3), "v"),
    LineStyle("#56b4e9", (8, 2), "x"),
)
"""Of the profiles, in order."""
