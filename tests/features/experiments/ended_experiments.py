"""Helpers for tests: ended experiments, stored with all their files."""

import json

from app.features.experiments.stored_trials import trials_as_csv
from app.features.experiments.trial_rows import Trials
from app.storage.database.store import RunStore
from app.storage.run import Run
from hexapods.experiments.config import SUMMARY
from hexapods.experiments.plan import Plan
from hexapods.experiments.result import ExperimentResult
from hexapods.experiments.summary import summarise
from hexapods.experiments.trial import run_trial
from tests.features.experiments.sweeps import sweep


def ended_experiment(store: RunStore, run_id: str) -> Run:
    """Run a sweep, and store it with its trials and summary, but without figures."""
    config = sweep(seeds=3, agents=("q-learning", "greedy"))
    plan = Plan(config)
    store.create(
        Run(id=run_id, kind="experiment", name="It was tried", config=config, total=plan.total)
    )
    results = {trial.key: run_trial(trial.config) for trial in plan.trials()}
    rows = [
        {"key": key, "result": result.as_json(), "set_aside": None, "compute_s": 0.5}
        for key, result in results.items()
    ]
    Trials(store.database).append(run_id, rows)
    summary = summarise(config, results)
    store.put_artifact(run_id, SUMMARY, json.dumps(summary).encode())
    store.put_artifact(run_id, "trials.csv", trials_as_csv(config, rows))
    counted = {name: summary["trials"][name] for name in ("done", "total", "failed")}
    claims = [{name: claim[name] for name in ("id", "verdict")} for claim in summary["claims"]]
    result = {
        "trials": {**counted, "set_aside": 0},
        "claims": claims,
        "files": [SUMMARY, "trials.csv"],
        "shared_machine": False,
    }
    return store.change(run_id, {"queued"}, "finished", done=plan.total, result=result)


def experiment_result(run: Run) -> ExperimentResult:
    """Return the result of an experiment that has one."""
    assert isinstance(run.result, ExperimentResult)
    return run.result
