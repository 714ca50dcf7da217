"""Repeat a benchmark from its score file, and list the differences."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from hexapods.benchmarking.runs import (
    BenchmarkResult,
    BenchmarkRun,
    all_best_known,
    plan_tasks,
    run_all,
    runs_of,
)
from hexapods.benchmarking.score_file import config_of, own_versions, results_of, score_content
from hexapods.domain.checks import check_whole
from hexapods.domain.text import visible
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.worker import difference
from hexapods.machine import cores

LAST_DIGITS_M = 1e-9
"""Distances that differ by no more differ by rounding."""
LAST_DIGITS = 1e-6
"""The same of scores, which are shares of distances of 0.1 m and more."""
_SAMPLING_SEED = 0


class BenchmarkVerification(NamedTuple):
    """Outcome of repeating a benchmark.

    Attributes:
        repeated: number of runs that were repeated.
        differences: sentences, one per difference; none if all repeats to the last bit.
        is_rounding: whether nothing differs but last digits.
    """

    repeated: int
    differences: list[str]
    is_rounding: bool


def verification(
    content: Mapping[str, Any],
    workers: int | None = None,
    sample: int | None = None,
    on_run: Callable[[int, int], object] = lambda done, total: None,  # noqa: ARG005
) -> BenchmarkVerification:
    """Repeat the runs of a score file, compute its scores again, and return the differences.

    Args:
        content: content of the file, as `score_file.decode` returns it.
        workers: number of processes; None for one per core.
        sample: number of runs that are repeated, drawn evenly, always the same; None for all. The
            scores are computed again from the distances of the file in any case.
        on_run: called with the number of runs repeated so far, and of all that are to be.

    Raises:
        UnknownName, InvalidInput: if the agent is not known here, or the sample is not valid.
        ClusterLost: if no process can be started.
    """
    config, in_file = config_of(content), results_of(content)
    spec, plans, runs = ClusterSpec(workers=workers), plan_tasks(config), runs_of(config)
    if set(in_file) != set(runs):
        count = f"The file has {len(in_file):,} runs; its benchmark has {len(runs):,}."
        return BenchmarkVerification(0, [count], False)
    if sample is not None:
        check_whole("sample", sample, 1, len(runs))
        rng = np.random.default_rng(_SAMPLING_SEED)
        runs = [runs[place] for place in sorted(rng.choice(len(runs), sample, replace=False))]
    repeated: dict[BenchmarkRun, BenchmarkResult] = {}
    for run, result in run_all(config, plans, runs, spec):
        repeated[run] = result
        on_run(len(repeated), len(runs))
    sentences = [
        f"{_name(run)}: {_text(in_file[run])} in the file, {_text(repeated[run])} repeated."
        for run in runs
        if in_file[run] != repeated[run]
    ]
    is_rounding = all(_differs_by_rounding(in_file[run], repeated[run]) for run in runs)
    again = score_content(config, plans, in_file, all_best_known(config, plans, workers or cores()))
    scores = list(_score_differences(content, again))
    is_rounding = is_rounding and all(of_rounding for _, of_rounding in scores)
    return BenchmarkVerification(
        len(repeated), sentences + [sentence for sentence, _ in scores], is_rounding
    )


def version_note(content: Mapping[str, Any]) -> str | None:
    """Return a sentence on versions that differ from the file's; None if results must be equal."""
    # Python is in the file, but results do not depend on it, nor on the kernel's version.
    named = ("racing-hexapods", "numpy", "mujoco", "processor")
    versions = {name: str(content["versions"].get(name)) for name in named}
    differs = difference(versions, own_versions())
    if differs is None:
        return None
    return visible(f"This is {differs}, by which results may differ in their last digits.")


def _score_differences(
    content: Mapping[str, Any], again: Mapping[str, Any]
) -> Iterator[tuple[str, bool]]:
    """Yield each difference in the scores, in words, and whether it is in last digits only."""
    for name in ("is_whole_protocol", "aggregate", "tasks"):
        for place, before, after in _unequal(name, content.get(name), again[name]):
            is_number = isinstance(before, int | float) and isinstance(after, int | float)
            of_rounding = is_number and abs(before - after) <= LAST_DIGITS
            yield f"{place}: {before!r} in the file, {after!r} by its distances.", of_rounding


def _unequal(place: str, before: Any, after: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield the places in which two structures differ, with both values."""
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        label = after.get("name", after.get("steps", after.get("at")))
        inner = place if label is None else f"{place} {label}"
        for name in after:
            yield from _unequal(f"{inner} {name}", before[name], after[name])
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for old, new in zip(before, after, strict=True):
            yield from _unequal(place, old, new)
    elif before != after:
        yield visible(place), before, after


def _differs_by_rounding(before: BenchmarkResult, after: BenchmarkResult) -> bool:
    return (
        before.error == after.error and abs(before.distance_m - after.distance_m) <= LAST_DIGITS_M
    )


def _name(run: BenchmarkRun) -> str:
    return f"{run.task}, {run.budget} steps, seed {run.number}"


def _text(result: BenchmarkResult) -> str:
    if result.error is not None:
        return f"failed ({visible(result.error)})"
    return f"{result.distance_m!r} m"
