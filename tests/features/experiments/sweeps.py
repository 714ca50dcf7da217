"""Small kinematic experiments, and their expected results from a plain loop."""

from typing import Any

from app.features.experiments.trial_rows import Trials
from app.storage.database.store import RunStore
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.plan import Plan
from hexapods.experiments.trial import run_trial


def sweep(seeds: int = 3, **more: Any) -> ExperimentConfig:
    """Return a sweep over one gait with the greedy baseline."""
    fields = {"gaits": ("left-right-origin",), "steps": (60,), **more}
    return experiment_config("sweep", {"seeds": seeds, "simulator": "kinematic", **fields})


def results_of_trials(config: ExperimentConfig) -> dict[str, Any]:
    """Run all trials in this process; results by key, with tuples in place of lists."""
    return {trial.key: run_trial(trial.config).as_json() for trial in Plan(config).trials()}


def stored_results(store: RunStore, run_id: str) -> dict[str, Any]:
    """Return the results in a store by key, with the lists of a database turned into tuples."""
    results: dict[str, Any] = {}
    for row in Trials(store.database).get(run_id):
        assert row["set_aside"] is None
        results[row["key"]] = {**row["result"], "distances_m": tuple(row["result"]["distances_m"])}
    return results
