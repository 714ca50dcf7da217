"""`hexapods benchmark`: score an agent by a frozen protocol."""

import signal
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter, Token

from app.cli.exit_codes import FAILED, INTERRUPTED
from app.cli.files import check_writable
from app.cli.options import AsJson, WholeNumber, Workers, whole_number
from app.cli.setting_options import AgentOptions, split
from app.cli.terminal import RATE_WINDOW_S, discard, progress, show_table, workers_text
from hexapods.benchmarking.config import benchmark_config
from hexapods.benchmarking.protocol import DEFAULT_PROTOCOL, PLAIN_SEED, PROTOCOLS
from hexapods.benchmarking.protocol import protocol as protocol_of
from hexapods.benchmarking.score_file import HEAD, encode
from hexapods.benchmarks import Benchmark, run_benchmark
from hexapods.domain.observation import Observation
from hexapods.domain.text import counted, visible
from hexapods.experiments.cluster import ClusterSpec
from hexapods.interruption import stop_signals
from hexapods.runs.config import usable_agents

_USUAL = protocol_of(DEFAULT_PROTOCOL)
_MAX_ERRORS = 5


def _numbers(_: Any, tokens: Sequence[Token]) -> tuple[int, ...]:
    return tuple(map(whole_number, split(tokens[0].value)))


def benchmark(
    agent: Annotated[str, Parameter(name="AGENT", completer=lambda _: usable_agents())],
    /,
    *,
    protocol: Annotated[
        str, Parameter(completer=lambda _: PROTOCOLS, help=" or ".join(PROTOCOLS))
    ] = DEFAULT_PROTOCOL,
    tasks: Annotated[
        str | None,
        Parameter(
            metavar="LIST",
            help=f"for a short one, one or more of {', '.join(_USUAL.tasks)} (default all)",
        ),
    ] = None,
    budgets: Annotated[
        tuple[int, ...] | None,
        Parameter(
            name="--budget",
            metavar="LIST",
            converter=_numbers,
            n_tokens=1,
            help="numbers of steps of practice "
            f"(default {','.join(map(str, _USUAL.budgets))}); for agents that learn",
        ),
    ] = None,
    seeds: WholeNumber | None = None,
    seed: WholeNumber = PLAIN_SEED,
    observation: Observation = "measured",
    workers: Workers = None,
    out: Annotated[Path | None, Parameter(metavar="FILE")] = None,
    as_json: AsJson = False,
    # mcts has a setting that is called like the option of the benchmark.
    **settings: Annotated[Any, AgentOptions(is_argument=True, flags={"budget": "--search-budget"})],
) -> int:
    """Score an agent by a frozen protocol; `hexapods verify` repeats the file.

    Each run is a training from scratch, whose policy then walks 50 steps from rest without
    exploring or learning; its score is the share of the best known walk. The exit code is 1 if a
    run failed; it counts as 0. See docs/benchmark.md.

    Args:
        agent: registered name, or my.module:Agent
        seeds: seeds of each task and number of steps (default: those of the protocol)
        seed: root seed; another one draws other bodies, damages and robots as built
        observation: how the agent reads the state
        out: score file; until all is done runs are kept in FILE.runs, and the same command goes on
            from there; runs of this agent that FILE has already are not repeated
        as_json: print the content of the score file

    Raises:
        HexapodError: if the options are not valid, or the file cannot be written.
    """
    config = benchmark_config(
        agent,
        settings,
        protocol_name=protocol,
        tasks=None if tasks is None else split(tasks),
        budgets=budgets,
        seeds=seeds,
        seed=seed,
        observation=observation,
    )
    spec = ClusterSpec(workers=workers)
    if out is not None:
        check_writable(str(out))
    print_line = discard if as_json else print
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
        continuation = (
            "nothing is kept without --out" if out is None else "the same command goes on"
        )
        print_line(f"\nInterrupted; {continuation}.")
        return INTERRUPTED
    if as_json:
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
