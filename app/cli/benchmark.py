"""`hexapods benchmark`: score an agent by a frozen protocol; `hexapods verify` repeats the file.

Each run is a training from scratch, whose policy then walks 50 steps from rest without exploring or
learning; its score is the share of the best known walk. The exit code is 1 if a run failed; it
counts as 0. See docs/benchmark.md.
"""

import argparse
import signal
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from app.cli.exit_codes import FAILED, INTERRUPTED
from app.cli.files import check_writable
from app.cli.options import CommandParser, add_observation, integer, settings_from, split
from app.cli.terminal import RATE_WINDOW_S, discard, progress, show_table, workers_text
from hexapods.benchmarking.config import benchmark_config
from hexapods.benchmarking.protocol import DEFAULT_PROTOCOL, PLAIN_SEED, PROTOCOLS, protocol
from hexapods.benchmarking.score_file import HEAD, encode
from hexapods.benchmarks import Benchmark, run_benchmark
from hexapods.domain.text import counted, visible
from hexapods.experiments.cluster import ClusterSpec
from hexapods.interruption import stop_signals

_USUAL = protocol(DEFAULT_PROTOCOL)
_MAX_ERRORS = 5


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser(
        "benchmark", help="score an agent by a frozen protocol", description=__doc__
    )
    parser.offers_settings = parser.takes_agent_first = True
    # mcts has a setting that is called like the option of the benchmark.
    parser.setting_flags = {"budget": "--search-budget"}
    parser.add_argument("agent", metavar="AGENT", help="registered name, or my.module:Agent")
    parser.add_argument(
        "--protocol",
        default=DEFAULT_PROTOCOL,
        help=f"{' or '.join(PROTOCOLS)} (default {DEFAULT_PROTOCOL})",
    )
    parser.add_argument(
        "--tasks",
        metavar="LIST",
        help=f"for a short one, one or more of {', '.join(_USUAL.tasks)} (default all)",
    )
    parser.add_argument(
        "--budget",
        dest="budgets",
        metavar="LIST",
        type=lambda text: tuple(integer(part) for part in split(text)),
        help="numbers of steps of practice "
        f"(default {','.join(map(str, _USUAL.budgets))}); for agents that learn",
    )
    parser.add_argument(
        "--seeds",
        type=integer,
        help=f"seeds of each task and number of steps (default {_USUAL.seeds})",
    )
    parser.add_argument(
        "--seed",
        type=integer,
        default=PLAIN_SEED,
        help="root seed; another one draws other bodies, damages and robots as built (default 0)",
    )
    add_observation(parser, "how the agent reads the state")
    parser.add_argument(
        "--workers", type=integer, help="worker processes on this machine (default: one per core)"
    )
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=Path,
        help="score file; until all is done runs are kept in FILE.runs, and the same command goes "
        "on from there; runs of this agent that FILE has already are not repeated",
    )
    parser.add_argument("--json", action="store_true", help="print the content of the score file")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the benchmark, or what is left of it, print the scores, and write the file.

    Raises:
        HexapodError: if the options are not valid, or the file cannot be written.
    """
    config = benchmark_config(
        options.agent,
        settings_from(options),
        protocol_name=options.protocol,
        tasks=None if options.tasks is None else split(options.tasks),
        budgets=options.budgets,
        seeds=options.seeds,
        seed=options.seed,
        observation=options.observation,
    )
    spec, out = ClusterSpec(workers=options.workers), options.out
    if out is not None:
        check_writable(str(out))
    print_line = discard if options.json else print
    total = len(config.tasks) * len(config.budgets) * config.seeds
    print_line(f"{counted(total, 'run')} of {config.protocol} {workers_text(spec)}")
    try:
        with (
            stop_signals(signal.SIGINT, signal.SIGTERM) as interrupted,
            progress("runs", RATE_WINDOW_S) as bar,
        ):
            task = bar.add_task("runs", total=total)
            done = run_benchmark(
                config,
                spec,
                score_file=out,
                on_run=lambda count, _: bar.update(task, completed=count),
                may_continue=lambda: not interrupted.is_set(),
            )
    except KeyboardInterrupt:
        kept = "nothing is kept without --out" if out is None else "the same command goes on"
        print_line(f"\nInterrupted; {kept}.")
        return INTERRUPTED
    if options.json:
        print(encode(done.content).decode(), end="")
    else:
        _print_scores(done)
    return FAILED if done.failed else 0


def _print_scores(done: Benchmark) -> None:
    entries = [*done.content["tasks"], {"title": "All tasks", **done.content["aggregate"]}]
    steps = [
        f"{budget:,} steps" if budget else "does not practise" for budget in done.config.budgets
    ]
    rows = [
        (
            entry["title"],
            "" if entry.get("best_known_m") is None else f"{entry['best_known_m']:.3f}",
            _text(entry),
            *(_text(at_budget) for at_budget in entry["budgets"]),
        )
        for entry in entries
    ]
    show_table(
        "Shares of best known, %: interquartile means (95 % intervals)",
        ("task", "best known m", "all", *steps),
        rows,
    )
    failures = list(done.failed.items())
    for run_name, error in failures[:_MAX_ERRORS]:
        print(f"Failed, counts as 0: {run_name}: {visible(error)}")
    if len(failures) > _MAX_ERRORS:
        print(f"{len(failures) - _MAX_ERRORS:,} more runs failed, and count as 0.")
    if not done.config.is_whole:
        print("This is a part of the protocol, or another draw: not to be compared with a whole.")
    print(HEAD)
    print(done.row())


def _text(entry: Mapping[str, Any]) -> str:
    value = f"{100 * entry['score']:.0f}"
    if entry["interval"] is None:
        return value
    low, high = entry["interval"]
    return f"{value} ({100 * low:.0f}–{100 * high:.0f})"
