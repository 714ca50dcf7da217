"""From trials to the summary: all that the report, the page and the terminal show."""

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from importlib.metadata import version
from itertools import combinations
from typing import Any

from app.experiments.claims import CLAIMS_OF
from app.experiments.claims.judging import judge
from app.experiments.config import ExperimentConfig, as_json
from app.experiments.measures import Reference, compare_with_published, curve, distances, measures
from app.experiments.narrative.narrative import tell
from app.experiments.plan import Plan
from app.experiments.published import published
from app.experiments.setting_results import (
    SettingResults,
    named,
    sorted_out,
    stratum,
    yardsticks_of,
)
from app.experiments.statistics import decided, improvement
from app.experiments.trial import TrialResult

FORMAT = 1


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
    seen = sorted_out(plan, results)
    yardsticks = yardsticks_of(seen)
    walked = [one for one in seen if one.setting.role != "timed"]
    shown: dict[str, Any] = {
        "format": FORMAT,
        "experiment": config.experiment,
        "config": as_json(config),
        "versions": _versions(),
        "machine": {"platform": platform.platform(), "cores": os.cpu_count()},
        "trials": _count(plan, seen, set_aside or {}),
        "cost": None if cost is None else dict(cost),
        "settings": [_setting(one, yardsticks, config) for one in walked],
        "pooled": _pooled(walked, yardsticks, config),
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


def _setting(
    one: SettingResults, yardsticks: Mapping[Any, Reference], config: ExperimentConfig
) -> dict[str, Any]:
    seeds = stratum(one, yardsticks)
    practised = one.setting.training.steps if one.setting.role == "learner" else 0
    cell = published(one.setting.gait, one.setting.training.agent, practised)
    printed = compare_with_published(cell, seeds.total_m, seeds.finished_m)
    elapsed = [result.elapsed_s for result in one.good if result.elapsed_s is not None]
    return {
        "key": one.setting.key,
        "role": one.setting.role,
        **named(one),
        "n": len(seeds.total_m),
        "failed": len(one.results) - len(one.good),
        "total": distances(seeds.total_m, config.seed),
        "finished": distances(seeds.finished_m, config.seed),
        **measures([seeds], config.seed),
        "elapsed_s": elapsed[0] if elapsed and one.setting.role == "reference" else None,
        "published": printed if config.experiment == "table1" else None,
    }


def _pooled(
    seen: Sequence[SettingResults], yardsticks: Mapping[Any, Reference], config: ExperimentConfig
) -> list[dict[str, Any]]:
    """Learners over their gaits, which are the strata of the bootstrap.

    Outside Table 1 also who looks ahead, unless it is greedy: without an interval or shares,
    because a gait is not a seed.
    """
    found = []
    for together in _grouped(one for one in seen if _is_compared(one, config)):
        strata = [stratum(one, yardsticks) for one in together]
        shown = {k: v for k, v in named(together[0]).items() if k != "gait"}
        gaits = [one.setting.gait for one in together]
        n = sum(len(one.total_m) for one in strata)
        measured = measures(strata, config.seed)
        if together[0].setting.role == "reference":
            measured = {k: v if k.startswith("relative") else None for k, v in measured.items()}
        found.append({**shown, "gaits": gaits, "n": n, **measured})
    return found


def _is_compared(one: SettingResults, config: ExperimentConfig) -> bool:
    agent = one.setting.training.agent
    return one.setting.role == "learner" or (config.experiment != "table1" and agent != "greedy")


def _grouped(seen: Iterable[SettingResults]) -> list[list[SettingResults]]:
    """Settings that are alike in all but the gait."""
    groups: dict[Any, list[SettingResults]] = {}
    for one in seen:
        alike = (one.place[1:], one.setting.training.agent, one.rates)
        groups.setdefault(alike, []).append(one)
    return list(groups.values())


def _curve(one: SettingResults, yardsticks: Mapping[Any, Reference], seed: int) -> dict[str, Any]:
    greedy = yardsticks.get(one.place, Reference())
    blocks = list(zip(*(result.distances_m for result in one.good), strict=True))
    block = one.setting.training.steps
    shown = curve(blocks, block, greedy, seed)
    return {"key": one.setting.key, **named(one), **shown, "greedy_m": greedy.total_m}


def _versus(seen: Sequence[SettingResults], seed: int) -> list[dict[str, Any]]:
    """Every two agents that learn, after the same practice in the same place."""
    groups: dict[Any, list[SettingResults]] = {}
    for one in seen:
        if one.setting.role == "learner" and one.total_m:
            groups.setdefault((one.place, one.rates), []).append(one)
    found = []
    for a, b in (pair for group in groups.values() for pair in combinations(group, 2)):
        chance = improvement((a.total_m,), (b.total_m,), seed)
        shared = {k: v for k, v in named(a).items() if k != "agent"}
        agents = {"a": a.setting.training.agent, "b": b.setting.training.agent}
        fewest = min(len(a.total_m), len(b.total_m))
        found.append(
            {
                **shared,
                **agents,
                "probability": chance.value,
                "low": chance.low,
                "high": chance.high,
                "verdict": decided(chance, 0.5, fewest),
            }
        )
    return found


def _timed(one: SettingResults) -> dict[str, Any]:
    lanes = [dict(lane) for lane in one.good[0].wall or ()]
    shown = named(one)
    return {**{k: shown[k] for k in ("gait", "observation", "robot")}, "lanes": lanes}


def _count(
    plan: Plan, seen: Sequence[SettingResults], set_aside: Mapping[str, str]
) -> dict[str, Any]:
    broken = [
        {"key": f"{one.setting.key}#{number}", "reason": result.failure}
        for one in seen
        for number, result in sorted(one.results.items())
        if result.failure
    ]
    return {
        "done": sum(len(one.results) for one in seen),
        "total": plan.total,
        "failed": len(broken),
        "failures": broken,
        "set_aside": [{"key": key, "reason": why} for key, why in sorted(set_aside.items())],
    }


@lru_cache(maxsize=1)
def _versions() -> dict[str, str]:
    packages = ("racing-hexapods", "numpy", "scipy", "matplotlib")
    found = {name: version(name) for name in packages}
    return {**found, "python": platform.python_version(), "mujoco": version("mujoco-core")}
