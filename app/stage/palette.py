"""One colour per agent, everywhere; safe for colour blindness (Okabe–Ito)."""

from collections.abc import Sequence

AGENT_COLORS = {"q-learning": "#E69F00", "greedy": "#56B4E9", "two-step": "#009E73"}
FURTHER_COLORS = ("#CC79A7", "#D55E00", "#F0E442", "#0072B2")


def lane_colors(agents: Sequence[str]) -> list[str]:
    """A colour for each lane: the agent's own, and a further one where it is taken or has none."""
    used: list[str] = []
    spare = [*FURTHER_COLORS, *AGENT_COLORS.values()]
    for agent in agents:
        color = AGENT_COLORS.get(agent)
        if color is None or color in used:
            wanted = [c for c in spare if c not in used and c not in _owned(agents)]
            free = [c for c in spare if c not in used]
            color = (wanted or free or spare)[0]
        used.append(color)
    return used


def _owned(agents: Sequence[str]) -> set[str]:
    return {AGENT_COLORS[agent] for agent in agents if agent in AGENT_COLORS}
