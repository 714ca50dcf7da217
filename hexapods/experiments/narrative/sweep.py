"""Paragraphs about a sweep."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.text import counted, metres
from hexapods.experiments.claims.cases import Case
from hexapods.experiments.formatting import percent, shares
from hexapods.experiments.labels import parameter_text
from hexapods.experiments.names import setting_names


def describe_best_and_worst(cases: Sequence[Case]) -> str | None:
    """Describe the best and the worst combination, with a caution about the selection bias."""
    pools = [(case, pool) for case in cases for pool in case.pooled if pool["walkers"]]
    if len(pools) < 2:
        return None
    ordered = sorted(pools, key=lambda pool: float(pool[1]["relative"]["iqm"]))
    sentences = [
        f"The {word} is {combination_name(pool, case, [pool for _, pool in pools])} with "
        f"{case.label}: {shares(pool['relative'])} of greedy's distance, "
        f"{percent(pool['walkers']['share'])} of the seeds walk."
        for word, (case, pool) in (("best", ordered[-1]), ("worst", ordered[0]))
    ]
    return (
        f"{len(pools)} combinations were tried, each over all gaits. {' '.join(sentences)} The "
        "best of many looks better than it is, because luck helped to pick it: try it again with "
        "another seed before you believe it."
    )


def combination_name(
    pool: Mapping[str, Any], case: Case, among: Sequence[Mapping[str, Any]] | None = None
) -> str:
    """Name a combination by the parameters that vary among the pools, or else by its agent.

    The pools are those of the case, or those of several that are given. What differs only between
    agents, such as their defaults, is told by the agent's name.
    """
    among = case.pooled if among is None else among
    walked = [other for other in among if other["walkers"]]
    of_agents = [
        [other for other in walked if other["agent"] == agent]
        for agent in dict.fromkeys(other["agent"] for other in walked)
    ]
    varied = [
        name
        for name in case.parameters
        if any(len({other[name] for other in pools}) > 1 for pools in of_agents)
    ]
    words = [
        parameter_text(name, pool[name], pool["agent"]) for name in varied if pool[name] is not None
    ]
    if len({other["agent"] for other in among}) > 1 or not words:
        words.insert(0, title_of(pool["agent"]))
    return ", ".join(words)


def describe_seed_spread(cases: Sequence[Case]) -> str | None:
    """Describe the setting whose seeds spread most."""
    learners = [
        setting
        for case in cases
        for setting in case.settings
        if setting["role"] == "learner" and setting["n"] > 1
    ]
    if not learners:
        return None
    widest = max(learners, key=lambda s: max(s["total"]["points_m"]) - min(s["total"]["points_m"]))
    points = widest["total"]["points_m"]
    names = setting_names(learners, cases[0].parameters)
    return (
        f"The setting that spreads most is {names[widest['key']]}: of "
        f"{counted(widest['n'], 'seed')} the worst covers {metres(min(points))} and the best "
        f"{metres(max(points))}. Two settings that were each tried once would have told little."
    )


SWEEP_NARRATIVE: Sequence[tuple[str, Callable[[Sequence[Case]], str | None]]] = (
    ("Best and worst", describe_best_and_worst),
    ("One seed misleads", describe_seed_spread),
)
