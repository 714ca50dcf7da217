"""Titles, descriptions and colours of agents for the stage, the page and reports.

The paper's agents have colours of the Okabe–Ito palette, which colour-blind viewers can
distinguish; it has too few for all agents, so the others are distinct for most viewers only.
"""

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from hexapods.agents.registry import BUILT_IN, registered, settings_of

_COLOR = re.compile("#[0-9A-Fa-f]{6}")
_FURTHER_COLORS = ("#CC79A7", "#D55E00", "#F0E442", "#0072B2", "#882255", "#88CCEE", "#6B4E16")


def title_of(agent: str) -> str:
    """Return an agent's title; for `my.module:Agent` the name of the class."""
    return _attribute(agent, "title") or agent.rpartition(":")[2]


def description_of(agent: str) -> str:
    """Return the description of a registered agent, one sentence."""
    return _attribute(agent, "description") or "An agent of an installed package."


def name_of(
    agent: str,
    settings: Mapping[str, Any] = MappingProxyType({}),
    keep_learning: bool | None = None,
    title: str | None = None,
) -> str:
    """Return an agent's title with its settings in short: `Beam, width 8, depth 3`.

    Args:
        agent: a name; `my.module:Agent` is not imported, and so has no settings here.
        settings: values by name. Of a learner, those that differ from the defaults are shown.
        keep_learning: whether it learns in the race; shown if that is not the agent's default.
        title: replaces the agent's title.
    """
    phrases = [title or title_of(agent)]
    agent_class = None if ":" in agent else BUILT_IN.get(agent) or registered().get(agent)
    if agent_class is not None:
        shows_all = not getattr(agent_class, "learns", True)
        phrases += [
            setting.describe(settings[name])
            for name, setting in settings_of(agent_class).items()
            if name in settings and (shows_all or settings[name] != setting.default)
        ]
    if keep_learning not in (None, bool(getattr(agent_class, "keeps_learning", False))):
        phrases.append("keeps learning" if keep_learning else "frozen")
    return ", ".join(phrases)


def colors_of(agents: Sequence[str]) -> list[str]:
    """Return a colour, `#RRGGBB`, for each agent; distinct until the palette is exhausted.

    An agent gets the colour of its class, or a free one if that is taken or there is none.
    """
    class_colors = [_attribute(agent, "color") for agent in agents]
    built_in_colors = (_attribute(agent, "color") for agent in BUILT_IN)
    candidates = list(
        dict.fromkeys([*_FURTHER_COLORS, *(color for color in built_in_colors if color)])
    )
    assigned: list[str] = []
    for color in class_colors:
        free = [candidate for candidate in candidates if candidate not in assigned]
        spare = next(
            (candidate for candidate in free if candidate not in class_colors),
            (free or candidates)[0],
        )
        assigned.append(spare if color is None or color in assigned else color)
    return assigned


def _attribute(agent: str, name: str) -> str | None:
    """Return an attribute of a registered agent's class; `my.module:Agent` is not imported."""
    if ":" in agent:
        return None
    value = getattr(BUILT_IN.get(agent) or registered().get(agent), name, None)
    if not isinstance(value, str) or (name == "color" and not _COLOR.fullmatch(value)):
        return None
    return value
