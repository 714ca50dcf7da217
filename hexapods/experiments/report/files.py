"""Write an experiment's report as files: the page, all trials as CSV, and the summary."""

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from hexapods.domain.records import from_json
from hexapods.experiments.config import REPORT, SUMMARY, TRIALS_TABLE, ExperimentConfig
from hexapods.experiments.report.page import page
from hexapods.experiments.report.trials_csv import trials_csv
from hexapods.experiments.trial import TrialResult
from hexapods.files import write_atomically


def report_files(
    summary: Mapping[str, Any], results: Mapping[str, TrialResult]
) -> Iterator[tuple[str, bytes]]:
    """Yield the relative path and the bytes of each file.

    The same summary and results give the same bytes.

    Args:
        summary: as by `summarise`.
        results: the results that were summarised, by trial key.
    """
    yield SUMMARY, (json.dumps(summary, allow_nan=False) + "\n").encode()
    set_aside = {trial["key"]: trial["reason"] for trial in summary["trials"]["set_aside"]}
    yield (
        TRIALS_TABLE,
        trials_csv(from_json(ExperimentConfig, summary["config"]), results, set_aside),
    )
    yield REPORT, page(summary).encode()


def write_files(folder: Path, files: Iterable[tuple[str, bytes]]) -> Path:
    """Write the files of a report into a folder, each atomically, and return the page's path.

    Raises:
        OSError: if a file cannot be written.
    """
    for name, content in files:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, content)
    return folder / REPORT
