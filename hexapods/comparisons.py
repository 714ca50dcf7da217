"""Two groups of seeds compared: trainings, or numbers of one's own."""

from collections.abc import Sequence
from typing import Union

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.errors import InvalidInput
from hexapods.experiments.comparing import compare as compare_groups
from hexapods.experiments.comparison import Comparison, Group
from hexapods.trainings import Training

Seeds = Union[Sequence[Training], Sequence[float], NDArray[np.floating]]  # noqa: UP007  # for mypy


def compare(
    a: Seeds,
    b: Seeds,
    *,
    names: tuple[str, str] = ("A", "B"),
    is_paired: bool | None = None,
    rng: np.random.Generator | None = None,
) -> Comparison:
    """Compare two groups of seeds: trainings, or distances of whatever walked [m].

    Args:
        a: trainings that differ in their seeds, or a distance per seed.
        b: likewise.
        names: of the groups, in words.
        is_paired: whether equal seeds are compared with each other; of numbers those in the same
            place. By default trainings are, if both groups have the same seeds, and numbers not.
        rng: generator of the bootstrap's random numbers; by default `default_rng(0)`.

    Raises:
        InvalidInput: if a group is empty, has a number that is not finite, or trainings beside
            numbers; or if what is to be paired has no seeds in common.

    Examples:
        >>> import hexapods as hx
        >>> comparison = hx.compare([0.50, 0.48, 0.51], [0.40, 0.41, 0.39], names=("New", "Old"))
        >>> round(comparison.difference.value, 3), comparison.ahead, comparison.further_seeds
        (0.097, 'not established', 2)
    """
    groups = [_points(group, name) for group, name in zip((a, b), names, strict=True)]
    seeds = [_seeds(group, name) for group, name in zip((a, b), names, strict=True)]
    if (seeds[0] is None) != (seeds[1] is None):
        raise InvalidInput(
            f"{names[0]} and {names[1]} must both be trainings, or both numbers, which are metres"
        )
    if is_paired is None:
        is_paired = seeds[0] is not None and set(seeds[0]) == set(seeds[1] or ())
    elif is_paired and seeds[0] is None:
        if len(groups[0]) != len(groups[1]):
            raise InvalidInput(
                f"numbers are paired by their places, but {names[0]} has {len(groups[0]):,} and "
                f"{names[1]} {len(groups[1]):,}"
            )
        seeds = [tuple(range(len(group))) for group in groups]
    first, second = (
        Group(name, points, numbers if is_paired else None)
        for name, points, numbers in zip(names, groups, seeds, strict=True)
    )
    return compare_groups(first, second, rng or np.random.default_rng(0))


def _seeds(group: Seeds, name: str) -> tuple[int, ...] | None:
    """Return the seeds of trainings; None of numbers."""
    trainings = [entry for entry in group if isinstance(entry, Training)]
    if not trainings:
        return None
    if len(trainings) < len(group):
        raise InvalidInput(f"{name} has trainings beside other values; give either")
    return tuple(training.config.seed for training in trainings)


def _points(group: Seeds, name: str) -> tuple[float, ...]:
    points = []
    for place, entry in enumerate(group, start=1):
        value = entry.distance_m if isinstance(entry, Training) else entry
        if value is None:
            raise InvalidInput(
                f"training {place} of {name} has no distance, as its file has none; "
                "`hexapods.evaluate` measures it"
            )
        if isinstance(value, bool) or not isinstance(value, int | float | np.number):
            raise InvalidInput(f"{name} must be trainings or numbers; entry {place} is {value!r}")
        points.append(float(value))
    return tuple(points)
