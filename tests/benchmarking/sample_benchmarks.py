"""Small benchmarks for tests: one or two tasks of a few steps, with real physics."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from hexapods.benchmarking.config import BenchmarkConfig, benchmark_config
from hexapods.benchmarking.runs import BenchmarkResult, BenchmarkRun
from hexapods.benchmarks import Benchmark, run_benchmark
from hexapods.experiments.cluster import ClusterSpec

AGENT, TASK, BUDGETS, SEEDS = "q-learning", "tripod", (3, 6), 3
SMALL: Mapping[str, Any] = {"tasks": (TASK,), "budgets": BUDGETS, "seeds": SEEDS}


def small(agent: str = AGENT, settings: Mapping[str, Any] | None = None, **options: Any) -> Any:
    """Return the config of a small benchmark."""
    return benchmark_config(agent, settings or {}, **{**SMALL, **options})


@cache
def small_benchmark() -> Benchmark:
    """Run a small benchmark of Q-learning, once in a process."""
    return run_benchmark(small(), ClusterSpec(workers=1))


def results(config: BenchmarkConfig, distance_m: float) -> dict[BenchmarkRun, BenchmarkResult]:
    """Return results of all runs of a benchmark, all as far."""
    return {
        BenchmarkRun(task, budget, number): BenchmarkResult(distance_m)
        for task in config.tasks
        for budget in config.budgets
        for number in range(config.seeds)
    }
