"""Titles, descriptions and colours of agents for the stage, the page and reports.

The paper's agents have colours of the Okabe–Ito palette, which colour-blind viewers can
distinguish; it has too few for all agents, so the others are distinct for most viewers only.
"""

import re
from collections.abc import Sequence

from app.agents.registry import OURS, registered

_COLOR = re.compile("#[0-9A-Fa-f]{6}")
_FURTHER_COLORS = ("#CC79A7", "#D55E00", "#F0E442", "#0072B2")


def title_of(agent: str) -> str:
    """Return an agent's title; for `my.module:Agent` the name of the class."""
    return _attribute(agent, "title") or agent.rpartition(":")[2]


def description_of(agent: str) -> str:
    """Return the description of a registered agent, one sentence."""
    return _attribute(agent, "description") or "An agent of an installed package."


def colors_of(agents: Sequence[str]) -> list[str]:
    """Return a colour, `#RRGGBB`, for each agent; distinct until the palette is exhausted.

    An agent gets the colour of its class, or a free one if that is taken or there is none.
    """
    own = [_attribute(agent, "color") for agent in agents]
    others = (_attribute(agent, "color") for agent in OURS)
    candidates = list(dict.fromkeys([*_FURTHER_COLORS, *(color for color in others if color)]))
    assigned: list[str] = []
    for color in own:
        free = [one for one in candidates if one not in assigned]
        spare = next((one for one in free if one not in own), (free or candidates)[0])
        assigned.append(spare if color is None or color in assigned else color)
    return assigned


def _attribute(agent: str, name: str) -> str | None:
    """Return an attribute of a registered agent's class; `my.module:Agent` is not imported."""
    if ":" in agent:
        return None
    found = getattr(OURS.get(agent) or registered().get(agent), name, None)
    if not isinstance(found, str) or (name == "color" and not _COLOR.fullmatch(found)):
        return None
    return found
