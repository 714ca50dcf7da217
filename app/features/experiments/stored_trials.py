"""Decode stored trials of an experiment, and encode them as CSV."""

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from hexapods.domain.errors import DamagedFile
from hexapods.experiments.config import SUMMARY, ExperimentConfig
from hexapods.experiments.progress import Progress
from hexapods.experiments.report.trials_csv import trials_csv
from hexapods.experiments.worker import Outcome


def outcomes_of(rows: Iterable[Mapping[str, Any]]) -> Iterator[Outcome]:
    """Decode stored trials; one whose result is damaged is returned as set aside.

    Args:
        rows: as returned by `Trials.get`.
    """
    for row in rows:
        try:
            yield Outcome.from_json(row)
        except (KeyError, TypeError, ValueError):
            yield Outcome.from_json({**row, "result": None, "set_aside": "its result is damaged"})


def trials_as_csv(config: ExperimentConfig, rows: Iterable[Mapping[str, Any]]) -> bytes:
    """Encode trials as CSV, with one row per distance.

    Args:
        config: config of the experiment.
        rows: as returned by `Trials.get`.
    """
    progress = Progress(config)
    for outcome in outcomes_of(rows):
        progress.add(outcome)
    return trials_csv(config, progress.results, progress.set_aside)


def wall_s_of(summary: bytes | None, run_id: str) -> float:
    """Return the wall time of an experiment from its newest summary [s]; 0 without a summary.

    Raises:
        DamagedFile: if the summary is damaged.
    """
    try:
        cost = None if summary is None else json.loads(summary).get("cost")
        return float(cost["wall_s"]) if cost else 0.0
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DamagedFile(f"{SUMMARY} of run {run_id} is no summary ({error!r})") from error
