"""The outcome of a tuning: one document for report and terminal, and what it says in sentences."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.metadata import version
from typing import Any

import numpy as np

from hexapods.agents.appearance import title_of
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import Value
from hexapods.domain.text import counted
from hexapods.experiments.formatting import distance, number
from hexapods.experiments.names import trial_names
from hexapods.experiments.progress import Progress
from hexapods.experiments.setting_results import SettingResults, group_by_setting
from hexapods.experiments.statistics import bootstrap_exceeds, paired_interval
from hexapods.experiments.tuning.config import OBJECTIVES, Objective, config_json
from hexapods.experiments.tuning.ranges import SearchRange
from hexapods.experiments.tuning.tuning import Candidate, Tuning, objective_m
from hexapods.experiments.worker import versions
from hexapods.experiments.worlds import compare_in_worlds
from hexapods.machine import description
from hexapods.runs.config import agent_settings

FORMAT = 1


def summarise_tuning(tuning: Tuning, progress: Progress, workers: int | None) -> dict[str, Any]:
    """Summarise a tuning that is complete.

    Args:
        tuning: the tuning, after its run.
        progress: the outcomes of its trials.
        workers: number of worker processes; None if unknown.

    Returns:
        Plain types, fit for JSON: `search` (ranges, all candidates, the best), `held_out` (the same
        measures as of a league for the tuned settings, the defaults, and who walks beside them),
        `gain` (tuned minus default, for each objective), and `said` in sentences.
    """
    config, best = tuning.config, tuning.best
    settings = group_by_setting(tuning.plan, progress.results)
    entries = compare_in_worlds(settings, config.seed)
    # The tuned settings may be the defaults.
    names = {tuning.tuned.key: "tuned", tuning.defaults.key: "defaults"}
    by_key = {one.setting.key: one for one in settings}
    tuned, default = by_key[tuning.tuned.key], by_key[tuning.defaults.key]
    summary: dict[str, Any] = {
        "format": FORMAT,
        "agent": config.agent,
        "config": config_json(config),
        "versions": {**versions(), "optuna": version("optuna")},
        "machine": description(),
        "cost": dict(progress.cost(workers)),
        "trials": _trials(tuning, progress),
        "search": {
            "ranges": [_range(one, config.agent) for one in config.search_ranges],
            "candidates": [_candidate(one) for one in tuning.candidates],
            "best": best.number,
            "is_default": tuning.tuned == tuning.defaults,
        },
        "held_out": [{"name": names.get(one["key"], one["agent"]), **one} for one in entries],
        "gain": {name: _gain(name, tuned, default, config.seed) for name in OBJECTIVES},
    }
    summary["said"] = _said(summary)
    return summary


def _trials(tuning: Tuning, progress: Progress) -> dict[str, Any]:
    """Return the counts of trials, with key, name and reason of each that failed."""
    failures = {key: one.failure for key, one in progress.results.items() if one.failure}
    return {
        "done": progress.done,
        "total": progress.done,
        "failed": len(failures) + len(progress.set_aside),
        "failures": _named(tuning, failures),
        "set_aside": _named(tuning, progress.set_aside),
    }


def _named(tuning: Tuning, reasons: Mapping[str, str]) -> list[dict[str, str]]:
    """Return key, name and reason of some trials, by their reasons."""
    if not reasons:
        return []
    names = trial_names(tuning.plan, reasons)
    for candidate in tuning.candidates:
        words = values_text(candidate.values, tuning.config.agent)
        # Values that do not go together have no trials.
        with suppress(InvalidInput):
            for trial in tuning.search_trials(candidate.values):
                name = f"Candidate {candidate.number}, {words}, seed {trial.seed_number}"
                names[trial.key] = name
    return [
        {"key": key, "label": names[key], "reason": reason}
        for key, reason in sorted(reasons.items())
    ]


def values_text(values: Mapping[str, Value], agent: str) -> str:
    """Describe values of the agent's settings: `α 0.3, γ 0.9`."""
    settings = agent_settings(agent)
    return ", ".join(settings[name].describe(value) for name, value in values.items())


def options_text(values: Mapping[str, Value]) -> str:
    """Return values of settings as options of a command: `--alpha 0.3 --gamma 0.9`."""
    return " ".join(
        f"--{name.replace('_', '-')} {str(value).lower() if isinstance(value, bool) else value}"
        for name, value in values.items()
    )


def _range(one: SearchRange, agent: str) -> dict[str, Any]:
    setting = agent_settings(agent)[one.name]
    return {
        "name": one.name,
        "title": setting.about.title,
        "symbol": setting.about.symbol,
        "default": setting.default,
        "choices": list(one.choices),
        "low": None if one.choices else one.low,
        "high": None if one.choices else one.high,
        "is_logarithmic": one.is_logarithmic,
    }


def _candidate(one: Candidate) -> dict[str, Any]:
    return {**one._asdict(), "values": dict(one.values)}


def _gain(
    objective: Objective, tuned: SettingResults, default: SettingResults, seed: int
) -> dict[str, Any] | None:
    """Compare interquartile means over the seeds that both have, paired by seed."""
    both = sorted(
        number
        for number in tuned.results.keys() & default.results.keys()
        if not tuned.results[number].failure and not default.results[number].failure
    )
    if not both:
        return None
    pairs = np.array(
        [
            [objective_m(objective, one.setting.trial, one.results[number]) for number in both]
            for one in (tuned, default)
        ]
    )
    gain = paired_interval([pairs], lambda iqms: iqms[0] - iqms[1], seed)
    return {
        **gain.as_json("iqm"),
        "n": len(both),
        "is_better": bootstrap_exceeds(gain, 0.0, len(both)),
    }


def _said(summary: Mapping[str, Any]) -> list[str]:
    """Say what the search found, and what that is worth on the held-out seeds."""
    config, search = summary["config"], summary["search"]
    objective: Objective = config["objective"]
    first, best = (search["candidates"][place] for place in (0, search["best"]))
    agent, what = title_of(summary["agent"]), OBJECTIVES[objective]
    seeds = counted(config["search_seeds"], "seed")
    tried = (
        f"{counted(config['candidates'], 'candidate')} for the settings of {agent} on {seeds} each:"
    )
    if search["is_default"]:
        return [f"{tried} none had a greater mean {what} than the defaults. Nothing is tuned."]
    found = values_text(best["values"], summary["agent"])
    default = "nothing" if first["value_m"] is None else f"{number(first['value_m'], 3)} m"
    return [
        f"{tried} the best is {found}. Mean {what} there {number(best['value_m'], 3)} m, with the "
        f"defaults {default}.",
        _verdict(summary["gain"][objective], what),
    ]


def _verdict(gain: Mapping[str, Any] | None, what: str) -> str:
    if gain is None:
        return "On the held-out seeds there is nothing to compare: no seed has a result of both."
    held_out = f"On {counted(gain['n'], 'held-out seed')}"
    difference = distance(gain)
    if gain["is_better"] == "yes":
        return f"{held_out} the tuned settings are better: {what} greater by {difference}."
    if gain["is_better"] == "no":
        return f"{held_out} the tuned settings are worse than the defaults: {what} {difference}."
    return (
        f"{held_out} the tuned settings are not shown to be better than the defaults: {what} "
        f"differs by {difference}."
    )


def gains(summary: Mapping[str, Any]) -> Sequence[tuple[str, str]]:
    """Return each objective with the difference of tuned settings and defaults as text."""
    return [
        (OBJECTIVES[name], "–" if one is None else distance(one))
        for name, one in summary["gain"].items()
    ]
