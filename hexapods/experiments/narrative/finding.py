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
"""Least difference of two distances that counts as farther [m]."""
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
    pools = [(case, pool) for case in cases for pool in case.pooled if pool["walkers"]]
    if len(pools) < 2:
        return ""
    case, best = max(pools, key=lambda pool: float(pool[1]["relative"]["iqm"]))
    rest = [pool for _, pool in pools if pool is not best]
    place = f" with {case.label}" if len(cases) > 1 else ""
    name = f"{combination_name(best, case, [pool for _, pool in pools])}{place}"
    share = f"{shares(best['relative'])} of greedy's distance"
    if best["relative"]["low"] is None:
        return f"{name} leads with {share}; so few seeds tell little."
    low = best["relative"]["low"]
    equals = sum(_reaches(pool["relative"], low) for pool in rest)  # whole numbers
    if not equals:
        return f"{name} walks farthest: {share}."
    return f"{name} leads with {share}; {_some_of(equals, len(rest))} may be as good."


def _reaches(share: Mapping[str, Any], low: float) -> bool:
    return share["high"] is None or share["high"] >= low


def _some_of(number: int, total: int) -> str:
    if total == 1:
        return "the other"
    return f"each of the {total} others" if number == total else f"{number} of the {total} others"


def _farthest(entries: Sequence[Mapping[str, Any]]) -> str:
    """Name the learner that walks farthest in most gaits and worlds, or how far the only one is."""
    places: defaultdict[tuple[str, ...], list[Mapping[str, Any]]] = defaultdict(list)
    for entry in entries:
        if entry["role"] == "learner":
            places[tuple(entry[field] for field in _PLACE)].append(entry)
    learners = {entry["agent"] for rivals in places.values() for entry in rivals}
    if len(learners) == 1:
        (agent,) = learners
        return _walked(agent, [entry for rivals in places.values() for entry in rivals])
    # A place where a learner has no trial yet has no winner.
    whole = [rivals for rivals in places.values() if {x["agent"] for x in rivals} == learners]
    won = Counter(winner for rivals in whole if (winner := _winner(rivals)))
    if not won:
        return ""
    [(winner, number)] = won.most_common(1)
    rivals = f"Of {counted(len(learners), 'learner')} {title_of(winner)} walks farthest"
    if len(whole) == 1:
        return f"{rivals}."
    varied = [field for n, field in enumerate(_PLACE) if len({place[n] for place in places}) > 1]
    places_tried = f"{varied[0]}s" if len(varied) == 1 else f"combinations of {listed(varied)}"
    share = "all" if number == len(whole) else f"{number} of"
    return f"{rivals} in {share} {len(whole)} {places_tried}."


def _winner(rivals: Sequence[Mapping[str, Any]]) -> str | None:
    """Return the agent that is clearly ahead of all others; a learner may have several entries."""
    best = max(rivals, key=_distance_m)
    distances = [_distance_m(entry) for entry in rivals if entry["agent"] != best["agent"]]
    return best["agent"] if _distance_m(best) - max(distances) >= LEVEL_M else None


def _distance_m(entry: Mapping[str, Any]) -> float:
    return float(entry["distance"]["iqm"])


def _walked(agent: str, entries: Sequence[Mapping[str, Any]]) -> str:
    """Return the shares of greedy's distance, first that of the place where it is highest."""
    compared = [entry for entry in entries if entry["of_greedy"]]
    if not compared:
        return ""
    *rest_entries, best = sorted(compared, key=lambda entry: float(entry["of_greedy"]["iqm"]))
    varied = [field for field in _PLACE if len({entry[field] for entry in entries}) > 1]
    share = percent(best["of_greedy"]["iqm"])
    if len(varied) == 1 and rest_entries and share != percent(rest_entries[-1]["of_greedy"]["iqm"]):
        place = _PLACE_NAMES[varied[0]](best[varied[0]])
        rest = "the other" if len(rest_entries) == 1 else "the others"
        return (
            f"{title_of(agent)} walks {share} of greedy's distance with {place}, and "
            f"{_range_of(rest_entries)} with {rest}."
        )
    return f"{title_of(agent)} walks {_range_of(compared)} of greedy's distance."


def _range_of(entries: Sequence[Mapping[str, Any]]) -> str:
    shares_walked = sorted(entry["of_greedy"]["iqm"] for entry in entries)
    return " to ".join(
        dict.fromkeys(percent(share) for share in (shares_walked[0], shares_walked[-1]))
    )
