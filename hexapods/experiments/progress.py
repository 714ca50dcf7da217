"""Progress of an experiment: run the remaining trials, and collect outcomes and cost."""

import time
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import closing
from typing import Any

from hexapods.experiments.cluster import ClusterSpec
from hexapods.experiments.config import ExperimentConfig
from hexapods.experiments.engine import run_trials
from hexapods.experiments.plan import Plan, Trial
from hexapods.experiments.trial import TrialResult
from hexapods.experiments.worker import Outcome


class Progress:
    """Outcomes of an experiment's trials so far, and the time that they took.

    Attributes:
        plan: the plan of the experiment.
        results: results of completed trials, by trial key.
        set_aside: reasons of the trials that were set aside, by trial key.
        compute_s: total time that workers computed.
        wall_s: wall time during which trials ran.
    """

    def __init__(self, config: ExperimentConfig) -> None:
        self.plan = Plan(config)
        self.results: dict[str, TrialResult] = {}
        self.set_aside: dict[str, str] = {}
        self.compute_s = self.wall_s = 0.0

    @property
    def done(self) -> int:
        """Number of trials done, those set aside included."""
        return len(self.results) + len(self.set_aside)

    def add(self, outcome: Outcome) -> None:
        """Add the outcome of a trial; a result replaces the reason of an earlier attempt."""
        self.compute_s += outcome.compute_s
        if outcome.result is None:
            self.set_aside[outcome.key] = outcome.set_aside or "it has no result"
        else:
            self.results[outcome.key] = outcome.result
            self.set_aside.pop(outcome.key, None)

    def remaining(self, retry: bool = False) -> list[Trial]:
        """Return the trials without an outcome, each once.

        Args:
            retry: whether also those that were set aside.
        """
        by_key = {trial.key: trial for trial in self.plan.trials()}
        done_keys = self.results.keys() if retry else self.results.keys() | self.set_aside.keys()
        return [trial for key, trial in by_key.items() if key not in done_keys]

    def run(
        self, trials: Iterable[Trial], spec: ClusterSpec, may_continue: Callable[[], bool]
    ) -> Generator[Outcome, None, None]:
        """Run trials on workers, add each outcome, and yield it; see `run_trials`."""
        started_s = time.monotonic() - self.wall_s

        def poll() -> bool:
            self.wall_s = time.monotonic() - started_s
            return may_continue()

        with closing(run_trials(trials, spec, poll)) as outcomes:
            for outcome in outcomes:
                self.wall_s = time.monotonic() - started_s
                self.add(outcome)
                yield outcome

    def planned(self) -> tuple[dict[str, TrialResult], dict[str, str]]:
        """Return copies of the results and the reasons, without trials that are not in the plan."""
        keys = [trial.key for trial in self.plan.trials()]
        return (
            {key: self.results[key] for key in keys if key in self.results},
            {key: self.set_aside[key] for key in keys if key in self.set_aside},
        )

    def cost(self, workers: int | None) -> Mapping[str, Any]:
        """Return the trials' wall time, compute time and rate, and the workers, for the summary.

        Args:
            workers: number of worker processes; None if unknown.
        """
        return {
            "wall_s": round(self.wall_s, 3),
            "compute_s": round(self.compute_s, 3),
            "trials_per_s": round(self.done / self.wall_s, 3) if self.wall_s > 0 else None,
            "workers": workers,
        }
