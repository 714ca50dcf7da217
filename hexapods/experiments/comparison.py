"""A comparison of two groups of seeds: its record, and the same in sentences."""

import math
from dataclasses import asdict, dataclass
from typing import Any, Literal, NamedTuple

from hexapods.domain.errors import InvalidInput
from hexapods.domain.short_repr import short_repr
from hexapods.domain.text import counted
from hexapods.experiments.config import MAX_SEEDS
from hexapods.experiments.formatting import number, percent, shares
from hexapods.experiments.statistics import MIN_RESAMPLED, MIN_SEEDS, Interval, Points

Unit = Literal["m", "h", "greedy"]
"""Metres, half grid sides, or shares of greedy's distance under the same conditions."""
Ahead = Literal["a", "b", "not established"]
Outlook = Literal["settled", "reachable", "out of reach", "equal", "too few seeds"]
"""`reachable`: by `further_seeds`; `out of reach`: not by `MAX_SEEDS` seeds; `equal`: a difference
of 0, which no further seeds settle; `too few seeds`: fewer than `MIN_SEEDS`, so no spread."""
POWER = 0.8
"""Chance with which the further seeds settle a difference that is truly as large as it seems."""


@dataclass(frozen=True)
class Group:
    """A group of seeds.

    Attributes:
        name: what it is called in words.
        points: a number per seed.
        numbers: of the seeds, by which those of two groups are paired; None where no other group
            has the same seeds.
        is_deterministic: whether further seeds would repeat the only point, as those of an agent
            that looks ahead.

    Raises:
        InvalidInput: if there is no point, or one is no finite number.
    """

    name: str
    points: Points
    numbers: tuple[int, ...] | None = None
    is_deterministic: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", tuple(map(float, self.points)))
        if not self.points:
            raise InvalidInput(f"{self.name} has no seed to compare")
        for place, point in enumerate(self.points, start=1):
            if not math.isfinite(point):
                raise InvalidInput(
                    f"seed {place} of {self.name} is {point}, not a finite number; leave out seeds "
                    "that failed"
                )
        if self.numbers is not None and len(set(self.numbers)) != len(self.points):
            raise InvalidInput(f"each seed of {self.name} must have another number")


class Compared(NamedTuple):
    """A group as it was compared."""

    name: str
    iqm: Interval
    """Interquartile mean of its seeds."""
    seeds: int
    """Number of the seeds that were compared."""
    is_deterministic: bool


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Group `a` compared with group `b`, in the unit of their points.

    Attributes:
        a, b: the groups, with their interquartile means.
        difference: a − b; without limits where there are too few seeds.
        improvement: probability that a random seed of `a` exceeds a random seed of `b`; a tie
            counts half.
        is_paired: whether the groups have the same seeds, which were resampled together.
        left_out: number of seeds that only one of two paired groups has.
        ahead: the group that is ahead, if the difference is settled.
        outlook: what further seeds would bring.
        further_seeds: number of seeds, in addition and of each group, that settle the difference
            with a chance of `POWER` if it is as large as it seems; None where none would.
        unit: of the points.
        is_at_time_out: whether they are distances at time-out, rather than after 50 steps.
    """

    __repr__ = short_repr

    a: Compared
    b: Compared
    difference: Interval
    improvement: Interval
    is_paired: bool
    left_out: int
    ahead: Ahead
    outlook: Outlook
    further_seeds: int | None
    unit: Unit = "m"
    is_at_time_out: bool = False

    @property
    def words(self) -> "ComparisonWords":
        """The comparison in sentences."""
        return _words(self)

    def __str__(self) -> str:
        return " ".join(filter(None, self.words))

    def as_json(self) -> dict[str, Any]:
        """Convert to plain types."""
        groups = {
            name: {**group._asdict(), "iqm": group.iqm._asdict()}
            for name, group in (("a", self.a), ("b", self.b))
        }
        intervals = {name: getattr(self, name)._asdict() for name in ("difference", "improvement")}
        return {**asdict(self), **groups, **intervals, "words": self.words._asdict()}


# ---- in sentences

_FINE = 0.02
"""Half widths of intervals [m] below which a difference is written with millimetres."""


class UnitFormat(NamedTuple):
    """How differences of a unit are written."""

    factor: float
    digits: int
    difference: str
    """Unit after a difference."""


_UNITS = {
    "m": UnitFormat(1, 2, "\u00a0m"),
    "h": UnitFormat(1, 1, "\u00a0h"),
    "greedy": UnitFormat(100, 0, " percentage points"),
}


class ComparisonWords(NamedTuple):
    """A comparison in sentences; one that says nothing is empty."""

    outcome: str
    """Who is ahead, and how surely."""
    chance: str
    """Probability of improvement."""
    further: str
    """What further seeds would bring."""
    seeds: str
    """Which seeds were compared, and whether they are paired."""


def _words(comparison: Comparison) -> ComparisonWords:
    farther = "farther at time-out" if comparison.is_at_time_out else "farther"
    return ComparisonWords(
        _outcome(comparison, _UNITS[comparison.unit], farther),
        _chance(comparison, farther),
        _further(comparison),
        _seeds(comparison),
    )


def _outcome(comparison: Comparison, unit: UnitFormat, farther: str) -> str:
    a, b, difference = comparison.a, comparison.b, comparison.difference
    if difference.value == 0 and difference.low in (None, 0) and difference.high in (None, 0):
        return f"{a.name} and {b.name} come equally far."
    ahead, behind = _order(comparison)
    by, interval = _difference(difference if ahead is a else -difference, unit)
    if comparison.ahead != "not established":
        return f"{ahead.name} comes {by} {farther} than {behind.name}{interval}."
    return (
        f"Not established which comes {farther}: {ahead.name} is ahead of {behind.name} by "
        f"{by}{interval}."
    )


def _order(comparison: Comparison) -> tuple[Compared, Compared]:
    """Return the group that is ahead, established or not, and the other."""
    a, b = comparison.a, comparison.b
    return (a, b) if comparison.difference.value >= 0 else (b, a)


def _difference(difference: Interval, unit: UnitFormat) -> tuple[str, str]:
    """Return a difference of 0 or more, and its interval in brackets."""
    value, low, high = difference
    digits = unit.digits
    if unit is _UNITS["m"] and (low is None or high is None or high - low < 2 * _FINE):
        digits += 1
    least = 10**-digits
    by = (
        f"less than {number(least, digits)}"
        if 0 < unit.factor * value < least / 2
        else number(unit.factor * value, digits)
    )
    if low is None or high is None or low == high:
        return f"{by}{unit.difference}", ""
    ends = " to ".join(number(unit.factor * end, digits) for end in (low, high))
    return f"{by}{unit.difference}", f" (95 % interval {ends})"


def _chance(comparison: Comparison, farther: str) -> str:
    a, b = comparison.a, comparison.b
    if a.is_deterministic and b.is_deterministic:
        return ""
    ahead, behind = _order(comparison)
    value, low, high = comparison.improvement
    if ahead is b:
        value = 1 - value
        low, high = (None if limit is None else 1 - limit for limit in (high, low))
    one, other = (
        name.name if name.is_deterministic else f"a seed of {name.name}" for name in (ahead, behind)
    )
    return (
        f"The probability that {one} comes {farther} than {other} is "
        f"{shares(Interval(value, low, high))}."
    )


def _further(comparison: Comparison) -> str:
    random = [group for group in (comparison.a, comparison.b) if not group.is_deterministic]
    of = "each" if len(random) == 2 else " ".join(group.name for group in random)
    if comparison.outlook == "settled":
        return "Settled: the interval excludes 0." if random else ""
    if comparison.outlook == "equal":
        return "Further seeds cannot settle a difference of 0."
    fewest = min(group.seeds for group in random)
    if comparison.outlook == "too few seeds":
        return (
            f"How many seeds would settle it cannot be told from {counted(fewest, 'seed')}: that "
            f"takes {MIN_SEEDS}."
        )
    few = (
        f"With fewer than {MIN_RESAMPLED} seeds an interval decides nothing. "
        if fewest < MIN_RESAMPLED
        else ""
    )
    if comparison.further_seeds is None:
        return f"{few}Even {MAX_SEEDS:,} seeds of {of} would hardly settle a difference so small."
    return (
        f"{few}About {counted(comparison.further_seeds, 'further seed')} of {of} would settle it "
        f"with a chance of {percent(POWER)}, if it is as large as it seems."
    )


def _seeds(comparison: Comparison) -> str:
    a, b = comparison.a, comparison.b
    if comparison.is_paired:
        left_out = comparison.left_out
        aside = f"; left out: {counted(left_out, 'seed')} of one alone" if left_out else ""
        return f"Paired: both walked with the same {counted(a.seeds, 'seed')}{aside}."
    fixed = [group.name for group in (a, b) if group.is_deterministic]
    random = [group for group in (a, b) if not group.is_deterministic]
    if len(fixed) == 2:
        return "Both walk the same with every seed."
    if fixed:
        return f"{counted(random[0].seeds, 'seed')}; {fixed[0]} walks the same with every seed."
    if a.seeds == b.seeds:
        return f"Not paired: {counted(a.seeds, 'seed')} each."
    seeds = " and ".join(f"{counted(group.seeds, 'seed')} of {group.name}" for group in random)
    return f"Not paired: {seeds}."
