"""Small experiments on a cluster, and the processes that it is made of."""

from collections.abc import Iterable

import psutil

from app.experiments.config import ExperimentConfig, experiment_config
from app.experiments.engine import Outcome
from app.experiments.plan import Plan, Trial
from app.experiments.trial import TrialResult, run_trial

POISONOUS = "tests.experiments.poison:Poisonous"


def small(seeds: int = 20, agent: str = "q-learning", steps: int = 30) -> ExperimentConfig:
    """A sweep of kinematic trials that take milliseconds."""
    given = {
        "seeds": seeds,
        "simulator": "kinematic",
        "gaits": ("left-right-origin", "front-back-vertical"),
        "agents": (agent,),
        "steps": (steps,),
    }
    return experiment_config("sweep", given)


def trials_of(config: ExperimentConfig) -> list[Trial]:
    return list(Plan(config).trials())


def one_by_one(trials: Iterable[Trial]) -> dict[str, TrialResult]:
    """What comes of trials without any cluster."""
    return {trial.key: run_trial(trial.config) for trial in trials}


def results(outcomes: Iterable[Outcome]) -> dict[str, TrialResult]:
    """What comes of trials, none of which was set aside."""
    found = {}
    for outcome in outcomes:
        assert outcome.result is not None, outcome
        assert outcome.key not in found, "a trial ends once"
        found[outcome.key] = outcome.result
    return found


def workers_of(process: psutil.Process) -> list[psutil.Process]:
    """The workers that a process has started."""
    found = []
    for child in process.children(recursive=True):
        try:
            if "spawn_main" in " ".join(child.cmdline()):
                found.append(child)
        except psutil.NoSuchProcess:
            continue
    return found
