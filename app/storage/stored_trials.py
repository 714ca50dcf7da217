"""The trials of an experiment as the store has them, and what they were before."""

from collections.abc import Iterable, Mapping
from typing import Any

from app.experiments.config import ExperimentConfig
from app.experiments.report.trials_csv import trials_csv
from app.experiments.trial import TrialResult


def results_of(
    rows: Iterable[Mapping[str, Any]],
) -> tuple[dict[str, TrialResult], dict[str, str]]:
    """The results by key, and why others were set aside.

    Args:
        rows: as `RunStore.trials` has them.
    """
    results, set_aside = {}, {}
    for row in rows:
        if row["result"] is None:
            set_aside[row["key"]] = row["set_aside"] or "it has no result"
            continue
        try:
            results[row["key"]] = TrialResult.from_json(row["result"])
        except (KeyError, TypeError, ValueError):
            set_aside[row["key"]] = "its result is damaged"
    return results, set_aside


def trials_as_csv(config: ExperimentConfig, rows: Iterable[Mapping[str, Any]]) -> bytes:
    """The trials as a table, a row a distance."""
    return trials_csv(config, *results_of(rows))
