"""Speed-up of experiments by a second worker, and the engine's cost beside a trial.

    python benchmarks/experiment_engine.py --trials 24 --repeats 5

The same trials run on one worker and on two, in turns, so that a machine that slows down meanwhile
slows both. The clusters are started and warmed before, which is not counted. Prints JSON:

- `parallel_efficiency`: time with one worker over twice the time with two, the median of repeats;
- `overhead_ms`: time with one worker that was not spent computing, a trial, and as a share of
  the trial's own time `overhead_share`.
"""

import argparse
import json
import os
import statistics
import time
from collections.abc import Sequence
from typing import NamedTuple

from distributed import Client

from hexapods.experiments.cluster import ClusterSpec, connect
from hexapods.experiments.config import experiment_config
from hexapods.experiments.engine import run_on
from hexapods.experiments.plan import Plan, Trial


class Pass(NamedTuple):
    """One pass over the trials."""

    wall_s: float
    compute_s: float


def learners(simulator: str, count: int) -> list[Trial]:
    """As many trials of Table 1's learners after 500 steps of practice."""
    values = {"seeds": -(-count // 4), "simulator": simulator}
    trials = Plan(experiment_config("sweep", values)).trials()
    return [trial for trial in trials if trial.setting.role == "learner"][:count]


def timed(client: Client, trials: Sequence[Trial]) -> Pass:
    """Run all trials once."""
    began_s = time.perf_counter()
    outcomes = list(run_on(client, trials))
    return Pass(time.perf_counter() - began_s, sum(outcome.compute_s for outcome in outcomes))


def report(single: Sequence[Pass], double: Sequence[Pass], trials: int) -> dict[str, object]:
    """The figures of all repeats."""
    ratios = [a.wall_s / b.wall_s for a, b in zip(single, double, strict=True)]
    overheads_s = [(a.wall_s - a.compute_s) / trials for a in single]
    shares = [(a.wall_s - a.compute_s) / a.compute_s for a in single]
    return {
        "trials": trials,
        "repeats": len(single),
        "cores": os.cpu_count(),
        "load_before": round(os.getloadavg()[0], 2),
        "trial_s": round(statistics.median(a.compute_s / trials for a in single), 4),
        "trials_per_s_one_worker": round(statistics.median(trials / a.wall_s for a in single), 3),
        "trials_per_s_two_workers": round(statistics.median(trials / b.wall_s for b in double), 3),
        "speedups": [round(ratio, 3) for ratio in ratios],
        "parallel_efficiency": round(statistics.median(ratios) / 2, 3),
        "overhead_ms": round(1e3 * statistics.median(overheads_s), 2),
        "overhead_share": round(statistics.median(shares), 5),
    }


def main() -> None:
    """Measure, print, end."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=24)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--simulator", default="mujoco")
    options = parser.parse_args()
    trials = learners(options.simulator, options.trials)
    single_passes: list[Pass] = []
    double_passes: list[Pass] = []
    with connect(ClusterSpec(workers=1)) as single, connect(ClusterSpec(workers=2)) as double:
        timed(single, trials[:2])
        timed(double, trials[:4])
        for _ in range(options.repeats):
            single_passes.append(timed(single, trials))
            double_passes.append(timed(double, trials))
    print(json.dumps(report(single_passes, double_passes, len(trials)), indent=2))


if __name__ == "__main__":
    main()
