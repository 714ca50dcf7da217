"""Paragraphs about a sweep."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from app.experiments.claims.cases import Case
from app.experiments.config import GRID
from app.experiments.formatting import (
    PARAMETER_FORMATS,
    agent_name,
    counted,
    metres,
    percent,
    shares,
)


def describe_best_and_worst(cases: Sequence[Case]) -> str | None:
    """Describe the best and the worst combination, with a caution about the selection bias."""
    pools = [(case, one) for case in cases for one in case.pooled if one["walkers"]]
    if len(pools) < 2:
        return None
    ordered = sorted(pools, key=lambda pool: float(pool[1]["relative"]["iqm"]))
    sentences = [
        f"The {word} is {combination_name(one, [pool for _, pool in pools])} with {case.label}: "
        f"{shares(one['relative'])} of greedy's distance, {percent(one['walkers']['share'])} of "
        "the seeds walk."
        for word, (case, one) in (("best", ordered[-1]), ("worst", ordered[0]))
    ]
    return (
        f"{len(pools)} combinations were tried, each over all gaits. {' '.join(sentences)} The "
        "best of many looks better than it is, because luck helped to pick it: try it again with "
        "another seed before you believe it."
    )


def combination_name(one: Mapping[str, Any], among: Sequence[Mapping[str, Any]]) -> str:
    """Name a combination by the parameters that vary among the pools, or else by its agent."""
    varied = [n for n in GRID if len({other[n] for other in among if other["walkers"]}) > 1]
    parts = [PARAMETER_FORMATS[name].format(one[name]) for name in varied if one[name] is not None]
    if len({other["agent"] for other in among}) > 1 or not parts:
        parts.insert(0, agent_name(one["agent"]))
    return ", ".join(parts)


def describe_seed_spread(cases: Sequence[Case]) -> str | None:
    """Describe the setting whose seeds spread most."""
    learners = [
        one for case in cases for one in case.settings if one["role"] == "learner" and one["n"] > 1
    ]
    if not learners:
        return None
    one = max(learners, key=lambda s: max(s["total"]["points_m"]) - min(s["total"]["points_m"]))
    points = one["total"]["points_m"]
    return (
        f"The setting that spreads most is {one['key']}: of {counted(one['n'], 'seed')} the worst "
        f"covers {metres(min(points))} and the best {metres(max(points))}. Two settings that were "
        "each tried once would have told little."
    )


SWEEP_NARRATIVE: Sequence[tuple[str, Callable[[Sequence[Case]], str | None]]] = (
    ("Best and worst", describe_best_and_worst),
    ("One seed misleads", describe_seed_spread),
)
