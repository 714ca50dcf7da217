"""Helpers for tests on a cluster: small experiments, and the cluster's processes."""

from collections.abc import Iterable
from contextlib import suppress

import psutil

from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.plan import Plan, Trial
from hexapods.experiments.trial import TrialResult, run_trial
from hexapods.experiments.worker import Outcome

CRASHING = "tests.experiments.crashing_agent:CrashingAgent"


def small(seeds: int = 20, agent: str = "q-learning", steps: int = 30) -> ExperimentConfig:
    """Return a sweep of kinematic trials that take milliseconds each."""
    values = {
        "seeds": seeds,
        "simulator": "kinematic",
        "gaits": ("left-right-origin", "front-back-vertical"),
        "agents": (agent,),
        "steps": (steps,),
    }
    return experiment_config("sweep", values)


def trials_of(config: ExperimentConfig) -> list[Trial]:
    return list(Plan(config).trials())


def one_by_one(trials: Iterable[Trial]) -> dict[str, TrialResult]:
    """Run trials in this process, without a cluster."""
    return {trial.key: run_trial(trial.config) for trial in trials}


def results(outcomes: Iterable[Outcome]) -> dict[str, TrialResult]:
    """Collect results by key; check that no trial was set aside and each completed once."""
    by_key = {}
    for outcome in outcomes:
        assert outcome.result is not None, outcome
        assert outcome.key not in by_key, "a trial ends once"
        by_key[outcome.key] = outcome.result
    return by_key


def workers_of(process: psutil.Process) -> list[psutil.Process]:
    """Return the worker processes among a process's descendants, by their name."""
    workers = []
    for child in process.children(recursive=True):
        with suppress(psutil.NoSuchProcess):
            if child.name() == "trial worker":
                workers.append(child)
    return workers
