"""The verb `benchmark`, which scores an agent by a frozen protocol, and its result."""

import html
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from hexapods.agents.registry import AgentClass
from hexapods.arguments import check_callable, plain, values_of
from hexapods.benchmarking.config import BenchmarkConfig, benchmark_config
from hexapods.benchmarking.kept_runs import KeptRuns, kept_runs
from hexapods.benchmarking.protocol import DEFAULT_PROTOCOL, PLAIN_SEED
from hexapods.benchmarking.runs import TaskPlan, all_best_known, plan_tasks, run_all, runs_of
from hexapods.benchmarking.score_file import encode, row_of, score_content
from hexapods.domain.observation import Observation
from hexapods.domain.records import check_kept
from hexapods.experiments.cluster import ClusterSpec
from hexapods.files import path_of, write_atomically
from hexapods.machine import cores
from hexapods.repetition import agent_of_processes, check_main_module
from hexapods.result_table import ResultTable


class TaskScore(NamedTuple):
    """Score of an agent on a task, or at a budget."""

    name: str
    """Name of the task; at a budget the steps of practice."""
    score: float
    """Interquartile mean of the shares of best known over all runs."""
    low: float | None
    high: float | None
    """Its 95 % interval; None of fewer than three seeds."""
    failed: int = 0
    """Number of runs that failed; each counts as 0."""


@dataclass(frozen=True, eq=False, repr=False)
class Benchmark:
    """A finished benchmark, as `benchmark` returns it.

    Attributes:
        config: config of the benchmark, which decides its result.
        content: content of its score file: plain types, fit for JSON (docs/benchmark.md).
    """

    config: BenchmarkConfig
    content: Mapping[str, Any]

    @property
    def score(self) -> float:
        """Interquartile mean of the shares of best known over all tasks, budgets and seeds."""
        return float(self.content["aggregate"]["score"])

    @property
    def interval(self) -> tuple[float, float] | None:
        """The 95 % interval of the score; None of fewer than three seeds."""
        limits = self.content["aggregate"]["interval"]
        return None if limits is None else (limits[0], limits[1])

    @property
    def tasks(self) -> tuple[TaskScore, ...]:
        """The score on each task; `pandas.DataFrame(it.tasks)` is a table."""
        return tuple(
            _score(
                entry["name"], entry, sum(error["seed"] is not None for error in entry["errors"])
            )
            for entry in self.content["tasks"]
        )

    @property
    def budgets(self) -> tuple[TaskScore, ...]:
        """The score at each budget, over all tasks."""
        return tuple(
            _score(str(entry["steps"]), entry) for entry in self.content["aggregate"]["budgets"]
        )

    @property
    def profile(self) -> Mapping[float, float]:
        """Share of all runs that score at least as much, by score."""
        return {point["at"]: point["share"] for point in self.content["aggregate"]["profile"]}

    @property
    def failed(self) -> Mapping[str, str]:
        """Errors of the runs that failed, by task, steps of practice and seed."""
        return {
            task["name"]
            if error["seed"] is None
            else f"{task['name']}, {error['steps']} steps, seed {error['seed']}": error["error"]
            for task in self.content["tasks"]
            for error in task["errors"]
        }

    def table(self) -> ResultTable:
        """Return all runs, a row each: task, steps of practice, seed, distance and score."""
        return ResultTable.of(
            {
                "task": task["name"],
                "steps": entry["steps"],
                "seed": number,
                "distance_m": distance_m,
                "best_known_m": task["best_known_m"],
                "score": score,
            }
            for task in self.content["tasks"]
            for entry in task["budgets"]
            for number, (distance_m, score) in enumerate(
                zip(entry["distances_m"], entry["scores"], strict=True)
            )
        )

    def row(self) -> str:
        """Return the benchmark as a row of the table in docs/benchmark.md, in Markdown."""
        return row_of(self.content)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the score file, which `hexapods verify` repeats.

        Returns:
            its path.

        Raises:
            InvalidInput: if it is no path.
            OSError: if the file cannot be written.
        """
        target = path_of(path, "a score file")
        write_atomically(target, encode(self.content))
        return target

    def __repr__(self) -> str:
        limits = "" if self.interval is None else " ({:.3f} to {:.3f})".format(*self.interval)
        whole = "" if self.config.is_whole else ", a part of the protocol"
        return (
            f"<Benchmark {self.config.agent}, {self.config.protocol}{whole}: "
            f"{self.score:.3f}{limits}>"
        )

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(task.name)}</th><td>{task.score:.3f}</td>"
            f"<td>{'' if task.low is None else f'{task.low:.3f} to {task.high:.3f}'}</td>"
            f"<td>{task.failed or ''}</td></tr>"
            for task in self.tasks
        )
        head = "<tr><th></th><th>score</th><th>95 % interval</th><th>failed</th></tr>"
        caption = html.escape(repr(self)[1:-1])
        return (
            f"<table><caption>{caption}</caption><thead>{head}</thead><tbody>{rows}</tbody></table>"
        )


def _score(name: str, entry: Mapping[str, Any], failed: int = 0) -> TaskScore:
    low, high = entry["interval"] or (None, None)
    return TaskScore(name, entry["score"], low, high, failed)


def benchmark(
    agent: str | AgentClass,
    *,
    protocol: str = DEFAULT_PROTOCOL,
    tasks: str | Sequence[str] | None = None,
    budgets: int | Sequence[int] | None = None,
    seeds: int | None = None,
    seed: int = PLAIN_SEED,
    observation: Observation = "measured",
    file: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    on_run: Callable[[int, int], object] | None = None,
    **settings: Any,
) -> Benchmark:
    """Score an agent by a frozen protocol: shares of best known over tasks, budgets and seeds.

    Each run is a training from scratch, whose policy then walks 50 steps from rest without
    exploring or learning. Runs are in processes, which know agents of modules: a program that
    defines agents itself calls it under `if __name__ == "__main__":`.

    Args:
        agent: its registered name, `my.module:Agent`, or its class.
        protocol: name of the protocol.
        tasks: names of tasks, for a short one; None for all.
        budgets: numbers of steps of practice; None for those of the protocol. An agent that does
            not learn has none.
        seeds: number of seeds of each task and budget; None for that of the protocol.
        seed: root seed: another one draws other bodies, damages and robots as built.
        observation: how the agent reads the state.
        file: path of the score file. Runs are kept beside it until all are done: called again,
            the benchmark goes on where it ended. None keeps nothing.
        workers: number of processes; None for one per core.
        on_run: called with the number of runs done so far, and of all.
        settings: settings of the agent, such as `alpha`.

    A run that fails counts as 0, and `failed` names it with its error.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid; the message names what is.
        ClusterLost: if the processes cannot be started, or are lost.

    Examples:
        >>> import hexapods as hx
        >>> done = hx.benchmark("greedy", tasks="tripod", seeds=1, workers=1)
        >>> done
        <Benchmark greedy, hexabench-1, a part of the protocol: 0.986>
    """
    check_callable("on_run", on_run)
    check_main_module()
    config = benchmark_config(
        agent_of_processes(agent),
        plain(settings),
        protocol_name=protocol,
        tasks=None if tasks is None else values_of(tasks),
        budgets=None if budgets is None else values_of(budgets),
        seeds=None if seeds is None else plain(seeds),
        seed=plain(seed),
        observation=observation,
    )
    return run_benchmark(
        config,
        ClusterSpec(workers=workers),
        score_file=None if file is None else path_of(file, "a score file"),
        on_run=on_run,
    )


def run_benchmark(
    config: BenchmarkConfig,
    spec: ClusterSpec,
    *,
    score_file: Path | None = None,
    on_run: Callable[[int, int], object] | None = None,
    may_continue: Callable[[], bool] = lambda: True,
) -> Benchmark:
    """Run a benchmark, or what is left of it.

    Args:
        config: the benchmark.
        spec: the workers.
        score_file: path of the score file, whose runs count. Others are kept beside it until all
            are done; then it is written. None keeps nothing.
        on_run: as in `benchmark`.
        may_continue: as in `run_trials`.

    Raises:
        InvalidInput: if runs cannot be kept.
        ClusterLost: if no worker can be started.
        KeyboardInterrupt: if it may not continue before all runs are done.
        OSError: if the score file cannot be written.
    """
    check_kept(config)
    plans, runs = plan_tasks(config), runs_of(config)
    with kept_runs(score_file, config) as progress:
        missing = [run for run in runs if run not in progress.results]
        done = len(runs) - len(missing)
        if on_run is not None:
            on_run(done, len(runs))
        with closing(run_all(config, plans, missing, spec, may_continue)) as outcomes:
            for run, result in outcomes:
                progress.add(run, result)
                done += 1
                if on_run is not None:
                    on_run(done, len(runs))
        if done < len(runs):
            raise KeyboardInterrupt
        benchmarked = _benchmark(config, plans, progress, spec)
        if score_file is not None:
            benchmarked.save(score_file)
            progress.delete()
        return benchmarked


def _benchmark(
    config: BenchmarkConfig, plans: Sequence[TaskPlan], progress: KeptRuns, spec: ClusterSpec
) -> Benchmark:
    best_known = all_best_known(config, plans, spec.workers or cores())
    return Benchmark(config, score_content(config, plans, progress.results, best_known))
