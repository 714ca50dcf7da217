"""The report's tables as formatted cells."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from hexapods.agents.appearance import title_of
from hexapods.domain.text import metres
from hexapods.experiments.claims.cases import Case, case_label
from hexapods.experiments.formatting import number, percent, shares
from hexapods.experiments.labels import (
    OBSERVATION_LABELS,
    gait_name,
    gait_name_with_papers,
    robot_name,
    world_name,
)
from hexapods.experiments.measures import REACHED_SHARE
from hexapods.experiments.narrative.sweep import combination_name
from hexapods.experiments.plan import EARNING_STEPS
from hexapods.experiments.published import COLUMNS, DISTANCES, published
from hexapods.experiments.statistics import CONFIDENCE
from hexapods.experiments.worlds import RECOVERY_SHARE
from hexapods.runs.lane import PLANNING_MODEL_TITLES, PlanningModel

UNITS: Mapping[str, str] = {
    "m": "metres",
    "h": "half grid sides",
    "r": "of greedy",
}
MAX_ROWS = 200
_DISTANCE_NAMES: Mapping[str, str] = {"finished": "At time-out", "total": "Total"}
_NONE = "–"


class Number(NamedTuple):
    """A value formatted in one unit."""

    unit: str
    value: str
    span: str
    """Its interval; empty without one."""
    printed: str
    """The paper's value; empty if it has none."""


class Cell(NamedTuple):
    """A cell of Table 1: our value in each unit, with the paper's."""

    numbers: Sequence[Number]
    quantile: str
    """`P10`: 10 % of our seeds lie below the printed value; empty without one."""
    outside: bool
    """Whether the printed value lies outside the central 95 % of our seeds."""


def table1(case: Case) -> dict[str, Any]:
    """Build the paper's Table 1 for a case: for each gait a row per kind of distance."""
    steps = {one["steps"] for one in case.settings if one["role"] == "learner"}
    columns = [one for one in COLUMNS if one[1] in steps or not one[1]]
    gaits = dict.fromkeys(one["gait"] for one in case.settings)
    return {
        "label": case.label,
        "columns": [*(name for _, _, name in columns), "Best known"],
        "gaits": [
            {
                "name": gait_name_with_papers(gait),
                "rows": [
                    {
                        "name": _DISTANCE_NAMES[kind],
                        "cells": [
                            *(_table1_cell(case, gait, kind, agent, n) for agent, n, _ in columns),
                            _best_known_cell(case, gait, kind),
                        ],
                    }
                    for kind in DISTANCES
                ],
            }
            for gait in gaits
        ],
    }


def _table1_cell(case: Case, gait: str, kind: str, agent: str, steps: int) -> Cell:
    one, greedy = case.setting(gait, steps, agent), case.setting(gait, 0, "greedy")
    distances = one[kind] if one else None
    half_m = next(s["half_side_m"] for s in case.settings)
    papers = _papers_value(gait, kind, agent, steps)
    numbers = []
    for unit, by, papers_by in (
        ("m", 1.0, 1.0),
        ("h", half_m, half_m),
        ("r", _iqm_m(greedy, kind), _papers_value(gait, kind, "greedy", 0)),
    ):
        value, span = _in_unit(unit, distances, by)
        numbers.append(Number(unit, value, span, _printed_text(unit, papers, papers_by, gait)))
    quantile = one["published"][f"{kind}_quantile"] if one and one["published"] else None
    tail = (1 - CONFIDENCE) / 2
    return Cell(
        numbers,
        "" if quantile is None else f"P{100 * quantile:.0f}",
        quantile is not None and not tail <= quantile <= 1 - tail,
    )


def _best_known_cell(case: Case, gait: str, kind: str) -> Cell:
    """Return the best known distance of 50 steps; there is none at time-out."""
    one = next(s for s in case.settings if s["gait"] == gait)
    best_m = one["best_known_m"] if kind == "total" else None
    greedy_m = _iqm_m(case.setting(gait, 0, "greedy"), kind)
    units = (("m", 1.0), ("h", one["half_side_m"]), ("r", greedy_m))
    values = [(unit, _format(unit, best_m / by) if best_m and by else _NONE) for unit, by in units]
    return Cell([Number(unit, value, "", "") for unit, value in values], "", False)


def _in_unit(unit: str, distances: Mapping[str, Any] | None, by: float | None) -> tuple[str, str]:
    if distances is None or not by:
        return _NONE, ""
    value = _format(unit, distances["iqm_m"] / by)
    if distances["low_m"] is None:
        return value, ""
    return value, _range_text(*(_format(unit, distances[end] / by) for end in ("low_m", "high_m")))


def _range_text(low: str, high: str) -> str:
    """Join an interval's limits, with "to" before a negative limit, where a dash is unreadable."""
    low = low.removesuffix("\u00a0%")
    return f"{low} to {high}" if "−" in low else f"{low}–{high}"


def _format(unit: str, value: float) -> str:
    if unit == "r":
        return percent(value)
    return number(value, 2 if unit == "m" else 1)


def _printed_text(unit: str, papers: float | None, by: float | None, gait: str) -> str:
    if papers is None:
        return "" if published(gait, "two-step", 0) is None else "unfinished"
    if not by:
        return ""
    return f"{papers:g}" if unit == "m" else _format(unit, papers / by)


def _papers_value(gait: str, kind: str, agent: str, steps: int) -> float | None:
    cell = published(gait, agent, steps)
    return None if cell is None else (cell.total_m if kind == "total" else cell.finished_m)


def _iqm_m(one: Mapping[str, Any] | None, kind: str) -> float | None:
    return float(one[kind]["iqm_m"]) if one and one[kind] else None


def curves(case: Case) -> dict[str, Any]:
    """Build the table of Figure 4: one row per curve, at a few steps of practice."""
    drawn = [one for one in case.curves if one["steps"]]
    steps = drawn[0]["steps"] if drawn else []
    chosen = [at for at in (250, 500, 1000, 2000) if at in steps] or steps
    several = len({one["agent"] for one in drawn}) > 1
    return {
        "label": case.label,
        "columns": [f"{at:,} steps" for at in chosen] + ["Walk", "Greedy", "Best known"],
        "rows": [
            {
                "name": gait_name(one["gait"]) + (f", {title_of(one['agent'])}" if several else ""),
                "cells": [_curve_cell(one, steps.index(at)) for at in chosen]
                + [
                    (_NONE if one["walkers"][-1] is None else percent(one["walkers"][-1]), ""),
                    *(
                        (_NONE if one[field] is None else number(one[field]), "")
                        for field in ("greedy_m", "best_known_m")
                    ),
                ],
            }
            for one in drawn
        ],
        "left_out": 0,
    }


def _curve_cell(curve: Mapping[str, Any], block: int) -> tuple[str, str]:
    value, low, high = curve["iqm_m"][block], curve["low_m"][block], curve["high_m"][block]
    return number(value), "" if low is None else _range_text(number(low), number(high))


def worlds(summary: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Build the tables of a league or recovery: one for each world and gait, best first."""
    groups: dict[tuple[str, ...], list[Mapping[str, Any]]] = {}
    for one in summary.get("worlds", ()):
        groups.setdefault(place_of(one), []).append(one)
    is_recovery = summary["experiment"] == "recovery"
    return [_world_table(rows, is_recovery, summary) for rows in groups.values()]


def place_of(one: Mapping[str, Any]) -> tuple[str, str, str, str]:
    """Return where an agent walks: world, gait, observation and robot."""
    return one["world"], one["gait"], one["observation"], one["robot"]


def place_name(place: tuple[str, ...], summary: Mapping[str, Any]) -> str:
    """Describe a world and gait, with observation and robot where there are several."""
    world, gait, observation, robot = place
    names = [world_name(world), gait_name(gait)]
    config = summary["config"]
    reading = OBSERVATION_LABELS.get(observation, observation)
    names += [reading] if len(config["observations"]) > 1 else []
    names += [robot_name(robot)] if len(config["robots"]) > 1 else []
    return ", ".join(names)


def agent_name(one: Mapping[str, Any]) -> str:
    """Return an agent's title, and of a searcher the model that it plans with."""
    known: PlanningModel | None = one["plans_with"]
    return title_of(one["agent"]) + ("" if known is None else f", {PLANNING_MODEL_TITLES[known]}")


def _world_table(
    rows: Sequence[Mapping[str, Any]], is_recovery: bool, summary: Mapping[str, Any]
) -> dict[str, Any]:
    best_m = rows[0]["best_known_m"]
    known = "" if best_m is None else f"; best known {metres(best_m)}"
    ordered = sorted(rows, key=lambda one: -float(one["distance"]["iqm"]))
    learner = next((one for one in rows if one["curve"]), None)
    at: list[int] = learner["curve"]["steps"] if learner and is_recovery else []
    share = percent(RECOVERY_SHARE if is_recovery else REACHED_SHARE)
    columns = [f"After {step:,}" for step in at] or ["Distance", "Mean over practice"]
    earning = [step for step in at if step % EARNING_STEPS == 0]
    columns += [f"Earned in {step + 1:,}–{step + EARNING_STEPS:,}" for step in earning]
    columns += [
        "Of greedy",
        "Of best known",
        f"Steps to {share} of greedy",
        f"Steps to {share} of best known",
        "Seeds",
    ]
    return {
        "label": f"{place_name(place_of(rows[0]), summary)}{known}",
        "columns": columns,
        "rows": [
            {
                "name": agent_name(one),
                "cells": [
                    *_distance_cells(one, at),
                    *(
                        _curve_cell(one["earned"], at.index(step)) if one["earned"] else (_NONE, "")
                        for step in earning
                    ),
                    share_cell(one["of_greedy"], "iqm"),
                    share_cell(one["of_best_known"], "iqm"),
                    _until_cell(one["until_greedy"]),
                    _until_cell(one["until_best_known"]),
                    (f"{one['n']:,}", ""),
                ],
            }
            for one in ordered
        ],
        "left_out": 0,
    }


def _distance_cells(one: Mapping[str, Any], at: Sequence[int]) -> list[tuple[str, str]]:
    """Return the distances at the evaluations of a recovery, or the last and the mean [m]."""
    if at and one["curve"]:
        return [_curve_cell(one["curve"], place) for place in range(len(at))]
    if at:
        return [(_NONE, "")] * (len(at) - 1) + [interval_cell(one["distance"])]
    return [interval_cell(one["distance"]), interval_cell(one["mean_m"])]


def interval_cell(middle: Mapping[str, Any] | None) -> tuple[str, str]:
    """Return a distance and its interval as text [m]."""
    if middle is None:
        return _NONE, ""
    low, high = middle["low"], middle["high"]
    return number(middle["iqm"]), "" if low is None else _range_text(number(low), number(high))


def _until_cell(until: Mapping[str, Any] | None) -> tuple[str, str]:
    if until is None:
        return _NONE, ""
    steps = until["median_steps"]
    value = "not reached" if steps is None else f"{steps:,.0f}"
    return value, f"by {percent(until['reached'])}"


def sweep(case: Case) -> dict[str, Any]:
    """Build the table of a sweep: every combination over all gaits, best first."""
    pools = [one for one in case.pooled if one["relative"]]
    best = sorted(pools, key=lambda one: -float(one["relative"]["iqm"]))
    return {
        "label": case.label,
        "columns": ["Of greedy's distance", "Of best known", "Walk", "Ahead at time-out", "Seeds"],
        "rows": [
            {
                "name": combination_name(one, case),
                "cells": [
                    share_cell(one["relative"], "iqm"),
                    share_cell(one["of_best_known"], "iqm"),
                    share_cell(one["walkers"]),
                    share_cell(one["beats_greedy"]),
                    (f"{one['n']:,}", ""),
                ],
            }
            for one in best[:MAX_ROWS]
        ],
        "left_out": max(0, len(best) - MAX_ROWS),
    }


def share_cell(share: Mapping[str, Any] | None, middle: str = "share") -> tuple[str, str]:
    """Return a share, which has the name `middle`, and its interval as text."""
    if share is None:
        return _NONE, ""
    low, high = share["low"], share["high"]
    value = percent(share[middle])
    return value, "" if low is None else _range_text(*(number(100 * end, 0) for end in (low, high)))


def versus(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Build the table of pairs of learning agents, with the probability of improvement."""
    furthest = {"yes": "the first", "no": "the second", "not established": "not established"}
    pairs = summary["versus"]
    return {
        "label": "",
        "columns": ["Probability", "Further"],
        "rows": [
            {
                "name": f"{title_of(one['a'])} before {title_of(one['b'])}, "
                f"{gait_name(one['gait'])}, {case_label(one['observation'], one['robot'])}, "
                f"{one['blocks'] * one['steps']:,} steps",
                "cells": [
                    (shares({**one, "share": one["probability"]}), ""),
                    (furthest[one["verdict"]], ""),
                ],
            }
            for one in pairs[:MAX_ROWS]
        ],
        "left_out": max(0, len(pairs) - MAX_ROWS),
    }
