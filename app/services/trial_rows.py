"""Trials of an experiment as CSV."""

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

HEAD = (
    "setting",
    "seed_number",
    "block",
    "distance_m",
    "finished_distance_m",
    "elapsed_s",
    "simulated_transitions",
    "compute_s",
    "failure",
)


def as_csv(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """One line for each distance, in the order of the trials; a trial without one has one too.

    Args:
        rows: as `RunStore.trials` has them.
    """
    yield _line(HEAD)
    for row in rows:
        setting, _, number = row["key"].rpartition("#")
        result = row["result"] or {}
        failure = row["set_aside"] or result.get("failure")
        distances = result.get("distances_m") or [None]
        for block, distance in enumerate(distances, start=1):
            more = [result.get(name) for name in ("finished_distance_m", "elapsed_s")]
            transitions = result.get("transitions")
            shown = [setting, number, block, distance, *more, transitions, row["compute_s"]]
            yield _line([*shown, failure])


def _line(cells: Sequence[Any]) -> str:
    buffer = io.StringIO()
    csv.writer(buffer).writerow(["" if cell is None else cell for cell in cells])
    return buffer.getvalue()
