"""Recordings outlive the process that made them, and memory does not keep them all."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.runs.recording import LaneRecording, PracticeRecording
from app.storage import stored_recordings
from app.storage.database.store import SqlStore
from app.storage.recordings import Recordings
from app.storage.stored_recordings import KEPT_IN_MEMORY
from tests.runs.made_up import lane, step
from tests.runs.test_stored_practice import assert_same, practise
from tests.storage.stores import opened, race, training


@pytest.fixture
def store(tmp_path: Path) -> Iterator[SqlStore]:
    with opened(tmp_path, None) as found:
        yield found


def record(recordings: Recordings, run_id: str, practised: PracticeRecording) -> None:
    recordings.begin_training(run_id, practised.rest_qpos)
    for taken in practised.steps:
        recordings.add(run_id, taken)
    for evaluation in practised.evaluations:
        recordings.add(run_id, evaluation)


def test_a_training_is_shown_after_a_restart(store: SqlStore) -> None:
    store.create(training("a"))
    practised = practise(700)
    recordings = Recordings(store)
    assert recordings.training("a") is None
    record(recordings, "a", practised)
    recordings.finish("a")
    for looking in (recordings, Recordings(store)):
        found = looking.training("a")
        assert found is not None
        assert_same(found, practised)
        assert looking.training("a") is found


def test_a_race_is_shown_after_a_restart(store: SqlStore) -> None:
    store.create(race("a"))
    lanes = [lane(step(1, [0.1, 0.2])), LaneRecording("greedy", np.zeros(8, np.float32))]
    lanes[1].failure = "It fell."
    recordings = Recordings(store)
    recordings.begin_race("a", lanes)
    recordings.finish("a")
    assert recordings.race("a") is lanes
    found = Recordings(store).race("a")
    assert found is not None
    assert [(o.agent, len(o.steps), o.failure) for o in found] == [
        ("greedy", 1, None),
        ("greedy", 0, "It fell."),
    ]
    assert np.array_equal(found[0].steps[0].motion.qpos, lanes[0].steps[0].motion.qpos)


def test_a_training_goes_on_from_what_was_saved(store: SqlStore) -> None:
    store.create(training("a"))
    whole = practise(100)
    recordings = Recordings(store)
    record(recordings, "a", whole)
    recordings.save("a")

    later = Recordings(store)
    later.begin_training("a", whole.rest_qpos, after_step=45)
    begun = later.training("a")
    assert begun is not None
    assert begun.steps[-1].step == 45
    for one in whole.steps[45:]:
        later.add("a", one)
    for evaluation in whole.evaluations[4:]:
        later.add("a", evaluation)
    later.finish("a")
    found = Recordings(store).training("a")
    assert found is not None
    assert_same(found, whole)


def test_saving_again_writes_only_what_is_new(
    store: SqlStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    put = store.put_artifact

    def noted(run_id: str, name: str, data: bytes) -> None:
        written.append(name)
        put(run_id, name, data)

    monkeypatch.setattr(store, "put_artifact", noted)
    monkeypatch.setattr(stored_recordings, "EVALUATIONS_A_FILE", 2)
    store.create(training("a"))
    practised = practise(60)
    recordings = Recordings(store)
    recordings.begin_training("a", practised.rest_qpos)
    for evaluation in practised.evaluations[:5]:
        recordings.add("a", evaluation)
    recordings.save("a")
    assert written == [*(f"evaluations-000{n}.npz" for n in range(3)), "practice.npz"]
    written.clear()
    recordings.add("a", practised.evaluations[5])
    recordings.save("a")
    assert written == ["evaluations-0002.npz", "practice.npz"]
    again = Recordings(store).training("a")
    assert again is not None
    assert [e.step for e in again.evaluations] == [10, 20, 30, 40, 50, 60]


def test_memory_keeps_the_newest(store: SqlStore) -> None:
    recordings = Recordings(store)
    practised = practise(10)
    ids = [f"t{number}" for number in range(KEPT_IN_MEMORY + 1)]
    for run_id in ids:
        store.create(training(run_id))
        record(recordings, run_id, practised)
        recordings.finish(run_id)
    newest, oldest = recordings.training(ids[-1]), recordings.training(ids[0])
    assert recordings.training(ids[-1]) is newest
    assert oldest is not None
    assert_same(oldest, practised)
    for run_id in ids[1:]:
        recordings.training(run_id)
    assert recordings.training(ids[0]) is not oldest


def test_a_deleted_run_has_no_recording(store: SqlStore) -> None:
    store.create(training("a", state="finished"))
    recordings = Recordings(store)
    record(recordings, "a", practise(10))
    recordings.finish("a")
    store.delete("a")
    recordings.discard("a")
    assert recordings.training("a") is None


def test_a_damaged_recording_is_none(store: SqlStore, tmp_path: Path) -> None:
    store.create(race("a"))
    recordings = Recordings(store)
    recordings.begin_race("a", [lane()])
    recordings.finish("a")
    (file,) = (path for path in tmp_path.rglob("artifacts/*/*") if path.is_file())
    file.write_bytes(file.read_bytes()[:-1])
    assert Recordings(store).race("a") is None
