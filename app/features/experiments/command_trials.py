"""Runs the trials of an experiment with a progress bar, stores them, and writes the report."""

import json
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from app.cli.exit_codes import FAILED, INTERRUPTED
from app.cli.terminal import RATE_WINDOW_S, discard, progress, show_table, workers_text
from app.features.experiments.trial_options import ExecutionOptions
from hexapods.domain.errors import InvalidInput
from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.config import REPORT, ExperimentConfig
from hexapods.experiments.failures import failures_text
from hexapods.experiments.folder import ResultsFolder, open_results
from hexapods.experiments.plan import Trial
from hexapods.interruption import stop_signals
from hexapods.machine import cores

STOPPING = (signal.SIGINT, signal.SIGTERM)
_HEAD = ("setting", "seeds", "total m", "95\u00a0%")


def run_experiment(config: ExperimentConfig, execution: ExecutionOptions) -> int:
    """Run the remaining trials of an experiment, write the report, and return the exit code.

    It is 1 if a trial failed, now or before, and 130 if it was interrupted.

    Args:
        config: config of the experiment.
        execution: options for workers or cluster, results folder and output.

    Raises:
        HexapodError: if the experiment cannot be run or completed; finished trials are stored.
    """
    cluster = execution.cluster()
    path = execution.out or Path(f"{config.experiment}-results")
    print_line = discard if execution.as_json else print
    with open_results(path, config) as folder:
        total, remaining = folder.plan.total, folder.remaining(execution.retry)
        done = total - len(remaining)
        before = f"; {done:,} are there already" if done else ""
        print_line(f"{total:,} trials {workers_text(cluster)}, kept in {path}{before}")
        with stop_signals(*STOPPING) as interrupted:
            _run(remaining, cluster, folder, lambda: not interrupted.is_set())
        if interrupted.is_set():
            print_line(
                f"\nInterrupted: {folder.done:,} of {total:,} trials are kept in {path}; the same "
                "command goes on from there."
            )
            return INTERRUPTED
        summary = _report(cluster, folder)
    if execution.as_json:
        print(json.dumps(summary))
    else:
        _print_summary(summary, path)
    return FAILED if summary["trials"]["failed"] else 0


def _run(
    remaining: list[Trial],
    cluster: ClusterSpec,
    folder: ResultsFolder,
    should_continue: Callable[[], bool],
) -> None:
    running, total = closing(folder.run(remaining, cluster, should_continue)), folder.plan.total
    with progress("trials", RATE_WINDOW_S) as bar, running as outcomes:
        task = bar.add_task("trials", total=total, completed=total - len(remaining))
        for _ in outcomes:
            aside = f", {len(folder.set_aside)} set aside" if folder.set_aside else ""
            bar.update(task, advance=1, description=f"trials{aside}")


def _report(cluster: ClusterSpec, folder: ResultsFolder) -> dict[str, Any]:
    # Imported here, where they are needed first.
    from hexapods.experiments.report.files import report_files, write_files  # noqa: PLC0415
    from hexapods.experiments.summary import summarise  # noqa: PLC0415

    results, set_aside = folder.planned()
    workers = None if cluster.scheduler is not None else cluster.workers or cores()
    summary = summarise(folder.plan.config, results, set_aside, folder.cost(workers))
    with report_errors(folder.path):
        write_files(folder.path, report_files(summary, results))
    return summary


@contextmanager
def report_errors(path: Path) -> Iterator[None]:
    """Say of a report that cannot be written what is kept.

    Raises:
        InvalidInput: in place of an OSError.
    """
    try:
        yield
    except OSError as error:
        raise InvalidInput(
            f"cannot write the report to {path} ({error.strerror}); all trials are kept there, "
            "and the same command writes it once it can"
        ) from error


def _print_summary(summary: Mapping[str, Any], path: Path) -> None:
    show_table("Interquartile means over the seeds", *_table(summary))
    trials, cost = summary["trials"], summary["cost"]
    print_failures(trials)
    for claim in summary["claims"]:
        print(f"{claim['verdict']:>15}: {claim['claim']}")
    print(
        f"{trials['done']:,} trials in {cost['wall_s']:,.0f} s, {cost['trials_per_s']:.2f} a "
        f"second. The report is {path / REPORT}."
    )


def print_failures(trials: Mapping[str, Any]) -> None:
    """Print the trials that failed, with their reasons; `trials` is that of a summary."""
    for name, reasons in (("Failed", trials["failures"]), ("Set aside", trials["set_aside"])):
        for reason in reasons:
            print(f"{name}: {reason['label']}: {reason['reason']}")
    if trials["failed"]:
        print(f"{failures_text(trials)}; what is said here is of the others.")


def _table(summary: Mapping[str, Any]) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return head and rows; a league or recovery has no race, but more to be measured against."""
    from hexapods.experiments.names import setting_names  # noqa: PLC0415
    from hexapods.experiments.presets import preset_of  # noqa: PLC0415

    settings = summary["settings"]
    worlds = {entry["key"]: entry for entry in summary["worlds"]}
    models = {key: entry["plans_with"] for key, entry in worlds.items()}
    names = setting_names(settings, summary["parameters"], models)
    rows = [(names[setting["key"]], *_distances(setting)) for setting in settings]
    if not preset_of(summary["experiment"]).has_worlds:
        head = (*_HEAD, "at time-out m", "of greedy")
        return head, [
            (*row, *_in_race(setting)) for row, setting in zip(rows, settings, strict=True)
        ]
    head = (*_HEAD, "of greedy", "of best known")
    return head, [
        (*row, *_shares(worlds.get(setting["key"])))
        for row, setting in zip(rows, settings, strict=True)
    ]


def _distances(setting: Mapping[str, Any]) -> tuple[str, ...]:
    total = setting["total"]
    between = total is not None and total["low_m"] is not None
    return (
        str(setting["n"]),
        "" if total is None else f"{total['iqm_m']:.3f}",
        f"{total['low_m']:.3f}–{total['high_m']:.3f}" if between else "",
    )


def _in_race(setting: Mapping[str, Any]) -> tuple[str, str]:
    finished = setting["finished"]
    return "" if finished is None else f"{finished['iqm_m']:.3f}", share_text(setting["relative"])


def _shares(entry: Mapping[str, Any] | None) -> tuple[str, str]:
    return (
        ("", "")
        if entry is None
        else (share_text(entry["of_greedy"]), share_text(entry["of_best_known"]))
    )


def share_text(share: Mapping[str, Any] | None) -> str:
    """Return the interquartile mean of a share as text, with a no-break space: `96 %`."""
    return "" if share is None else f"{100 * share['iqm']:.0f}\u00a0%"
