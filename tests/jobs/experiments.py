"""Small kinematic experiments, and what they come to by a plain loop."""

from typing import Any

from app.experiments.config import ExperimentConfig, experiment_config
from app.experiments.plan import Plan
from app.experiments.trial import run_trial
from app.storage.store import RunStore


def sweep(seeds: int = 3, **more: Any) -> ExperimentConfig:
    """One gait, and greedy beside it."""
    given = {"gaits": ("left-right-origin",), "steps": (60,), **more}
    return experiment_config("sweep", {"seeds": seeds, "simulator": "kinematic", **given})


def tried(config: ExperimentConfig) -> dict[str, Any]:
    """All trials in this process, by key, in plain types but for lists."""
    return {trial.key: run_trial(trial.config).as_json() for trial in Plan(config).trials()}


def stored(store: RunStore, run_id: str) -> dict[str, Any]:
    """The results in a store, by key; those that come out of a database have lists."""
    found: dict[str, Any] = {}
    for row in store.trials(run_id):
        assert row["set_aside"] is None
        found[row["key"]] = {**row["result"], "distances_m": tuple(row["result"]["distances_m"])}
    return found
