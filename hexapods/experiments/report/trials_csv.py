"""All trials of an experiment as CSV."""

import csv
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from typing import Any

from hexapods.domain.text import text_cell
from hexapods.experiments.config import ExperimentConfig
from hexapods.experiments.plan import Plan, Trial
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.trial_rows import practised_steps

_FIRST = ("trial", "role", "gait", "observation", "robot", "agent")
_LAST = (
    "seed_number",
    "seed",
    "practised_steps",
    "distance_m",
    "finished_distance_m",
    "elapsed_s",
    "transitions",
    "failure",
)


def trials_csv(
    config: ExperimentConfig, results: Mapping[str, TrialResult], set_aside: Mapping[str, str]
) -> bytes:
    """Return the completed and the set-aside trials in the plan's order, one row per distance.

    A trial has a row for each block, and for each evaluation. Text cells are protected against
    being evaluated as formulas by a spreadsheet (`text_cell`).

    Args:
        config: the experiment.
        results: results by trial key.
        set_aside: reasons by trial key, of trials without a result.
    """
    out = StringIO()
    writer = csv.writer(out)
    plan = Plan(config)
    varied = [name for name in plan.settings[0].parameters if name != "steps"]
    more = ("world",) if config.preset.has_worlds else ()
    writer.writerow((*_FIRST, *more, *varied, *_LAST))
    for trial in plan.trials():
        if trial.key in results:
            writer.writerows(_rows(trial, results[trial.key], more))
        elif trial.key in set_aside:
            why = f"set aside: {set_aside[trial.key]}"
            writer.writerows(_rows(trial, TrialResult(failure=why), more))
    return out.getvalue().encode()


def _rows(trial: Trial, result: TrialResult, more: Sequence[str]) -> Iterator[list[Any]]:
    setting, training = trial.setting, trial.setting.training
    named = [trial.key, setting.role, setting.gait, training.observation, setting.robot]
    varied = [value for name, value in setting.parameters.items() if name != "steps"]
    for block, distance_m in enumerate(result.distances_m or (None,)):
        yield [
            *map(text_cell, named),
            text_cell(training.agent),
            *(text_cell(getattr(setting, name)) for name in more),
            *(text_cell(value) if isinstance(value, str) else value for value in varied),
            trial.seed_number,
            trial.seed,
            practised_steps(trial, block),
            distance_m,
            result.finished_distance_m,
            result.elapsed_s,
            result.transitions or None,
            text_cell(result.failure or ""),
        ]
