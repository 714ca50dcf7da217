"""The report of an experiment as files: a page, figures, every trial, and the summary."""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from app.experiments.config import from_json
from app.experiments.report.drawing import FORMATS, rendered
from app.experiments.report.figures import sheets
from app.experiments.report.page import page
from app.experiments.report.trials_csv import trials_csv
from app.experiments.trial import TrialResult

PAGE = "report.html"


def report_files(
    summary: Mapping[str, Any], results: Mapping[str, TrialResult]
) -> Iterator[tuple[str, bytes]]:
    """Name and bytes of each file, one after the other; folders in names end in `/`.

    The same summary and results give the same bytes.

    Args:
        summary: as of `summarise`.
        results: the trials that it is of.
    """
    yield "summary.json", (json.dumps(summary, allow_nan=False) + "\n").encode()
    set_aside = {one["key"]: one["reason"] for one in summary["trials"]["set_aside"]}
    yield "trials.csv", trials_csv(from_json(summary["config"]), results, set_aside)
    for kind in FORMATS:
        # Drawn anew for each: rendering moves the parts of a figure a little.
        for picture in sheets(summary):
            yield f"figures/{picture.name}.{kind}", rendered(picture.figure, kind)
    yield PAGE, page(summary).encode()


def write_report(
    folder: Path, summary: Mapping[str, Any], results: Mapping[str, TrialResult]
) -> Path:
    """Write all files into a folder that may have older ones; gives the page's path.

    Raises:
        OSError: if a file cannot be written; a file is replaced as a whole, or not at all.
    """
    for name, content in report_files(summary, results):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        compare_with_published = path.with_name(f".{path.name}.part")
        compare_with_published.write_bytes(content)
        compare_with_published.replace(path)
    return folder / PAGE
