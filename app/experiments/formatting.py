"""Numbers and names as the reader of a report meets them."""

from collections.abc import Iterable, Mapping
from typing import Any

from app.experiments.published import GAITS
from app.experiments.statistics import Interval

AGENTS: Mapping[str, str] = {
    "q-learning": "Q-learning",
    "greedy": "Greedy",
    "two-step": "Two-step",
}
_UNBROKEN = "\u00a0"
READINGS: Mapping[str, str] = {"measured": "feet read back", "commanded": "commands remembered"}
"""What an observation is, in words."""

RATES: Mapping[str, str] = {
    "steps": "{:,}\u00a0steps",
    "alpha": "α\u00a0{:g}",
    "gamma": "γ\u00a0{:g}",
    "epsilon_start": "ε\u00a0from\u00a0{:g}",
    "epsilon_end": "ε\u00a0to\u00a0{:g}",
    "steps_per_episode": "{:,}\u00a0an\u00a0episode",
    "divisions": "{}\u00a0divisions",
    "grid_side_m": "grid\u00a0{:g}\u00a0m",
}
"""What a sweep varies, with its value."""


def gait_name(gait: str) -> str:
    """As the paper writes it; one's own as it is."""
    return GAITS.get(gait, gait)


def agent_name(agent: str) -> str:
    """As on the page; of `my.module:Agent` the class."""
    return AGENTS.get(agent, agent.rpartition(":")[2])


def percent(value: float) -> str:
    """A share: `74 %`, which no line breaks apart."""
    return f"{100 * value:.0f}{_UNBROKEN}%"


def metres(value: float) -> str:
    """A distance to the centimetre; never `-0.00 m`."""
    return f"{number(value)}{_UNBROKEN}m"


def number(value: float, digits: int = 2) -> str:
    """Without a unit; never `-0.00`, and with a minus that is one."""
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "−")


def span(values: Iterable[float]) -> str:
    """From the smallest to the largest distance: `0.45 m to 0.47 m`, or `0.51 m`."""
    ordered = sorted(values)
    ends = dict.fromkeys(metres(value) for value in (ordered[0], ordered[-1]))
    return " to ".join(ends)


def shares(found: Interval | Mapping[str, Any]) -> str:
    """A share with its interval: `74 % (72 to 76)`."""
    value, low, high = _three(found)
    if low is None or high is None:
        return percent(value)
    return f"{percent(value)} ({100 * low:.0f} to {100 * high:.0f})"


def distance(found: Interval | Mapping[str, Any]) -> str:
    """A distance with its interval: `0.36 m (0.34 to 0.37)`."""
    value, low, high = _three(found)
    if low is None or high is None:
        return metres(value)
    return f"{metres(value)} ({number(low)} to {number(high)})"


def listed(items: Iterable[str], last: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`."""
    *head, tail = list(items)
    return f"{', '.join(head)} {last} {tail}" if head else tail


def counted(number: int, one: str, many: str | None = None) -> str:
    """`1 seed`, `30 seeds`."""
    return f"{number:,} {one if number == 1 else many or one + 's'}"


def _three(found: Interval | Mapping[str, Any]) -> tuple[float, float | None, float | None]:
    if isinstance(found, Interval):
        return found
    value = next(found[name] for name in ("share", "iqm", "iqm_m") if name in found)
    low = found["low"] if "low" in found else found["low_m"]
    high = found["high"] if "high" in found else found["high_m"]
    return value, low, high
