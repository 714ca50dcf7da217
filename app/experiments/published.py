"""What the paper printed: its Table 1, one run a number.

The paper gives "units of .5 per square length"; the squares of its floor were 0.5 m, so that the
numbers are taken as metres.
"""

from collections.abc import Mapping
from typing import NamedTuple

DISTANCES = ("finished", "total")


class Published(NamedTuple):
    """One cell pair of the paper's Table 1 [m]."""

    finished_m: float
    total_m: float | None
    """None where the paper says "Unfinished"."""


COLUMNS: tuple[tuple[str, int, str], ...] = (
    ("q-learning", 500, "Q-500 trials"),
    ("q-learning", 1000, "Q-1000 trials"),
    ("greedy", 0, "Greedy Agent"),
    ("two-step", 0, "Two-Steps Agent"),
)
"""Agent, steps of practice, and the paper's words for them."""

GAITS: Mapping[str, str] = {
    "left-right-origin": "LeftRight-Origin",
    "left-right-vertical": "LeftRight-Vertical",
    "front-back-origin": "FrontBack-Origin",
    "front-back-vertical": "FrontBack-Vertical",
}
"""The paper's words for the gaits."""

TABLE1: Mapping[str, tuple[Published, Published, Published, Published]] = {
    "left-right-origin": (
        Published(0.25, 0.25),
        Published(0.325, 0.325),
        Published(0.375, 0.525),
        Published(0.04, None),
    ),
    "left-right-vertical": (
        Published(0.05, 0.05),
        Published(0.15, 0.15),
        Published(0.425, 0.525),
        Published(0.075, None),
    ),
    "front-back-origin": (
        Published(0.075, 0.075),
        Published(0.375, 0.375),
        Published(0.35, 0.475),
        Published(0.05, None),
    ),
    "front-back-vertical": (
        Published(0.275, 0.275),
        Published(0.275, 0.275),
        Published(0.325, 0.475),
        Published(0.05, None),
    ),
}
"""By gait, in the order of `COLUMNS`."""


def published(gait: str, agent: str, steps: int) -> Published | None:
    """What the paper has for a gait and an agent after this practice, if anything."""
    row = TABLE1.get(gait)
    for place, (name, practised, _) in enumerate(COLUMNS):
        if row is not None and (name, practised) == (agent, steps):
            return row[place]
    return None
