"""Rows of trials: kept by key, and deleted with their experiment."""

import pytest

from app.features.experiments.trial_rows import Trials
from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.run import QUEUED
from tests.storage.stores import TRIALS, experiment


def test_trials_are_sorted_and_replaced_by_key(store: RunStore) -> None:
    trials = Trials(store.database)
    store.create(experiment("a"), experiment("b"))
    assert trials.get("a") == []
    first, second = TRIALS
    trials.append("a", [second])
    trials.append("a", [first])
    trials.append("b", [first])
    assert trials.get("a") == TRIALS
    better = {**second, "result": first["result"], "set_aside": None}
    trials.append("a", [better, second, better])
    assert trials.get("a") == [first, better]
    store.change("a", QUEUED, "stopped")
    store.delete("a")
    assert trials.get("b") == [first]
    store.create(experiment("a"))
    assert trials.get("a") == []


def test_an_unknown_run_has_no_trials(store: RunStore) -> None:
    trials = Trials(store.database)
    for run_id in ("none", "", "a\0b", "\ud800", "' OR 1=1 --"):
        for rows in (TRIALS, []):
            with pytest.raises(NotFound):
                trials.append(run_id, rows)
        with pytest.raises(NotFound):
            trials.get(run_id)
