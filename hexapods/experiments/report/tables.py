"""The report's tables as formatted cells."""

from collections.abc import Callable, Mapping, Sequence
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
from hexapods.experiments.narrative.sweep import combination_name
from hexapods.experiments.plan import EARNING_STEPS
from hexapods.experiments.presets import PRESETS
from hexapods.experiments.published import COLUMNS, DISTANCES, published
from hexapods.experiments.statistics import CONFIDENCE, Interval
from hexapods.runs.lane import PLANNING_MODEL_TITLES, PlanningModel

UNITS: Mapping[str, str] = {
    "m": "metres",
    "h": "half grid sides",
    "r": "of greedy",
}
MAX_ROWS = 200
_DISTANCE_NAMES: Mapping[str, str] = {"finished": "At time-out", "total": "Total"}
Cell = tuple[str, str]
"""A value and its interval as text; the second is empty without one."""
NOTHING: Cell = ("–", "")


class Table(NamedTuple):
    """A table with a name at the beginning of each row."""

    label: str
    columns: Sequence[str]
    rows: Sequence[tuple[str, Sequence[Cell]]]
    left_out: int = 0
    """Number of further rows, which are in the summary only."""


class Number(NamedTuple):
    """A value formatted in one unit."""

    unit: str
    value: str
    span: str
    """Its interval; empty without one."""
    printed: str
    """The paper's value; empty if it has none."""


class PaperCell(NamedTuple):
    """A cell of Table 1: our value in each unit, with the paper's."""

    numbers: Sequence[Number]
    quantile: str = ""
    """`P10`: 10 % of our seeds lie below the printed value; empty without one."""
    outside: bool = False
    """Whether the printed value lies outside the central 95 % of our seeds."""


class PaperTable(NamedTuple):
    """Table 1: for each gait a row per kind of distance."""

    label: str
    columns: Sequence[str]
    gaits: Sequence[tuple[str, Sequence[tuple[str, Sequence[PaperCell]]]]]


def cell(
    estimate: Interval | Mapping[str, Any] | None,
    form: Callable[[float], str] = number,
    form_of_limits: Callable[[float], str] | None = None,
) -> Cell:
    """Return an estimate and its interval as text.

    Args:
        estimate: an interval, or an entry of a summary that has one.
        form: formats a number.
        form_of_limits: formats the limits; by default `form`.
    """
    if estimate is None:
        return NOTHING
    value, *limits = Interval.of(estimate)
    texts = [(form_of_limits or form)(limit) for limit in limits if limit is not None]
    return form(value), _range_text(*texts) if texts else ""


def share_cell(share: Mapping[str, Any] | None) -> Cell:
    """Return a share and its interval as text."""
    return cell(share, percent, lambda limit: number(100 * limit, 0))


def table1(case: Case) -> PaperTable:
    """Build the paper's Table 1 for a case."""
    steps = {one["steps"] for one in case.settings if one["role"] == "learner"}
    columns = [one for one in COLUMNS if one[1] in steps or not one[1]]

    def row(gait: str, kind: str) -> tuple[str, Sequence[PaperCell]]:
        cells = [_table1_cell(case, gait, kind, agent, n) for agent, n, _ in columns]
        return _DISTANCE_NAMES[kind], [*cells, _best_known_cell(case, gait, kind)]

    gaits = dict.fromkeys(one["gait"] for one in case.settings)
    return PaperTable(
        case.label,
        [*(name for _, _, name in columns), "Best known"],
        [(gait_name_with_papers(gait), [row(gait, kind) for kind in DISTANCES]) for gait in gaits],
    )


def _table1_cell(case: Case, gait: str, kind: str, agent: str, steps: int) -> PaperCell:
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
        ours = _in_unit(unit, distances, by)
        numbers.append(Number(unit, *ours, _printed_text(unit, papers, papers_by, gait)))
    quantile = one["published"][f"{kind}_quantile"] if one and one["published"] else None
    if quantile is None:
        return PaperCell(numbers)
    tail = (1 - CONFIDENCE) / 2
    return PaperCell(numbers, f"P{100 * quantile:.0f}", not tail <= quantile <= 1 - tail)


def _best_known_cell(case: Case, gait: str, kind: str) -> PaperCell:
    """Return the best known distance of 50 steps; there is none at time-out."""
    one = next(s for s in case.settings if s["gait"] == gait)
    best_m = one["best_known_m"] if kind == "total" else None
    greedy_m = _iqm_m(case.setting(gait, 0, "greedy"), kind)
    units = (("m", 1.0), ("h", one["half_side_m"]), ("r", greedy_m))
    known = Interval(best_m) if best_m else None
    return PaperCell([Number(unit, *_in_unit(unit, known, by), "") for unit, by in units])


def _in_unit(unit: str, distance: Interval | Mapping[str, Any] | None, by: float | None) -> Cell:
    if distance is None or not by:
        return NOTHING
    return cell(distance, lambda value: _format(unit, value / by))


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


def curves(case: Case) -> Table:
    """Build the table of Figure 4: one row per curve, at a few steps of practice.

    Those of practices in one go follow the curves in blocks.
    """
    drawn = [one for one in (*case.curves, *case.in_one_go) if one["steps"]]
    steps = drawn[0]["steps"] if drawn else []
    chosen = [at for at in (250, 500, 1000, 2000) if at in steps] or steps
    several = len({one["agent"] for one in drawn}) > 1

    def row(one: Mapping[str, Any]) -> tuple[str, Sequence[Cell]]:
        name = gait_name(one["gait"]) + (f", {title_of(one['agent'])}" if several else "")
        name += ", in one go" if one["blocks"] == 1 else ""
        walkers = one["walkers"][-1]
        references = [one[field] for field in ("greedy_m", "best_known_m")]
        return name, [
            *(_curve_cell(one, steps.index(at)) for at in chosen),
            NOTHING if walkers is None else cell(Interval(walkers), percent),
            *(NOTHING if far_m is None else cell(Interval(far_m)) for far_m in references),
        ]

    columns = [f"{at:,} steps" for at in chosen] + ["Walk", "Greedy", "Best known"]
    return Table(case.label, columns, [row(one) for one in drawn])


def _curve_cell(curve: Mapping[str, Any], block: int) -> Cell:
    return cell(Interval(*(curve[name][block] for name in ("iqm_m", "low_m", "high_m"))))


def worlds(summary: Mapping[str, Any]) -> list[Table]:
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
) -> Table:
    best_m = rows[0]["best_known_m"]
    known = "" if best_m is None else f"; best known {metres(best_m)}"
    learner = next((one for one in rows if one["curve"]), None)
    at: list[int] = learner["curve"]["steps"] if learner and is_recovery else []
    share = percent(PRESETS[summary["experiment"]].reached_share)
    earning = [step for step in at if step % EARNING_STEPS == 0]
    columns = [
        *([f"After {step:,}" for step in at] or ["Distance", "Mean over practice"]),
        *(f"Earned in {step + 1:,}–{step + EARNING_STEPS:,}" for step in earning),
        "Of greedy",
        "Of best known",
        f"Steps to {share} of greedy",
        f"Steps to {share} of best known",
        "Seeds",
    ]

    def row(one: Mapping[str, Any]) -> tuple[str, Sequence[Cell]]:
        earned = one["earned"]
        return agent_name(one), [
            *_distance_cells(one, at),
            *(_curve_cell(earned, at.index(step)) if earned else NOTHING for step in earning),
            share_cell(one["of_greedy"]),
            share_cell(one["of_best_known"]),
            _until_cell(one["until_greedy"]),
            _until_cell(one["until_best_known"]),
            (f"{one['n']:,}", ""),
        ]

    ordered = sorted(rows, key=lambda one: -float(one["distance"]["iqm"]))
    label = f"{place_name(place_of(rows[0]), summary)}{known}"
    return Table(label, columns, [row(one) for one in ordered])


def _distance_cells(one: Mapping[str, Any], at: Sequence[int]) -> list[Cell]:
    """Return the distances at the evaluations of a recovery, or the last and the mean [m]."""
    if at and one["curve"]:
        return [_curve_cell(one["curve"], place) for place in range(len(at))]
    if at:
        return [NOTHING] * (len(at) - 1) + [cell(one["distance"])]
    return [cell(one["distance"]), cell(one["mean_m"])]


def _until_cell(until: Mapping[str, Any] | None) -> Cell:
    if until is None:
        return NOTHING
    steps = until["median_steps"]
    value = "not reached" if steps is None else f"{steps:,.0f}"
    return value, f"by {percent(until['reached'])}"


def sweep(case: Case) -> Table:
    """Build the table of a sweep: every combination over all gaits, best first."""
    pools = [one for one in case.pooled if one["relative"]]
    best = sorted(pools, key=lambda one: -float(one["relative"]["iqm"]))
    measures = ("relative", "of_best_known", "walkers", "beats_greedy")
    return Table(
        case.label,
        ["Of greedy's distance", "Of best known", "Walk", "Ahead at time-out", "Seeds"],
        [
            (
                combination_name(one, case),
                [*(share_cell(one[name]) for name in measures), (f"{one['n']:,}", "")],
            )
            for one in best[:MAX_ROWS]
        ],
        max(0, len(best) - MAX_ROWS),
    )


def versus(summary: Mapping[str, Any]) -> Table:
    """Build the table of pairs of learning agents, with the probability of improvement."""
    furthest = {"yes": "the first", "no": "the second", "not established": "not established"}
    pairs = summary["versus"]
    return Table(
        "",
        ["Probability", "Further"],
        [
            (
                f"{title_of(one['a'])} before {title_of(one['b'])}, "
                f"{gait_name(one['gait'])}, {case_label(one['observation'], one['robot'])}, "
                f"{one['blocks'] * one['steps']:,} steps",
                [(shares(one), ""), (furthest[one["verdict"]], "")],
            )
            for one in pairs[:MAX_ROWS]
        ],
        max(0, len(pairs) - MAX_ROWS),
    )
