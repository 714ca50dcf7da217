"""Build an experiment's summary from its trials: the data of the report, the page and the CLI."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import combinations
from typing import Any

from hexapods.domain.records import to_json
from hexapods.experiments.claims import CLAIMS
from hexapods.experiments.claims.judging import judge
from hexapods.experiments.config import SUMMARY_FORMAT, ExperimentConfig
from hexapods.experiments.measures import (
    WALKER_SHARE,
    best_known_relative,
    compare_with_published,
    curve_entry,
    measure_against_references,
    summarise_distances,
)
from hexapods.experiments.names import trial_names
from hexapods.experiments.narrative.finding import find
from hexapods.experiments.narrative.narrative import narrate
from hexapods.experiments.plan import Plan, is_deterministic
from hexapods.experiments.profiles import share_limits
from hexapods.experiments.published import published
from hexapods.experiments.setting_results import (
    SettingResults,
    group_by_setting,
    setting_fields,
)
from hexapods.experiments.statistics import bootstrap_exceeds, improvement, share_at_least
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.worker import versions
from hexapods.experiments.worlds import compare_in_worlds
from hexapods.machine import description

_DISTANCE_SHARES = ("relative", "relative_finished", "of_best_known")
"""Measures that are shares of a distance, other than shares of seeds."""


def summarise(
    config: ExperimentConfig,
    results: Mapping[str, TrialResult],
    set_aside: Mapping[str, str] | None = None,
    cost: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Summarise the trials completed so far; independent of the order of completion.

    Args:
        config: the experiment.
        results: results by trial key; trials not completed yet are missing.
        set_aside: reasons by trial key, of trials without a result.
        cost: wall_s, compute_s, trials_per_s and workers of the run, if known.

    Returns:
        Plain types, fit for JSON: `trials` (counts; `failed` are all without a distance, also those
        that were set aside), `settings` (one entry per setting), `pooled`
        (one per setting over its gaits), `curves` (learners in blocks and in one go),
        `versus` (pairs of learning agents), `timed` (races timed on this machine), `worlds`
        (agents along their practice, or after something happened, by world), and `claims`,
        `story` and `finding` as text; `share_limits`, of the bands of performance profiles. What
        cannot be computed yet is None, or empty.
    """
    plan = _plan(config)
    settings = group_by_setting(plan, results)
    walked = [entry for entry in settings if entry.setting.role != "timed"]
    aside = Counter(key.rpartition("#")[0] for key in set_aside or {})
    preset = config.preset
    summary: dict[str, Any] = {
        "format": SUMMARY_FORMAT,
        "experiment": config.experiment,
        "config": to_json(config),
        "versions": versions(),
        "machine": description(),
        "trials": _count_trials(plan, settings, set_aside or {}),
        "cost": None if cost is None else dict(cost),
        "parameters": list(plan.settings[0].parameters),
        "settings": [_setting(entry, config, aside[entry.setting.key]) for entry in walked],
        "pooled": _pooled(walked, config),
        "curves": [
            _curve(entry, config.seed)
            for entry in walked
            if entry.setting.role == "learner" and preset.measure == "blocks"
        ],
        "versus": [] if preset.has_worlds else _versus(walked, config.seed),
        "timed": [
            _timed(entry) for entry in settings if entry.setting.role == "timed" and entry.succeeded
        ],
        "worlds": compare_in_worlds(walked, config.seed, preset.reached_share)
        if preset.has_worlds
        else [],
    }
    summary["share_limits"] = share_limits({entry["n"] for entry in summary["settings"]})
    summary["claims"] = judge(summary, CLAIMS[preset.claims] if preset.claims else ())
    summary["story"] = narrate(summary, preset)
    summary["finding"] = find(summary, preset)
    return summary


@lru_cache(maxsize=8)
def _plan(config: ExperimentConfig) -> Plan:
    """Return the experiment's plan, cached: a large grid takes longer to plan than to summarise."""
    return Plan(config)


def _setting(results: SettingResults, config: ExperimentConfig, set_aside: int) -> dict[str, Any]:
    cell = published(
        results.setting.gait, results.setting.training.agent, results.setting.practised_steps
    )
    printed = compare_with_published(cell, results.total_m, results.finished_m)
    elapsed = [result.elapsed_s for result in results.succeeded if result.elapsed_s is not None]
    return {
        "key": results.setting.key,
        "role": results.setting.role,
        **setting_fields(results),
        "n": len(results.total_m),
        "seed_numbers": list(results.seed_numbers),
        "is_deterministic": is_deterministic(results.setting),
        "failed": len(results.results) - len(results.succeeded) + set_aside,
        "total": summarise_distances(results.total_m, config.seed),
        "finished": summarise_distances(results.finished_m, config.seed),
        "best_known_m": results.reference.best_known_m,
        **measure_against_references([results], config.seed),
        "elapsed_s": elapsed[0] if elapsed and results.setting.role == "reference" else None,
        "published": printed if config.preset.is_published else None,
    }


def _pooled(settings: Sequence[SettingResults], config: ExperimentConfig) -> list[dict[str, Any]]:
    """Measure each learner over its gaits, which are the strata of the bootstrap.

    Also search agents other than the references: without intervals or shares of seeds,
    since they have one result per gait, and a gait is not a seed.
    """
    entries = []
    for group in _group_by_gait(results for results in settings if _is_compared(results, config)):
        shared = {k: v for k, v in setting_fields(group[0]).items() if k != "gait"}
        gaits = [results.setting.gait for results in group]
        n = sum(len(results.total_m) for results in group)
        measured = measure_against_references(group, config.seed)
        if group[0].setting.role == "reference":
            measured = {k: v if k in _DISTANCE_SHARES else None for k, v in measured.items()}
        best_known = best_known_relative(group)
        entries.append(
            {**shared, "gaits": gaits, "n": n, "best_known_relative": best_known, **measured}
        )
    return entries


def _is_compared(results: SettingResults, config: ExperimentConfig) -> bool:
    agent = results.setting.training.agent
    return results.setting.role == "learner" or agent not in config.preset.references


def _group_by_gait(settings: Iterable[SettingResults]) -> list[list[SettingResults]]:
    """Group settings that differ only in the gait."""
    groups: dict[Any, list[SettingResults]] = {}
    for results in settings:
        alike = (results.conditions[1:], results.setting.training.agent, results.parameters)
        groups.setdefault(alike, []).append(results)
    return list(groups.values())


def _curve(results: SettingResults, seed: int) -> dict[str, Any]:
    """Return the learning curve: distance against steps of practice, with its references."""
    blocks = list(zip(*(result.distances_m for result in results.succeeded), strict=True))
    greedy_m = results.reference.total_m
    limit = None if greedy_m is None else WALKER_SHARE * greedy_m
    return {
        "key": results.setting.key,
        **setting_fields(results),
        "steps": list(results.setting.walks_after[: len(blocks)]),
        **curve_entry(blocks, seed),
        "walkers": [None if limit is None else share_at_least(p, limit).value for p in blocks],
        "points_m": [list(points) for points in blocks],
        "greedy_m": greedy_m,
        "best_known_m": results.reference.best_known_m,
    }


def _versus(settings: Sequence[SettingResults], seed: int) -> list[dict[str, Any]]:
    """Compare each pair of learning agents by probability of improvement.

    Agents are compared under the same conditions with the same values of what both of them have.
    """
    groups: dict[Any, list[SettingResults]] = {}
    for results in settings:
        if results.setting.role == "learner" and results.total_m:
            groups.setdefault((results.conditions, results.setting.trial.blocks), []).append(
                results
            )
    entries = []
    for a, b in (pair for group in groups.values() for pair in combinations(group, 2)):
        if not _are_comparable(a, b):
            continue
        probability = improvement((a.total_m,), (b.total_m,), seed)
        fields_b = setting_fields(b)
        # Where one agent lacks a setting, take the value of the other.
        shared = {k: fields_b[k] if v is None else v for k, v in setting_fields(a).items()}
        del shared["agent"]
        agents = {"a": a.setting.training.agent, "b": b.setting.training.agent}
        fewest = min(len(a.total_m), len(b.total_m))
        entries.append(
            {
                **shared,
                **agents,
                **probability.as_json("probability"),
                "verdict": bootstrap_exceeds(probability, 0.5, fewest),
            }
        )
    return entries


def _are_comparable(a: SettingResults, b: SettingResults) -> bool:
    if a.setting.training.agent == b.setting.training.agent:
        return False
    pairs = [(value, b.setting.parameters[name]) for name, value in a.setting.parameters.items()]
    return all(x == y for x, y in pairs if x is not None and y is not None)


def _timed(results: SettingResults) -> dict[str, Any]:
    lanes = [dict(lane) for lane in results.succeeded[0].wall or ()]
    fields = setting_fields(results)
    return {**{k: fields[k] for k in ("gait", "observation", "robot")}, "lanes": lanes}


def _count_trials(
    plan: Plan, settings: Sequence[SettingResults], set_aside: Mapping[str, str]
) -> dict[str, Any]:
    failed = {
        f"{results.setting.key}#{number}": result.failure
        for results in settings
        for number, result in sorted(results.results.items())
        if result.failure
    }

    def reasons(by_trial: Mapping[str, str]) -> list[dict[str, str]]:
        names = trial_names(plan, by_trial)
        return [
            {"key": key, "label": names[key], "reason": reason} for key, reason in by_trial.items()
        ]

    return {
        "done": sum(len(setting.results) for setting in settings),
        "total": plan.total,
        "failed": len(failed) + len(set_aside),
        "failures": reasons(failed),
        "set_aside": reasons(dict(sorted(set_aside.items()))),
    }
