"""`hexapods tune`: search for the settings of a learner that walk farthest.

Compares the settings that it finds with the defaults on seeds that the search never saw.
"""

import argparse
import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from app.cli.exit_codes import FAILED, INTERRUPTED
from app.cli.options import (
    CommandParser,
    add_observation,
    add_settings,
    integer,
    read_gait,
    read_robot,
    split,
)
from app.cli.terminal import RATE_WINDOW_S, discard, progress, show_table, workers_text
from app.features.experiments.command_trials import (
    STOPPING,
    print_failures,
    report_errors,
    share_text,
)
from app.features.experiments.trial_options import add_machine_options, cluster_from
from hexapods.domain.checks import check_whole
from hexapods.domain.gait import NAMED_GAITS
from hexapods.domain.robot import PRESETS
from hexapods.domain.settings import declared_fields
from hexapods.domain.text import counted
from hexapods.domain.world import WORLDS
from hexapods.experiments.cluster import ClusterSpec, connect
from hexapods.experiments.config import MAX_SEEDS, REPORT
from hexapods.experiments.folder import ResultsFolder, open_results
from hexapods.experiments.plan import Trial
from hexapods.experiments.tuning.config import Objective, TuningConfig, tuning_config
from hexapods.experiments.worker import Outcome, Workers
from hexapods.interruption import stop_signals
from hexapods.machine import cores
from hexapods.runs.config import SIMULATORS, TrainingConfig, WalkingProblem

if TYPE_CHECKING:
    from hexapods.experiments.tuning.tuning import Tuning

_HEAD = ("on held-out seeds", "distance m", "mean over practice m", "of greedy", "seeds")


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser(
        "tune", help="search for the best settings of a learner", description=__doc__
    )
    parser.add_argument("agent", help="learner to tune, such as q-learning, or my.module:Agent")
    _add_condition_options(parser)
    usual = TuningConfig
    parser.add_argument(
        "--candidates",
        type=integer,
        default=usual.candidates,
        help=f"combinations of settings to try, the defaults first (default {usual.candidates})",
    )
    parser.add_argument(
        "--seeds",
        type=integer,
        default=usual.search_seeds,
        help=f"seeds per candidate (default {usual.search_seeds})",
    )
    parser.add_argument(
        "--held-out",
        type=integer,
        default=usual.seeds,
        help=f"number of held-out seeds for the final comparison (default {usual.seeds})",
    )
    parser.add_argument(
        "--seed",
        type=integer,
        default=usual.seed,
        help="root seed from which all others are spawned (default 0)",
    )
    parser.add_argument(
        "--objective",
        choices=get_args(Objective),
        default=usual.objective,
        help="what to maximise: mean distance after the practice (default), or area: its average "
        "over the practice",
    )
    parser.add_argument(
        "--settings",
        metavar="LIST",
        help="the agent's settings to tune, separated by commas (default: all that declare limits "
        "or choices)",
    )
    parser.add_argument(
        "--range",
        action="append",
        default=[],
        metavar="NAME=LOW:HIGH",
        help="search range of a setting, or NAME=VALUE,VALUE; repeat for several settings. "
        "Positive numbers that span two orders are searched on a logarithmic scale",
    )
    parser.add_argument(
        "--beside", metavar="LIST", help="agents to run on the held-out seeds too, by commas"
    )
    add_machine_options(parser)
    parser.set_defaults(run=run)


def _add_condition_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--gait", required=True, help=f"gait: {', '.join(NAMED_GAITS)}, or JSON as for train"
    )
    parser.add_argument(
        "--robot",
        default="stiff",
        help=f"robot: {', '.join(PRESETS)}, a stored one, a TOML file, or JSON",
    )
    parser.add_argument(
        "--simulator", default="mujoco", help=f"simulator: {' or '.join(SIMULATORS)}"
    )
    parser.add_argument(
        "--world",
        default="flat",
        help=f"one of {', '.join(WORLDS)}, or a disturbance such as limp:legs=1,4",
    )
    add_observation(parser, "how the learner reads its state (default measured)")
    add_settings(parser, declared_fields(WalkingProblem))
    add_settings(parser, declared_fields(TrainingConfig), ("steps",))


def run(options: argparse.Namespace) -> int:
    """Run the tuning, or resume it from its results folder.

    Raises:
        HexapodError: if the options are not valid, or the tuning cannot be completed; finished
            trials are stored.
    """
    cluster, config = cluster_from(options), config_from(options)
    # Imported here, as Optuna and SciPy take a second to import.
    from hexapods.experiments.tuning.tuning import Tuning  # noqa: PLC0415

    tuning = Tuning(config)
    path: Path = options.out or Path("tuning-results")
    print_line = discard if options.json else print
    with open_results(path, config) as folder:
        before = f"; {folder.done:,} are there already" if folder.done else ""
        print_line(
            f"{counted(config.candidates, 'candidate')} for the settings of {config.agent} on "
            f"{counted(config.search_seeds, 'seed')} each, then "
            f"{counted(config.seeds, 'held-out seed')}: about {tuning.total:,} trials "
            f"{workers_text(cluster)}, kept in {path}{before}"
        )
        _run(tuning, cluster, folder, options.retry)
        if not tuning.is_complete:
            print_line(
                f"\nInterrupted: {folder.done:,} trials are kept in {path}; the same command goes "
                "on from there."
            )
            return INTERRUPTED
        summary = _report(tuning, cluster, folder)
    if options.json:
        print(json.dumps(summary))
    else:
        _print_summary(summary, path)
    return FAILED if summary["trials"]["failed"] else 0


def config_from(options: argparse.Namespace) -> TuningConfig:
    """Return the tuning that the options ask for.

    Raises:
        HexapodError: if the options are not valid.
    """
    # By their options, which have other names than the fields of the config.
    check_whole("seeds", options.seeds, 1, MAX_SEEDS)
    check_whole("held-out", options.held_out, 1, MAX_SEEDS)
    return tuning_config(
        options.agent,
        settings=None if options.settings is None else split(options.settings),
        ranges=options.range,
        beside=() if options.beside is None else split(options.beside),
        gaits=(read_gait(options.gait),),
        robots=(read_robot(options.robot),),
        simulator=options.simulator,
        worlds=(options.world,),
        observations=(options.observation,),
        divisions=(options.divisions,),
        grid_side_m=(options.grid_side_m,),
        tolerance=options.tolerance,
        reward=options.reward,
        steps=(options.steps,),
        candidates=options.candidates,
        search_seeds=options.seeds,
        seeds=options.held_out,
        seed=options.seed,
        objective=options.objective,
    )


def _run(tuning: "Tuning", cluster: ClusterSpec, folder: ResultsFolder, retry: bool) -> None:
    with stop_signals(*STOPPING) as interrupted, ExitStack() as stack:

        @cache
        def workers() -> Workers:
            return stack.enter_context(connect(cluster))

        def run_all(trials: Sequence[Trial]) -> Iterable[Outcome]:
            # Workers are started by the first trial that is not there already.
            if not trials or interrupted.is_set():
                return ()
            return folder.run_on(workers(), trials, lambda: not interrupted.is_set())

        with progress("trials", RATE_WINDOW_S) as bar:
            task = bar.add_task("trials", total=tuning.total, completed=folder.done)
            for _ in tuning.run(folder, run_all, retry):
                aside = f", {len(folder.set_aside)} set aside" if folder.set_aside else ""
                bar.update(task, advance=1, description=f"trials{aside}")


def _report(tuning: "Tuning", cluster: ClusterSpec, folder: ResultsFolder) -> dict[str, Any]:
    # Imported here, as SciPy and Matplotlib take a second to import.
    from hexapods.experiments.report.files import write_files  # noqa: PLC0415
    from hexapods.experiments.tuning.report import tuning_files  # noqa: PLC0415
    from hexapods.experiments.tuning.summary import summarise_tuning  # noqa: PLC0415

    workers = None if cluster.scheduler is not None else cluster.workers or cores()
    summary = summarise_tuning(tuning, folder, workers)
    with report_errors(folder.path):
        write_files(folder.path, tuning_files(tuning, folder, summary))
    return summary


def _print_summary(summary: Mapping[str, Any], path: Path) -> None:
    from hexapods.experiments.tuning.report import held_out_name  # noqa: PLC0415
    from hexapods.experiments.tuning.summary import options_text  # noqa: PLC0415

    entries = sorted(summary["held_out"], key=lambda one: -float(one["distance"]["iqm"]))
    rows = [(held_out_name(one), *_row(one)) for one in entries]
    show_table("Interquartile means (95 % intervals)", _HEAD, rows)
    best_known_m = entries[0]["best_known_m"] if entries else None
    if best_known_m is not None:
        print(f"Best known: {best_known_m:.3f} m")
    print_failures(summary["trials"])
    for sentence in summary["said"]:
        print(sentence)
    search = summary["search"]
    if not search["is_default"]:
        print(f"Tuned: {options_text(search['candidates'][search['best']]['values'])}")
    print(
        f"{summary['trials']['done']:,} trials in {summary['cost']['wall_s']:,.0f} s. The report "
        f"is {path / REPORT}."
    )


def _row(one: Mapping[str, Any]) -> tuple[str, ...]:
    return (
        _interval_text(one["distance"]),
        _interval_text(one["mean_m"]),
        share_text(one["of_greedy"]),
        str(one["n"]),
    )


def _interval_text(middle: Mapping[str, Any] | None) -> str:
    if middle is None:
        return ""
    between = f" ({middle['low']:.3f}–{middle['high']:.3f})" if middle["low"] is not None else ""
    return f"{middle['iqm']:.3f}{between}"
