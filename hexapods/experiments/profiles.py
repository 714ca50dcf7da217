"""Performance profiles: the share of seeds that come at least as far as each distance τ.

As in Agarwal et al., "Deep RL at the edge of the statistical precipice" (2021), for the seeds of
one setting. Bands are pointwise 95 % intervals of a share of seeds (Wilson).
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

from hexapods.experiments.comparison import Group
from hexapods.experiments.statistics import MIN_SEEDS, share

MAX_BANDED = 1_000
"""With more seeds a band is hardly wider than a line."""


class Profile(NamedTuple):
    """A profile as steps: above `at[n − 1]` and up to `at[n]` the share is that of n."""

    name: str
    at: tuple[float, ...]
    """Distances of the seeds, ascending, each once."""
    share: tuple[float, ...]
    """Share of the seeds that come at least as far; 0 beyond the last distance."""
    low: tuple[float | None, ...]
    high: tuple[float | None, ...]
    """Limits of the band; None of a group that comes equally far with every seed, and of fewer than
    three seeds."""


def profile_of(group: Group) -> Profile:
    """Return the performance profile of a group of seeds."""
    n, at = len(group.points), tuple(sorted(set(group.points)))
    reached = [sum(point >= limit for point in group.points) for limit in at]  # whole numbers
    shares = [share(hits, n) for hits in reached]
    limits = [(None, None) if group.is_deterministic else (s.low, s.high) for s in shares]
    return Profile(
        group.name,
        at,
        tuple(estimate.value for estimate in shares),
        tuple(low for low, _ in limits),
        tuple(high for _, high in limits),
    )


def share_limits(numbers: Iterable[int]) -> list[dict[str, Any]]:
    """Return, for each number of seeds, the limits of the bands by the number that reach τ.

    Args:
        numbers: of seeds; bands of fewer than three or more than `MAX_BANDED` are left out.
    """
    entries = []
    for n in sorted(set(numbers)):
        if MIN_SEEDS <= n <= MAX_BANDED:
            limits = [share(hits, n) for hits in range(n + 1)]
            low, high = [limit.low for limit in limits], [limit.high for limit in limits]
            entries.append({"seeds": n, "low": low, "high": high})
    return entries


def band_beyond(group: Group) -> float | None:
    """Return the upper limit of the band beyond the last distance, where no seed comes."""
    return None if group.is_deterministic else share(0, len(group.points)).high
