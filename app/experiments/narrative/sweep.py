"""What a sweep shows."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from app.experiments.claims.cases import Case
from app.experiments.config import GRID
from app.experiments.formatting import RATES, agent_name, counted, metres, percent, shares


def extremes(places: Sequence[Case]) -> str | None:
    """The best and the worst of the grid, and that the best was picked."""
    pools = [(case, one) for case in places for one in case.pooled if one["walkers"]]
    if len(pools) < 2:
        return None
    ordered = sorted(pools, key=lambda found: float(found[1]["relative"]["iqm"]))
    told = [
        f"The {word} is {named(one, [pool for _, pool in pools])} with {case.label}: "
        f"{shares(one['relative'])} of greedy's distance, {percent(one['walkers']['share'])} of "
        "the seeds walk."
        for word, (case, one) in (("best", ordered[-1]), ("worst", ordered[0]))
    ]
    return (
        f"{len(pools)} combinations were tried, each over all gaits. {' '.join(told)} The best of "
        "many looks better than it is, because luck helped to pick it: try it again with another "
        "seed before you believe it."
    )


def named(one: Mapping[str, Any], among: Sequence[Mapping[str, Any]]) -> str:
    """What tells a combination from the others; its agent where nothing else does."""
    varied = [n for n in GRID if len({other[n] for other in among if other["walkers"]}) > 1]
    said = [RATES[name].format(one[name]) for name in varied if one[name] is not None]
    if len({other["agent"] for other in among}) > 1 or not said:
        said.insert(0, agent_name(one["agent"]))
    return ", ".join(said)


def one_seed(places: Sequence[Case]) -> str | None:
    """The spread of the setting that spreads most."""
    learners = [
        one for case in places for one in case.settings if one["role"] == "learner" and one["n"] > 1
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


SWEEP_STORY: Sequence[tuple[str, Callable[[Sequence[Case]], str | None]]] = (
    ("Best and worst", extremes),
    ("One seed misleads", one_seed),
)
