"""Runs an experiment's trials behind a progress bar, keeps them, and reports what they show."""

import argparse
import json
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from app.cli.terminal import progress, show_table
from app.domain.errors import InvalidInput
from app.experiments.cluster import ClusterSpec
from app.experiments.config import ExperimentConfig
from app.experiments.folder import ResultsFolder, open_results
from app.experiments.own_cluster import cores
from app.experiments.plan import Trial

_INTERRUPTED = 130
_RATE_WINDOW_S = 300.0  # trials of one experiment take from a second to half a minute
_HEAD = ("setting", "seeds", "total m", "95 %", "at time-out m", "of greedy")


def run_experiment(
    config: ExperimentConfig, where: ClusterSpec, options: argparse.Namespace
) -> int:
    """Run what is not done yet, and write the report.

    Args:
        config: the experiment.
        where: its machines.
        options: `out`, `retry` and `json` of the command line.

    Raises:
        HexapodError: if it cannot be run, or not to its end; what was done is kept.
    """
    path: Path = options.out or Path(f"{config.experiment}-results")
    say = _nothing if options.json else print
    with open_results(path, config) as folder:
        total, undone = folder.plan.total, folder.remaining(options.retry)
        done = total - len(undone)
        before = f"; {done:,} are there already" if done else ""
        say(f"{total:,} trials {_on(where)}, kept in {path}{before}")
        with _interruption() as interrupted:
            _run(undone, where, folder, lambda: not interrupted.is_set())
        if interrupted.is_set():
            say(
                f"\nInterrupted: {folder.done:,} of {total:,} trials are kept in {path}; the same "
                "command goes on from there."
            )
            return _INTERRUPTED
        summary = _report(where, folder)
    if options.json:
        print(json.dumps(summary))
    else:
        _tell(summary, path)
    return 0


def _on(where: ClusterSpec) -> str:
    if where.scheduler is not None:
        return f"on the cluster of {where.scheduler}"
    workers = where.workers or cores()
    return f"on {workers} worker{'s' if workers > 1 else ''}"


def _run(
    undone: list[Trial],
    where: ClusterSpec,
    folder: ResultsFolder,
    go_on: Callable[[], bool],
) -> None:
    running, total = closing(folder.run(undone, where, go_on)), folder.plan.total
    with progress("trials", _RATE_WINDOW_S) as bar, running as outcomes:
        task = bar.add_task("trials", total=total, completed=total - len(undone))
        for _ in outcomes:
            aside = f", {len(folder.set_aside)} set aside" if folder.set_aside else ""
            bar.update(task, advance=1, description=f"trials{aside}")


def _report(where: ClusterSpec, folder: ResultsFolder) -> dict[str, Any]:
    # SciPy and Matplotlib take a second to import, which other commands need not.
    from app.experiments.report.files import write_report  # noqa: PLC0415
    from app.experiments.summary import summarise  # noqa: PLC0415

    results, set_aside = folder.planned()
    workers = None if where.scheduler is not None else where.workers or cores()
    summary = summarise(folder.plan.config, results, set_aside, folder.cost(workers))
    try:
        write_report(folder.path, summary, results)
    except OSError as error:
        raise InvalidInput(
            f"cannot write the report to {folder.path} ({error.strerror}); all trials are kept "
            "there, and the same command writes it once it can"
        ) from error
    return summary


def _tell(summary: Mapping[str, Any], path: Path) -> None:
    rows = [_row(setting) for setting in summary["settings"]]
    show_table("Interquartile means over the seeds", _HEAD, rows, long_names=True)
    trials, cost = summary["trials"], summary["cost"]
    for one in trials["set_aside"]:
        print(f"Set aside: {one['key']}: {one['reason']}")
    for claim in summary["claims"]:
        print(f"{claim['verdict']:>15}: {claim['claim']}")
    print(
        f"{trials['done']:,} trials in {cost['wall_s']:,.0f} s, {cost['trials_per_s']:.2f} a "
        f"second. The report is {path / 'report.html'}."
    )


def _row(setting: Mapping[str, Any]) -> tuple[str, ...]:
    total, finished, relative = (setting[name] for name in ("total", "finished", "relative"))
    between = total is not None and total["low_m"] is not None
    return (
        setting["key"].replace("/", " "),
        str(setting["n"]),
        "" if total is None else f"{total['iqm_m']:.3f}",
        f"{total['low_m']:.3f}–{total['high_m']:.3f}" if between else "",
        "" if finished is None else f"{finished['iqm_m']:.3f}",
        "" if relative is None else f"{100 * relative['iqm']:.0f} %",
    )


@contextmanager
def _interruption() -> Iterator[threading.Event]:
    """Set by Ctrl-C, or by who tells the process to end.

    Both wait for a moment in which the cluster can be taken down; whoever cannot wait asks twice.
    """
    asked = threading.Event()

    def ask(_number: int, _frame: FrameType | None) -> None:
        if asked.is_set():
            raise KeyboardInterrupt
        asked.set()

    before = {number: signal.signal(number, ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _nothing(_: str) -> None:
    """For programs that read JSON."""
