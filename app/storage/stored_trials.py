"""Convert stored trials of an experiment to `TrialResult` objects and to CSV."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

from app.domain.errors import DamagedFile
from app.experiments.config import ExperimentConfig
from app.experiments.report.trials_csv import trials_csv
from app.experiments.trial import TrialResult
from app.storage.run import SUMMARY


def results_of(
    rows: Iterable[Mapping[str, Any]],
) -> tuple[dict[str, TrialResult], dict[str, str]]:
    """Split stored trials into results and set-aside trials.

    Args:
        rows: as returned by `RunStore.trials`.

    Returns:
        results by trial key, and by key the reason why other trials have none.
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
    """Encode trials as CSV, with one row per distance.

    Args:
        config: of the experiment.
        rows: as returned by `RunStore.trials`.
    """
    return trials_csv(config, *results_of(rows))


def wall_s_of(summary: bytes | None, run_id: str) -> float:
    """Return how long an experiment has run by its newest summary [s]; 0 if it has none.

    Raises:
        DamagedFile: if the summary is damaged.
    """
    try:
        cost = None if summary is None else json.loads(summary).get("cost")
        return float(cost["wall_s"]) if cost else 0.0
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DamagedFile(f"{SUMMARY} of run {run_id} is no summary ({error!r})") from error
