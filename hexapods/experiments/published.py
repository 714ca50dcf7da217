"""The numbers of the paper's Table 1; each is a single run.

The paper gives "units of .5 per square length"; the squares of its floor were 0.5 m, so that the
numbers are taken as metres.
"""

from collections.abc import Mapping
from typing import NamedTuple

DISTANCES = ("finished", "total")


class Published(NamedTuple):
    """The two distances that the paper's Table 1 has for an agent and a gait [m]."""

    finished_m: float
    """The row "Finished": at time-out, when the first lane has used its 50 steps."""
    total_m: float | None
    """The row "Total", after the agent's own 50 steps; None where it says "Unfinished"."""


COLUMNS: tuple[tuple[str, int, str], ...] = (
    ("q-learning", 500, "Q-500 trials"),
    ("q-learning", 1000, "Q-1000 trials"),
    ("greedy", 0, "Greedy Agent"),
    ("two-step", 0, "Two-Steps Agent"),
)
"""Agent, steps of practice, and the paper's column heading."""

GAITS: Mapping[str, str] = {
    "left-right-origin": "LeftRight-Origin",
    "left-right-vertical": "LeftRight-Vertical",
    "front-back-origin": "FrontBack-Origin",
    "front-back-vertical": "FrontBack-Vertical",
}
"""The paper's names of the gaits."""

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
"""The paper's Table 1 by gait, in the order of `COLUMNS`."""


def published(gait: str, agent: str, steps: int) -> Published | None:
    """Return the paper's distances for a gait, an agent and its steps of practice, or None."""
    row = TABLE1.get(gait)
    for place, (name, practised, _) in enumerate(COLUMNS):
        if row is not None and (name, practised) == (agent, steps):
            return row[place]
    return None
