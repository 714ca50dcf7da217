"""What a figure for a paper shows."""

from dataclasses import dataclass
from typing import Literal, get_args

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.experiments.comparison import Unit
from hexapods.experiments.setting_comparison import Distance

Kind = Literal["seeds", "comparison", "profile"]
"""`seeds`: every seed of each setting, with interquartile means and intervals; `comparison`: those
of two settings, and their difference; `profile`: performance profiles."""
KINDS = get_args(Kind)
Columns = Literal[1, 2]
"""Columns of a page that the figure fills."""
MAX_ROWS = 24
"""Most settings of which the seeds fit on a page."""
MAX_PROFILES = 6
"""Most profiles that can be told apart without colour."""


@dataclass(frozen=True, kw_only=True)
class FigureConfig:
    """What a figure for a paper shows.

    Attributes:
        kind: seeds, comparison or profile.
        columns: of the page, 1 (85 mm) or 2 (178 mm).
        settings: keys or names of settings, in order; empty for all that have a distance.
        distance: total, or that at time-out.
        unit: of the distances.

    Raises:
        UnknownName, InvalidInput: if a value is not valid, or a comparison is not of two settings.
    """

    kind: Kind = "seeds"
    columns: Columns = 1
    settings: tuple[str, ...] = ()
    distance: Distance = "total"
    unit: Unit = "m"

    def __post_init__(self) -> None:
        for name, value, choices in (
            ("kind of figure", self.kind, KINDS),
            ("distance", self.distance, get_args(Distance)),
            ("unit", self.unit, get_args(Unit)),
        ):
            if value not in choices:
                raise UnknownName(name, value, choices)
        if self.columns not in get_args(Columns):
            raise InvalidInput(
                f"a figure fills 1 or 2 columns of a page, not {self.columns}", field="columns"
            )
        if self.kind == "comparison" and len(self.settings) != 2:
            raise InvalidInput(
                f"a comparison is of two settings, and {len(self.settings)} are named",
                field="settings",
            )
