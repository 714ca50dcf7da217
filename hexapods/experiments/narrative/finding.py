"""Finding of an experiment in a sentence: the headline of its report, and its line in lists."""

from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.text import counted
from hexapods.experiments.claims.cases import Case, cases_of
from hexapods.experiments.formatting import listed, percent, shares
from hexapods.experiments.labels import OBSERVATION_LABELS, gait_name, robot_name, world_name
from hexapods.experiments.narrative.sweep import combination_name
from hexapods.experiments.presets import Preset

LEVEL_M = 0.01
"""Of two who are less apart, neither is farther."""
_PLACE_NAMES: Mapping[str, Callable[[Any], str]] = {
    "gait": gait_name,
    "world": world_name,
    "robot": robot_name,
    "observation": lambda name: OBSERVATION_LABELS.get(name, name),
}
_PLACE = tuple(_PLACE_NAMES)


def find(summary: Mapping[str, Any], preset: Preset) -> str:
    """Return the finding so far, by its intervals: the best combination, or the farthest learner.

    Empty while there is nothing to compare, and where the paper's claims say it.
    """
    if preset.names_best:
        return _best_of(cases_of(summary))
    return _farthest(summary["worlds"]) if preset.has_worlds else ""


def _best_of(cases: Sequence[Case]) -> str:
    """Name the best combination, and how many may be as good: their intervals overlap with its."""
    pools = [(case, one) for case in cases for one in case.pooled if one["walkers"]]
    if len(pools) < 2:
        return ""
    case, best = max(pools, key=lambda pool: float(pool[1]["relative"]["iqm"]))
    others = [one for _, one in pools if one is not best]
    place = f" with {case.label}" if len(cases) > 1 else ""
    name = f"{combination_name(best, case, [one for _, one in pools])}{place}"
    share = f"{shares(best['relative'])} of greedy's distance"
    if best["relative"]["low"] is None:
        return f"{name} leads with {share}; so few seeds tell little."
    low = best["relative"]["low"]
    equals = sum(_reaches(one["relative"], low) for one in others)  # whole numbers
    if not equals:
        return f"{name} walks farthest: {share}."
    return f"{name} leads with {share}; {_some_of(equals, len(others))} may be as good."


def _reaches(share: Mapping[str, Any], low: float) -> bool:
    return share["high"] is None or share["high"] >= low


def _some_of(number: int, total: int) -> str:
    if total == 1:
        return "the other"
    return f"each of the {total} others" if number == total else f"{number} of the {total} others"


def _farthest(entries: Sequence[Mapping[str, Any]]) -> str:
    """Name the learner that walks farthest in most gaits and worlds, or how far the only one is."""
    places: defaultdict[tuple[str, ...], list[Mapping[str, Any]]] = defaultdict(list)
    for one in entries:
        if one["role"] == "learner":
            places[tuple(one[field] for field in _PLACE)].append(one)
    learners = {one["agent"] for rivals in places.values() for one in rivals}
    if len(learners) == 1:
        (agent,) = learners
        return _walked(agent, [one for rivals in places.values() for one in rivals])
    # Where some have no trial yet, nobody is the farthest.
    whole = [rivals for rivals in places.values() if {x["agent"] for x in rivals} == learners]
    won = Counter(winner for rivals in whole if (winner := _winner(rivals)))
    if not won:
        return ""
    [(winner, number)] = won.most_common(1)
    rivals = f"Of {counted(len(learners), 'learner')} {title_of(winner)} walks farthest"
    if len(whole) == 1:
        return f"{rivals}."
    varied = [one for n, one in enumerate(_PLACE) if len({place[n] for place in places}) > 1]
    places_tried = f"{varied[0]}s" if len(varied) == 1 else f"combinations of {listed(varied)}"
    share = "all" if number == len(whole) else f"{number} of"
    return f"{rivals} in {share} {len(whole)} {places_tried}."


def _winner(rivals: Sequence[Mapping[str, Any]]) -> str | None:
    """Return the agent that is clearly ahead of all others; a learner may have several entries."""
    best = max(rivals, key=_distance_m)
    others = [_distance_m(one) for one in rivals if one["agent"] != best["agent"]]
    return best["agent"] if _distance_m(best) - max(others) >= LEVEL_M else None


def _distance_m(one: Mapping[str, Any]) -> float:
    return float(one["distance"]["iqm"])


def _walked(agent: str, entries: Sequence[Mapping[str, Any]]) -> str:
    """Return the shares of greedy's distance, first that of the place where it is highest."""
    known = [one for one in entries if one["of_greedy"]]
    if not known:
        return ""
    *others, best = sorted(known, key=lambda one: float(one["of_greedy"]["iqm"]))
    varied = [one for one in _PLACE if len({entry[one] for entry in entries}) > 1]
    share = percent(best["of_greedy"]["iqm"])
    if len(varied) == 1 and others and share != percent(others[-1]["of_greedy"]["iqm"]):
        place = _PLACE_NAMES[varied[0]](best[varied[0]])
        rest = "the other" if len(others) == 1 else "the others"
        return (
            f"{title_of(agent)} walks {share} of greedy's distance with {place}, and "
            f"{_range_of(others)} with {rest}."
        )
    return f"{title_of(agent)} walks {_range_of(known)} of greedy's distance."


def _range_of(entries: Sequence[Mapping[str, Any]]) -> str:
    shares_walked = sorted(one["of_greedy"]["iqm"] for one in entries)
    return " to ".join(dict.fromkeys(percent(one) for one in (shares_walked[0], shares_walked[-1])))
