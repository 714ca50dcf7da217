"""Explanations of stored runs: what is kept of them, and for how long."""

import gc
import weakref
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from app.features.explanations import service
from app.features.explanations.service import Explanations
from app.storage.database.store import RunStore
from app.storage.errors import Busy
from app.storage.recordings import Recordings
from app.storage.run import RUNNING
from hexapods.assembly import rebuild_learner
from hexapods.domain.errors import InvalidInput
from hexapods.runs.rebuilding import RebuiltLearner
from hexapods.runs.recording import LaneSteps
from hexapods.runs.transition_log import TransitionLog
from tests.runs.test_rebuilding import config_of, practised
from tests.stage.stage_parts import StageParts
from tests.storage.stores import temporary_store, training


@pytest.fixture
def store() -> Iterator[RunStore]:
    with temporary_store() as opened:
        yield opened


def stored_training(store: RunStore, recordings: Recordings, **fields: Any) -> str:
    """Store a training of 80 steps with its log, as its job does, and return its id."""
    fields = {"state": "running", "config": config_of("q-learning"), "total": 80, **fields}
    store.create(training("a1", **fields))
    recordings.begin_training("a1", np.zeros(25, np.float32))
    recordings.log("a1", practised("q-learning")[1])
    recordings.finish("a1")
    return "a1"


def the_log(recordings: Recordings, run_id: str) -> TransitionLog:
    log = recordings.transitions(run_id)
    assert log is not None
    return log


def test_an_answer_outlives_the_log_that_it_was_read_from(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings = Recordings(store)
    run_id, explanations = stored_training(store, recordings), Explanations(store, recordings)
    built: list[int] = []

    def rebuilt(*arguments: Any) -> RebuiltLearner:
        built.append(1)
        return rebuild_learner(*arguments)

    monkeypatch.setattr(service, "rebuild_learner", rebuilt)
    first = the_log(recordings, run_id)
    step, table = explanations.explain(run_id, 40, 0), explanations.table(run_id, 40, 0, 9)
    recordings.discard(run_id)  # from memory, as others are looked at

    assert the_log(recordings, run_id) is not first
    is_there = weakref.ref(first)
    del first
    gc.collect()
    assert is_there() is None, "a log takes up to 24 MB"
    assert explanations.explain(run_id, 40, 0) is step
    assert explanations.table(run_id, 40, 0, 9) is table
    explanations.explain(run_id, 41, 0)
    assert built == [1], "the learner goes on where it was"


def test_an_answer_is_new_where_the_run_was_changed_before(store: RunStore) -> None:
    recordings = Recordings(store)
    run_id, explanations = stored_training(store, recordings), Explanations(store, recordings)
    steps = [explanations.explain(run_id, number, 0) for number in (40, 50)]
    store.update(run_id, changes=({"step": 45, "settings": {"alpha": 0.9}},))

    assert explanations.explain(run_id, 40, 0) is steps[0]
    assert explanations.explain(run_id, 50, 0) != steps[1]


def test_a_running_training_is_asked_again_for_the_step_that_it_records_next(
    store: RunStore,
) -> None:
    config, recordings = replace(config_of("q-learning"), steps=100), Recordings(store)
    run_id = stored_training(store, recordings, config=config, total=100)
    explanations = Explanations(store, recordings)
    for ask in (explanations.explain, partial(explanations.table, count=9)):
        with pytest.raises(Busy, match="step 81 of run a1 is not recorded yet; ask again later"):
            ask(run_id, 81, 0)
        with pytest.raises(InvalidInput, match=r"step must be from \d to 80, not 101"):
            ask(run_id, 101, 0)
    store.change(run_id, RUNNING, "stopped")
    with pytest.raises(InvalidInput, match="step must be from 1 to 80, not 81"):
        explanations.explain(run_id, 81, 0)


def test_an_answer_is_of_the_steps_that_a_race_took_now(store: RunStore) -> None:
    parts = StageParts(store)
    run, explanations = parts.finished_race(("greedy",)), Explanations(store, parts.recordings)
    answer = explanations.explain(run.id, 3, 0)
    assert explanations.explain(run.id, 3, 0) is answer
    lanes = parts.recordings.race(run.id)
    assert lanes is not None
    first, second, third, *rest = lanes[0].steps
    lanes[0].steps = LaneSteps([first, second, replace(third, reward_m=-0.5), *rest])

    assert b"-0.5" in explanations.explain(run.id, 3, 0)
