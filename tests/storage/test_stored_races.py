"""Recordings of long races: stored in several files while they run, and read in parts of them."""

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.storage import stored_races
from app.storage.artifact_file import ArtifactFile
from app.storage.artifacts import StoredFile
from app.storage.database.store import RunStore
from app.storage.errors import StorageFull
from app.storage.recordings import Recordings
from app.storage.stored_races import FIGURES, RACE, StoredRaces, race_file
from hexapods.domain.errors import DamagedFile
from hexapods.runs.race_file import race_arrays, race_recording
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


@pytest.fixture(autouse=True)
def small_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of 24 steps: 8 of each lane."""
    monkeypatch.setattr(stored_races, "FILE_STEPS", 24)


def record(
    recordings: Recordings, raced: list[LaneRecording], steps: int = STEPS, failed: int = STEPS
) -> None:
    """Let a race run: each lane takes a step in turn, the last one fails after some."""
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
        for one, other in zip(lane.steps, was.steps, strict=True):
            assert_same(one, other)
        assert np.allclose(lane.start_qpos(len(was.steps)), was.start_qpos(len(was.steps)))


def test_a_race_that_runs_keeps_only_its_newest_steps_in_memory(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced)
    lanes = recordings.race("a")
    assert lanes is not None

    assert [lane.steps.stored for lane in lanes] == [24, 24, 24]
    assert_recorded(lanes, raced)
    recordings.finish("a")
    assert [lane.steps.stored for lane in lanes] == [30, 30, 30]
    assert_recorded(lanes, raced)


def test_a_race_of_several_files_is_the_same_after_a_restart(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced)
    recordings.finish("a")

    names = [race_file(number) for number in range(4)]
    assert names == ["race.npz", "race-0001.npz", "race-0002.npz", "race-0003.npz"]
    assert all(store.artifact("a", name) for name in names)
    assert store.artifact("a", race_file(4)) is None
    assert_recorded(Recordings(store).race("a"), raced)


def test_figures_are_the_same_stored_and_read_from_the_steps(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    """As of a race of an earlier version, or an imported one, which have none stored."""
    recordings = Recordings(store)
    record(recordings, raced)
    growing = recordings.race("a")
    recordings.finish("a")
    stored = Recordings(store).race("a")
    whole = race_arrays(raced)
    buffer = io.BytesIO()
    np.savez(buffer, **whole)  # type: ignore[arg-type]
    store.put_artifact("a", RACE, buffer.getvalue(), replaces_all=True)
    scanned = Recordings(store).race("a")
    assert_recorded(scanned, raced)
    assert growing
    assert stored
    assert scanned

    for lanes in zip(raced, growing, stored, scanned, strict=True):
        one, *others = (lane.steps.figures for lane in lanes)
        for other in others:
            assert one.dtype == other.dtype
            for name in one.dtype.names or ():
                # Values are stored in single precision.
                tolerance = 1e-6 if name in ("lowest", "highest") else 0
                assert np.allclose(one[name], other[name], rtol=tolerance, atol=tolerance), name


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


def test_what_a_crash_left_can_be_shown(store: RunStore, raced: list[LaneRecording]) -> None:
    record(Recordings(store), raced, steps=20)

    assert store.artifact("a", FIGURES) is None
    lanes = Recordings(store).race("a")
    assert lanes is not None
    assert [len(lane.steps) for lane in lanes] == [16, 16, 16]
    for lane, was in zip(lanes, raced, strict=True):
        for one, other in zip(lane.steps, was.steps[:16], strict=True):
            assert_same(one, other)


def test_a_checkpoint_keeps_the_steps_that_fill_no_file_yet(
    store: RunStore, raced: list[LaneRecording]
) -> None:
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


def test_a_race_that_begins_anew_leaves_nothing_of_its_first_attempt(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    record(Recordings(store), raced)
    recordings = Recordings(store)
    assert recordings.race("a") is not None
    record(recordings, raced, steps=9)
    recordings.finish("a")

    assert store.artifact("a", race_file(2)) is None
    lanes = Recordings(store).race("a")
    assert lanes is not None
    assert [len(lane.steps) for lane in lanes] == [9, 9, 9]


def test_a_race_that_begins_anew_keeps_its_last_picture_until_it_stores_another(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    """The server may crash in between."""
    record(Recordings(store), raced, steps=20)
    recordings = Recordings(store)
    record(recordings, raced, steps=3)
    kept = Recordings(store).race("a")
    assert kept is not None
    assert [len(lane.steps) for lane in kept] == [16, 16, 16]

    recordings.save("a")
    lanes = Recordings(store).race("a")
    assert lanes is not None
    assert [len(lane.steps) for lane in lanes] == [3, 3, 3]
    assert list(store.artifact_files("a")) == [RACE]


@pytest.mark.parametrize("failed", [3, 8, 20])
def test_a_lane_that_failed_has_fewer_steps(
    store: RunStore, raced: list[LaneRecording], failed: int
) -> None:
    """Also just after a file was written, with no step since."""
    recordings = Recordings(store)
    record(recordings, raced, steps=failed + 1, failed=failed)
    recordings.finish("a")
    lanes = Recordings(store).race("a")
    assert lanes is not None

    assert [len(lane.steps) for lane in lanes] == [failed + 1, failed + 1, failed]
    assert [lane.failure for lane in lanes] == [None, None, "It fell."]


def test_the_files_of_a_race_are_downloaded_as_one(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced, failed=20)
    recordings.finish("a")
    chunks = recordings.race_file("a")
    assert chunks is not None
    with np.load(io.BytesIO(b"".join(chunks)), allow_pickle=False) as file:
        arrays = dict(file)
    lanes = recordings.race("a")
    assert lanes is not None
    expected = race_arrays(lanes)

    assert arrays.keys() == expected.keys()
    for name, array in arrays.items():
        assert array.dtype == expected[name].dtype, name
        assert array.tobytes() == expected[name].tobytes(), name
    assert [len(lane.steps) for lane in race_recording(arrays)] == [30, 30, 20]


def test_steps_that_cannot_be_stored_stay_in_memory(
    store: RunStore, raced: list[LaneRecording], monkeypatch: pytest.MonkeyPatch
) -> None:
    recordings = Recordings(store)
    record(recordings, raced, steps=7)

    def full(*_: object, **__: object) -> None:
        raise StorageFull("the disk is full")

    for lane in raced[:2]:
        recordings.add("a", lane.steps[7])
    with monkeypatch.context() as patch:
        patch.setattr(store, "put_artifact", full)
        with pytest.raises(StorageFull):
            recordings.add("a", raced[2].steps[7])
    recordings.finish("a")
    lanes = Recordings(store).race("a")
    assert lanes is not None
    assert [len(lane.steps) for lane in lanes] == [8, 8, 8]


def test_what_is_kept_of_what_was_read_is_bounded(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    """Even if one part alone is over the limit."""
    recordings = Recordings(store)
    record(recordings, raced)
    recordings.finish("a")
    for limit in (0, 50_000, 100_000_000):
        races = StoredRaces(store, limit)
        assert_recorded(races.read("a"), raced)
        blocks = races._blocks
        kept = sum(block.nbytes for block in blocks.values())
        assert kept == blocks.currsize <= limit
    assert len(blocks) == 3 * 4


def test_a_compressed_race_of_an_early_version_is_shown_and_downloaded(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **race_arrays(raced))  # type: ignore[arg-type]
    store.put_artifact("a", RACE, buffer.getvalue())
    recordings = Recordings(store)

    assert_recorded(recordings.race("a"), raced)
    chunks = recordings.race_file("a")
    assert chunks is not None
    assert b"".join(chunks) == buffer.getvalue()


@pytest.mark.parametrize("name", [RACE, FIGURES])
@pytest.mark.parametrize("content", ["no zip", "no arrays", "compressed", "other arrays"])
def test_a_file_that_cannot_be_decoded_is_damaged(
    store: RunStore, raced: list[LaneRecording], name: str, content: str
) -> None:
    record(Recordings(store), raced)
    store.put_artifact("a", name, undecodable(content))

    with pytest.raises(DamagedFile, match="npz of run a"):
        StoredRaces(store).read("a")
    assert Recordings(store).race("a") is None


def undecodable(content: str) -> bytes:
    buffer = io.BytesIO()
    arrays = {"meta": np.array("[{}]"), "counts": np.array([[8, 8]])}
    if content == "no zip":
        buffer.write(b"PK")
    elif content == "no arrays":
        np.savez(buffer)
    elif content == "compressed":
        np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
    else:
        np.savez(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def test_what_was_read_of_a_race_is_never_mixed_with_its_next_attempt(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced, steps=6)
    recordings.finish("a")
    lanes = Recordings(store).race("a")
    assert lanes is not None
    record(recordings, raced)
    recordings.finish("a")

    with pytest.raises(DamagedFile, match=r"race.npz of run a was replaced"):
        lanes[0].steps[0]


def test_a_reader_across_a_resume_leaves_nothing_stale(
    store: RunStore, raced: list[LaneRecording], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The race is resumed after it looked up where the arrays are, before it opens the file."""
    recordings = Recordings(store)
    record(recordings, raced, steps=6)
    recordings.finish("a")
    lanes = StoredRaces(store, max_bytes=0).read("a")
    assert lanes is not None
    assert_same(lanes[0].steps[0], raced[0].steps[0])

    def resume_first(stored: StoredFile, label: str, *, is_verified: bool) -> ArtifactFile:
        assert is_verified
        monkeypatch.undo()
        monkeypatch.setattr(stored_races, "FILE_STEPS", 24)
        record(recordings, raced)
        recordings.finish("a")
        return store.open_file(stored, label, is_verified=is_verified)

    monkeypatch.setattr(store, "open_file", resume_first)
    with pytest.raises(DamagedFile, match="replaced"):
        lanes[0].steps[0]
    assert_recorded(recordings.race("a"), raced)


def test_a_download_across_a_resume_ends_with_an_error(
    store: RunStore, raced: list[LaneRecording]
) -> None:
    recordings = Recordings(store)
    record(recordings, raced, steps=6)
    recordings.finish("a")
    chunks = recordings.race_file("a")
    assert chunks is not None
    next(chunks)
    record(recordings, raced)
    recordings.finish("a")

    with pytest.raises(DamagedFile, match="replaced"):
        b"".join(chunks)
