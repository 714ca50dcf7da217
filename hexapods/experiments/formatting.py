"""Format numbers and lists for the report."""

from collections.abc import Iterable, Mapping
from typing import Any

from hexapods.domain.text import metres
from hexapods.experiments.statistics import Interval

_NO_BREAK_SPACE = "\u00a0"


def percent(value: float) -> str:
    """Format a share as `74 %`, with a no-break space."""
    return f"{number(100 * value, 0)}{_NO_BREAK_SPACE}%"


def number(value: float, digits: int = 2) -> str:
    """Format a number without a unit; never `-0.00`, with U+2212 as the minus sign."""
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "−")


def span(values: Iterable[float]) -> str:
    """Format the range of some distances: `0.45 m to 0.47 m`, or `0.51 m` if they are equal."""
    ordered = sorted(values)
    ends = dict.fromkeys(metres(value) for value in (ordered[0], ordered[-1]))
    return " to ".join(ends)


def shares(estimate: Interval | Mapping[str, Any]) -> str:
    """Format a share with its interval: `74 % (72 to 76)`."""
    value, low, high = Interval.of(estimate)
    if low is None or high is None:
        return percent(value)
    return f"{percent(value)} ({number(100 * low, 0)} to {number(100 * high, 0)})"


def distance(estimate: Interval | Mapping[str, Any]) -> str:
    """Format a distance with its interval: `0.36 m (0.34 to 0.37)`."""
    value, low, high = Interval.of(estimate)
    if low is None or high is None:
        return metres(value)
    return f"{metres(value)} ({number(low)} to {number(high)})"


def listed(items: Iterable[str], last: str = "and") -> str:
    """Join items into an enumeration: `a`, `a and b`, `a, b and c`."""
    *head, tail = list(items)
    return f"{', '.join(head)} {last} {tail}" if head else tail
