"""Recordings survive a restart; incremental writes, resuming, and the LRU cache."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.storage import stored_trainings
from app.storage.database.store import RunStore
from app.storage.recordings import CACHE_RECORDINGS, Recordings
from app.storage.stored_races import GrowingRace
from app.storage.stored_trainings import GrowingTraining, read_training
from hexapods.runs.recording import LaneRecording, PracticeRecording
from hexapods.runs.records import Evaluated, StepTaken
from hexapods.runs.transition_log import Logged, TransitionLog, Transitions
from tests.runs.sample_lanes import lane, step
from tests.runs.test_stored_practice import assert_same, practise
from tests.storage.stores import copy_new_database, opened, race, training


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    copy_new_database(tmp_path)
    with opened(tmp_path, None) as opened_store:
        yield opened_store


def record(recordings: Recordings, run_id: str, practised: PracticeRecording) -> None:
    recordings.begin_training(run_id, practised.rest_qpos)
    for step_taken in practised.steps:
        recordings.add(run_id, step_taken)
    for evaluation in practised.evaluations:
        recordings.add(run_id, evaluation)


def test_training_recording_survives_a_restart(store: RunStore) -> None:
    store.create(training("a"))
    practised = practise(700)
    recordings = Recordings(store)
    assert recordings.training("a") is None
    record(recordings, "a", practised)
    recordings.finish("a")
    for reader in (recordings, Recordings(store)):
        recording = reader.training("a")
        assert recording is not None
        assert_same(recording, of_newest_motion(practised))
        assert reader.training("a") is recording
    assert_stored(store, practised)


def test_race_recordings_survive_a_restart(store: RunStore) -> None:
    store.create(race("a"))
    lanes = [lane(step(1, [0.1, 0.2])), LaneRecording("greedy", np.zeros(8, np.float32))]
    lanes[1].failure = "It fell."
    recordings = Recordings(store)
    recordings.begin_race("a", lanes)
    recordings.finish("a")
    assert recordings.race("a") is lanes
    stored = Recordings(store).race("a")
    assert stored is not None
    assert [(o.agent, len(o.steps), o.failure) for o in stored] == [
        ("greedy", 1, None),
        ("greedy", 0, "It fell."),
    ]
    assert np.array_equal(stored[0].steps[0].motion.qpos, lanes[0].steps[0].motion.qpos)


def test_resumed_training_continues_the_saved_recording(store: RunStore) -> None:
    store.create(training("a"))
    whole = practise(100)
    recordings = Recordings(store)
    record(recordings, "a", whole)
    recordings.save("a")

    resumed = Recordings(store)
    resumed.begin_training("a", whole.rest_qpos, after_step=45)
    truncated = resumed.training("a")
    assert truncated is not None
    assert truncated.steps[-1].step == 45
    for step_taken in whole.steps[45:]:
        resumed.add("a", step_taken)
    for evaluation in whole.evaluations[4:]:
        resumed.add("a", evaluation)
    resumed.finish("a")
    assert_stored(store, whole)


def test_evaluations_of_a_long_training_are_not_all_in_memory(store: RunStore) -> None:
    """Each has the motion of 50 steps: 80 kB. In the files they all are, also after a resume."""
    store.create(training("a"))
    practised = practise(450)
    recordings = Recordings(store)
    record(recordings, "a", practised)
    recordings.save("a")
    growing = recordings.training("a")
    assert growing is not None
    # Those of the last file, which will be written again, and in any case the newest one.
    assert [evaluation.step for evaluation in growing.evaluations if evaluation.motion] == [
        410,
        420,
        430,
        440,
        450,
    ]
    recordings.finish("a")
    assert_stored(store, practised)

    recordings.begin_training("a", practised.rest_qpos, after_step=305)
    for step_taken in practised.steps:
        if step_taken.step > 305:
            recordings.add("a", step_taken)
    for evaluation in practised.evaluations[30:]:
        recordings.add("a", evaluation)
    recordings.finish("a")
    assert_stored(store, practised)


def of_newest_motion(recording: PracticeRecording) -> PracticeRecording:
    """Return a recording as it is read: of its evaluations only the newest has its motion."""
    *earlier, newest = recording.evaluations
    shown = PracticeRecording(recording.rest_qpos)
    stripped = [replace(evaluation, motion=None) for evaluation in earlier]
    records: list[StepTaken | Evaluated] = [*recording.steps, *stripped, newest]
    for step_or_evaluation in records:
        shown.add(step_or_evaluation)
    return shown


def assert_stored(store: RunStore, recording: PracticeRecording) -> None:
    stored = read_training(store, "a")
    assert stored is not None
    assert_same(stored, recording)


def logged(steps: int) -> TransitionLog:
    """Return a log in which every step differs from its neighbours."""
    cells = np.arange(steps + 1, dtype=np.uint8)[:, None] % [5, 3, 2]
    log = TransitionLog()
    actions = np.stack([np.arange(steps) % 3, np.arange(steps) % 5], 1).astype(np.uint8)
    rewards = np.arange(steps) / 7
    log.extend(Transitions(0, cells.astype(np.uint8), cells.astype(np.uint8), actions, rewards))
    return log


def steps_of(log: TransitionLog | None) -> list[Logged]:
    assert log is not None
    return [log.part(0, len(log)).step(number) for number in range(len(log))]


def test_log_survives_restarts_and_is_cut_where_the_training_resumes(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stored_trainings, "TRANSITIONS_PER_FILE", 20)
    store.create(training("a"))
    whole, rest = logged(70), practise(1).rest_qpos
    recordings = Recordings(store)
    recordings.begin_training("a", rest)
    recordings.log("a", whole.part(0, 25))
    recordings.save("a")
    recordings.log("a", whole.part(25, 65))
    recordings.save("a")
    assert steps_of(Recordings(store).transitions("a")) == steps_of(whole)[:65]

    resumed = Recordings(store)
    resumed.begin_training("a", rest, after_step=33)
    resumed.log("a", whole.part(33, 36))
    resumed.finish("a")
    # Files of steps that it has not taken again are left, and not read.
    assert store.artifact("a", "transitions-0003.npz") is not None
    for reader in (resumed, Recordings(store)):
        assert steps_of(reader.transitions("a")) == steps_of(whole)[:36]


def test_training_without_a_whole_log_has_none(store: RunStore) -> None:
    """As one that began in the middle."""
    store.create(training("a"))
    recordings = Recordings(store)
    recordings.begin_training("a", practise(1).rest_qpos, after_step=10)
    recordings.log("a", logged(20).part(10, 20))
    recordings.finish("a")

    assert recordings.transitions("a") is None


def test_saving_again_writes_only_new_files(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    put_artifact = store.put_artifact

    def spy(run_id: str, name: str, data: bytes, **fields: Any) -> None:
        written.append(name)
        put_artifact(run_id, name, data, **fields)

    monkeypatch.setattr(store, "put_artifact", spy)
    monkeypatch.setattr(stored_trainings, "EVALUATIONS_PER_FILE", 2)
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


def test_cache_evicts_the_least_recently_used_recording(store: RunStore) -> None:
    recordings = Recordings(store)
    practised = practise(10)
    ids = [f"t{number}" for number in range(CACHE_RECORDINGS + 1)]
    for run_id in ids:
        store.create(training(run_id))
        record(recordings, run_id, practised)
        recordings.finish(run_id)
    newest, oldest = recordings.training(ids[-1]), recordings.training(ids[0])
    assert recordings.training(ids[-1]) is newest
    assert oldest is not None
    assert_same(oldest, of_newest_motion(practised))
    for run_id in ids[1:]:
        recordings.training(run_id)
    assert recordings.training(ids[0]) is not oldest


def test_deleted_run_has_no_recording(store: RunStore) -> None:
    store.create(training("a", state="finished"))
    recordings = Recordings(store)
    record(recordings, "a", practise(10))
    recordings.finish("a")
    store.delete("a")
    recordings.discard("a")
    assert recordings.training("a") is None


def test_damaged_recording_is_returned_as_none(store: RunStore, tmp_path: Path) -> None:
    store.create(race("a"))
    recordings = Recordings(store)
    recordings.begin_race("a", [lane()])
    recordings.finish("a")
    (file,) = (path for path in tmp_path.rglob("artifacts/*/*") if path.is_file())
    file.write_bytes(file.read_bytes()[:-1])
    assert Recordings(store).race("a") is None


def test_a_log_can_be_read_while_its_training_ends(store: RunStore) -> None:
    store.create(training("a"))
    recordings = Recordings(store)

    class EndsOnceSeen(dict[str, GrowingTraining | GrowingRace]):
        def __contains__(self, run_id: object) -> bool:
            was_there = super().__contains__(run_id)
            self.pop(str(run_id), None)
            return was_there

    recordings._growing = EndsOnceSeen()
    recordings.begin_training("a", np.zeros(8, np.float32))
    assert recordings.transitions("a") is not None
