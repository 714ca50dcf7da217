"""From trials to the summary: all that the report, the page and the terminal show."""

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from importlib.metadata import version
from itertools import combinations
from typing import Any, NamedTuple

from app.experiments.claims import judge
from app.experiments.claims_of import CLAIMS_OF
from app.experiments.config import GRID, ExperimentConfig, as_json
from app.experiments.measures import Stratum, Yardstick, beside, curve, distances, measures
from app.experiments.plan import Plan, Setting
from app.experiments.published import published
from app.experiments.statistics import Points, decided, improvement
from app.experiments.story import tell
from app.experiments.trial import TrialResult

FORMAT = 1
_LEAST_WALK = 0.5
"""Of half a grid side: a greedy agent that does not come so far in 50 steps is no yardstick."""


class _Seen(NamedTuple):
    """A setting and the results that there are, by seed number."""

    setting: Setting
    results: Mapping[int, TrialResult]

    @property
    def good(self) -> list[TrialResult]:
        return [self.results[n] for n in sorted(self.results) if not self.results[n].failure]

    @property
    def place(self) -> tuple[Any, ...]:
        """Where it is compared with others: (gait, observation, robot, divisions, side)."""
        at = self.setting.training
        return (
            self.setting.gait,
            at.observation,
            self.setting.robot,
            at.divisions,
            at.grid_side_m,
        )

    @property
    def rates(self) -> tuple[Any, ...]:
        """All of the practice but agent and place."""
        return (self.setting.trial.blocks, *(getattr(self.setting.training, n) for n in GRID))

    @property
    def total_m(self) -> Points:
        return tuple(one.distances_m[-1] for one in self.good if one.distances_m)

    @property
    def finished_m(self) -> Points:
        found = (one.finished_distance_m for one in self.good)
        return tuple(metres for metres in found if metres is not None)


def summarise(
    config: ExperimentConfig,
    results: Mapping[str, TrialResult],
    set_aside: Mapping[str, str] | None = None,
    cost: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """What the trials show, so far; the same for the same trials, in whichever order they came.

    Args:
        config: the experiment.
        results: by trial key; those that are not there yet are simply missing.
        set_aside: why, by trial key, of trials that cannot be done.
        cost: wall_s, compute_s, trials_per_s and workers of the run, if they are known.

    Returns:
        plain types, fit for JSON: `trials`, one entry in `settings` for each setting and in
        `pooled` for each over its gaits, `curves` where there are blocks, `versus` where several
        agents learn, `timed` where the wall clock was read, and `claims` and `story` in words.
        What cannot be said yet is None, or an empty list.
    """
    plan = _plan(config)
    seen = _sorted_out(plan, results)
    yardsticks = {one.place: _yardstick(one) for one in seen if _is_greedy(one)}
    walked = [one for one in seen if one.setting.role != "timed"]
    shown: dict[str, Any] = {
        "format": FORMAT,
        "experiment": config.experiment,
        "config": as_json(config),
        "versions": _versions(),
        "machine": {"platform": platform.platform(), "cores": os.cpu_count()},
        "trials": _count(plan, results, set_aside or {}),
        "cost": None if cost is None else dict(cost),
        "settings": [_setting(one, yardsticks, config) for one in walked],
        "pooled": _pooled(walked, yardsticks, config.seed),
        "curves": [
            _curve(one, yardsticks, config.seed) for one in walked if one.setting.trial.blocks > 1
        ],
        "versus": _versus(walked, config.seed),
        "timed": [_timed(one) for one in seen if one.setting.role == "timed" and one.good],
    }
    shown["claims"] = judge(shown, CLAIMS_OF[config.experiment])
    shown["story"] = tell(shown)
    return shown


@lru_cache(maxsize=8)
def _plan(config: ExperimentConfig) -> Plan:
    """Laying out a large grid takes longer than to count its first trials."""
    return Plan(config)


def _sorted_out(plan: Plan, results: Mapping[str, TrialResult]) -> list[_Seen]:
    found: dict[str, dict[int, TrialResult]] = {setting.key: {} for setting in plan.settings}
    for key, result in results.items():
        setting, _, number = key.rpartition("#")
        if setting in found and int(number) < plan.config.seeds:
            found[setting][int(number)] = result
    return [_Seen(setting, found[setting.key]) for setting in plan.settings]


def _is_greedy(one: _Seen) -> bool:
    return one.setting.role == "reference" and one.setting.training.agent == "greedy"


def _yardstick(greedy: _Seen) -> Yardstick:
    least_m = _LEAST_WALK * greedy.setting.training.grid_side_m / 2
    total = next((metres for metres in greedy.total_m if metres > least_m), None)
    finished = next((metres for metres in greedy.finished_m if metres > least_m), None)
    return Yardstick(total, finished)


def _setting(
    one: _Seen, yardsticks: Mapping[Any, Yardstick], config: ExperimentConfig
) -> dict[str, Any]:
    stratum = Stratum(one.total_m, one.finished_m, yardsticks.get(one.place, Yardstick()))
    practised = one.setting.training.steps if one.setting.role == "learner" else 0
    cell = published(one.setting.gait, one.setting.training.agent, practised)
    printed = beside(cell, stratum.total_m, stratum.finished_m)
    elapsed = [result.elapsed_s for result in one.good if result.elapsed_s is not None]
    return {
        "key": one.setting.key,
        "role": one.setting.role,
        **_named(one),
        "n": len(stratum.total_m),
        "failed": len(one.results) - len(one.good),
        "total": distances(stratum.total_m, config.seed),
        "finished": distances(stratum.finished_m, config.seed),
        **measures([stratum], config.seed),
        "elapsed_s": elapsed[0] if elapsed and one.setting.role == "reference" else None,
        "published": printed if config.experiment == "table1" else None,
    }


def _named(one: _Seen) -> dict[str, Any]:
    """What tells a setting from the others; an agent that looks ahead has no rates."""
    at = one.setting.training
    practises = one.setting.role == "learner"
    rates = {name: getattr(at, name) if practises else None for name in GRID}
    return {
        "gait": one.setting.gait,
        "observation": at.observation,
        "robot": one.setting.robot,
        "agent": at.agent,
        **rates,
        "steps": at.steps if practises else 0,
        "blocks": one.setting.trial.blocks,
        "divisions": at.divisions,
        "grid_side_m": at.grid_side_m,
        "half_side_m": at.grid_side_m / 2,
    }


def _pooled(
    seen: Sequence[_Seen], yardsticks: Mapping[Any, Yardstick], seed: int
) -> list[dict[str, Any]]:
    """Learners over their gaits, which are the strata of the bootstrap."""
    found = []
    for together in _grouped(one for one in seen if one.setting.role == "learner"):
        strata = [
            Stratum(one.total_m, one.finished_m, yardsticks.get(one.place, Yardstick()))
            for one in together
        ]
        named = {k: v for k, v in _named(together[0]).items() if k != "gait"}
        gaits = [one.setting.gait for one in together]
        n = sum(len(one.total_m) for one in strata)
        found.append({**named, "gaits": gaits, "n": n, **measures(strata, seed)})
    return found


def _grouped(seen: Iterable[_Seen]) -> list[list[_Seen]]:
    """Settings that are alike in all but the gait."""
    groups: dict[Any, list[_Seen]] = {}
    for one in seen:
        alike = (one.place[1:], one.setting.training.agent, one.rates)
        groups.setdefault(alike, []).append(one)
    return list(groups.values())


def _curve(one: _Seen, yardsticks: Mapping[Any, Yardstick], seed: int) -> dict[str, Any]:
    greedy = yardsticks.get(one.place, Yardstick())
    blocks = list(zip(*(result.distances_m for result in one.good), strict=True))
    block = one.setting.training.steps
    shown = curve(blocks, block, greedy, seed)
    return {"key": one.setting.key, **_named(one), **shown, "greedy_m": greedy.total_m}


def _versus(seen: Sequence[_Seen], seed: int) -> list[dict[str, Any]]:
    """Every two agents that learn, after the same practice in the same place."""
    groups: dict[Any, list[_Seen]] = {}
    for one in seen:
        if one.setting.role == "learner" and one.total_m:
            groups.setdefault((one.place, one.rates), []).append(one)
    found = []
    for a, b in (pair for group in groups.values() for pair in combinations(group, 2)):
        chance = improvement((a.total_m,), (b.total_m,), seed)
        named = {k: v for k, v in _named(a).items() if k != "agent"}
        agents = {"a": a.setting.training.agent, "b": b.setting.training.agent}
        fewest = min(len(a.total_m), len(b.total_m))
        found.append(
            {
                **named,
                **agents,
                "probability": chance.value,
                "low": chance.low,
                "high": chance.high,
                "verdict": decided(chance, 0.5, fewest),
            }
        )
    return found


def _timed(one: _Seen) -> dict[str, Any]:
    lanes = [dict(lane) for lane in one.good[0].wall or ()]
    named = _named(one)
    return {**{k: named[k] for k in ("gait", "observation", "robot")}, "lanes": lanes}


def _count(
    plan: Plan, results: Mapping[str, TrialResult], set_aside: Mapping[str, str]
) -> dict[str, Any]:
    broken = [{"key": k, "reason": r.failure} for k, r in results.items() if r.failure]
    return {
        "done": len(results),
        "total": plan.total,
        "failed": len(broken),
        "failures": sorted(broken, key=lambda one: str(one["key"])),
        "set_aside": [{"key": key, "reason": why} for key, why in sorted(set_aside.items())],
    }


@lru_cache(maxsize=1)
def _versions() -> dict[str, str]:
    packages = ("racing-hexapods", "numpy", "scipy", "matplotlib")
    found = {name: version(name) for name in packages}
    return {**found, "python": platform.python_version(), "mujoco": version("mujoco-core")}
