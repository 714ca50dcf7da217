"""Recordings of races: stored as one file while they run and when they end, and read from it."""

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.storage.database.store import RunStore
from app.storage.errors import StorageFull
from app.storage.recordings import Recordings
from app.storage.stored_races import RACE, read_race
from hexapods.domain.errors import DamagedFile
from hexapods.runs.race_file import race_recording
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import LaneFailed
from hexapods.runs.step_figures import columns_of, rows_of
from tests.runs.test_recording import a_race, assert_same
from tests.storage.stores import copy_new_database, opened, race

STEPS = 30
AGENTS = ("q-learning", "wave", "random-walk")
"""None that searches, which takes most of the time of a race."""


@pytest.fixture
def store(tmp_path: Path) -> Iterator[RunStore]:
    copy_new_database(tmp_path)
    with opened(tmp_path, None) as opened_store:
        opened_store.create(race("a"))
        yield opened_store


@pytest.fixture(scope="module")
def raced() -> list[LaneRecording]:
    """A race in memory, to which all that was stored and read is compared."""
    return a_race(STEPS, AGENTS)


def record(
    recordings: Recordings, raced: list[LaneRecording], steps: int = STEPS, failed: int = STEPS
) -> None:
    """Record a race: each lane takes a step in turn, the last one fails after some."""
    lanes = [LaneRecording(lane.agent, lane.rest_qpos) for lane in raced]
    recordings.begin_race("a", lanes)
    for number in range(steps):
        for place, lane in enumerate(raced):
            if place < len(raced) - 1 or number < failed:
                recordings.add("a", lane.steps[number])
            elif number == failed:
                recordings.add("a", LaneFailed(place, number + 1, "It fell."))


def assert_recorded(lanes: list[LaneRecording] | None, raced: list[LaneRecording]) -> None:
    assert lanes is not None
    assert [lane.agent for lane in lanes] == [lane.agent for lane in raced]
    for lane, was in zip(lanes, raced, strict=True):
        assert np.array_equal(lane.rest_qpos, was.rest_qpos)
        assert len(lane.steps) == len(was.steps)
        for step, raced_step in zip(lane.steps, was.steps, strict=True):
            assert_same(step, raced_step)
        assert np.allclose(lane.start_qpos(len(was.steps)), was.start_qpos(len(was.steps)))


def test_a_race_is_the_same_while_it_runs_and_after_a_restart(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced)
    assert_recorded(recordings.race("a"), raced)
    assert store.artifact("a", RACE) is None
    recordings.finish("a")
    assert_recorded(recordings.race("a"), raced)
    assert list(store.artifact_files("a")) == [RACE]
    assert_recorded(Recordings(store).race("a"), raced)


def test_figures_are_the_same_growing_and_read_from_the_file(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced)
    growing = recordings.race("a")
    recordings.finish("a")
    stored = Recordings(store).race("a")
    assert growing
    assert stored

    for lane, grown, read in zip(raced, growing, stored, strict=True):
        assert read.steps.size < 2 * lane.steps.size
        figures = lane.steps.figures
        for other in (grown.steps.figures, read.steps.figures):
            assert figures.dtype == other.dtype
            for name in figures.dtype.names or ():
                # Values are stored in single precision.
                tolerance = 1e-6 if name in ("lowest", "highest") else 0
                assert np.allclose(figures[name], other[name], rtol=tolerance, atol=tolerance), name


def test_a_figure_follows_from_the_steps(raced: list[LaneRecording]) -> None:
    lane = raced[0]
    for number, step in enumerate(lane.steps):
        row = lane.steps.figures[number]
        assert row == rows_of(columns_of(step), lane.steps.figures[:number])[0]
        assert row["motion_s"] == step.motion.time_s[-1]
        assert row["furthest_m"] == step.motion.qpos[:, 1].max()
        values = [s.action_values.values for s in lane.steps[: number + 1] if s.action_values]
        assert row["lowest"] == min(0, np.nanmin(values))
        assert row["highest"] == max(0, np.nanmax(values))


def test_a_checkpoint_keeps_the_steps_so_far(store: RunStore, raced: list[LaneRecording]) -> None:
    recordings = Recordings(store)
    for steps in (5, 6, 11):
        record(recordings, raced, steps=steps)
        recordings.save("a")
        recordings.save("a")
        after = [
            LaneRecording(lane.agent, lane.rest_qpos, list(lane.steps)[:steps]) for lane in raced
        ]
        assert_recorded(Recordings(store).race("a"), after)
        assert_recorded(recordings.race("a"), after)
    recordings.finish("a")
    assert_recorded(Recordings(store).race("a"), after)


@pytest.mark.parametrize("failed", [3, 8, 20])
def test_a_lane_that_failed_has_fewer_steps(
    store: RunStore, raced: list[LaneRecording], failed: int
) -> None:
    """Also just after a checkpoint, with no step since."""
    recordings = Recordings(store)
    record(recordings, raced, steps=failed)
    recordings.save("a")
    for lane in raced[:2]:
        recordings.add("a", lane.steps[failed])
    recordings.save("a")
    recordings.add("a", LaneFailed(2, failed + 1, "It fell."))
    recordings.finish("a")
    lanes = Recordings(store).race("a")
    assert lanes is not None

    assert [len(lane.steps) for lane in lanes] == [failed + 1, failed + 1, failed]
    assert [lane.failure for lane in lanes] == [None, None, "It fell."]


def test_a_race_that_begins_anew_keeps_its_last_picture_until_it_stores_another(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    """The server may crash in between."""
    first = Recordings(store)
    record(first, raced, steps=20)
    first.save("a")
    recordings = Recordings(store)
    assert recordings.race("a") is not None
    record(recordings, raced, steps=3)
    stored = Recordings(store).race("a")
    assert stored is not None
    assert [len(lane.steps) for lane in stored] == [20, 20, 20]

    recordings.save("a")
    lanes = Recordings(store).race("a")
    assert lanes is not None
    assert [len(lane.steps) for lane in lanes] == [3, 3, 3]


def test_the_file_of_a_race_is_downloaded_as_it_is(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced, failed=20)
    recordings.finish("a")
    chunks = recordings.race_file("a")
    assert chunks is not None
    data = b"".join(chunks)
    assert data == store.artifact("a", RACE)
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        lanes = race_recording(dict(file))
    assert [len(lane.steps) for lane in lanes] == [30, 30, 20]


def test_a_race_that_cannot_be_stored_stays_in_memory(
    store: RunStore, raced: list[LaneRecording], monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings = Recordings(store)
    record(recordings, raced)

    def full(*_: object, **__: object) -> None:
        raise StorageFull("the disk is full")

    with monkeypatch.context() as patch:
        patch.setattr(store, "put_artifact", full)
        for store_it in (recordings.save, recordings.finish):
            with pytest.raises(StorageFull):
                store_it("a")
    assert_recorded(recordings.race("a"), raced)
    recordings.finish("a")
    assert_recorded(Recordings(store).race("a"), raced)


@pytest.mark.parametrize("content", ["no zip", "no arrays", "other arrays"])
def test_a_file_that_cannot_be_decoded_is_damaged(store: RunStore, content: str) -> None:
    buffer = io.BytesIO()
    if content == "no zip":
        buffer.write(b"PK")
    elif content == "no arrays":
        np.savez(buffer)
    else:
        np.savez(buffer, meta=np.array("[{}]"), counts=np.array([[8, 8]]))
    store.put_artifact("a", RACE, buffer.getvalue())

    with pytest.raises(DamagedFile, match="npz of run a"):
        read_race(store, "a")
    assert Recordings(store).race("a") is None
