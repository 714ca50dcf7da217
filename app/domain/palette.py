"""Colours of agents, from the Okabe–Ito palette, which is safe for colour blindness."""

from collections.abc import Sequence

AGENT_COLORS = {"q-learning": "#E69F00", "greedy": "#56B4E9", "two-step": "#009E73"}
FURTHER_COLORS = ("#CC79A7", "#D55E00", "#F0E442", "#0072B2")


def lane_colors(agents: Sequence[str]) -> list[str]:
    """Return a distinct `#RRGGBB` for each lane as long as there are enough.

    A lane gets its agent's own colour, or a spare one if that is taken or there is none.
    """
    assigned: list[str] = []
    candidates = [*FURTHER_COLORS, *AGENT_COLORS.values()]
    for agent in agents:
        color = AGENT_COLORS.get(agent)
        if color is None or color in assigned:
            unreserved = [c for c in candidates if c not in assigned and c not in _reserved(agents)]
            free = [c for c in candidates if c not in assigned]
            color = (unreserved or free or candidates)[0]
        assigned.append(color)
    return assigned


def _reserved(agents: Sequence[str]) -> set[str]:
    return {AGENT_COLORS[agent] for agent in agents if agent in AGENT_COLORS}
