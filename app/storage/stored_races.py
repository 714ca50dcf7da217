"""Recordings of races, each stored as one file."""

from collections.abc import Iterator

from app.storage.artifact_file import chunks
from app.storage.database.store import RunStore
from app.storage.npz_artifacts import decoding, read_arrays
from hexapods.runs.race_file import race_chunks, race_recording
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import LaneFailed, LaneStep

RACE = "race.npz"
_PACKED_STEPS = 64
"""Steps of a lane that are packed at once."""


def read_race(store: RunStore, run_id: str) -> list[LaneRecording] | None:
    """Return the recordings of a race's lanes; None if there are none.

    Raises:
        NotFound: if there is no such run.
        DamagedFile: if the file is damaged.
    """
    arrays = read_arrays(store, run_id, RACE)
    if arrays is None:
        return None
    with decoding(f"{RACE} of run {run_id}"):
        return race_recording(arrays)


def stored_chunks(store: RunStore, run_id: str) -> Iterator[bytes] | None:
    """Return the stored recording of a race, in chunks; None if there is none.

    Raises:
        NotFound: if there is no such run.
        DamagedFile: if the file is damaged.
    """
    file = store.open_artifact(run_id, RACE)
    return None if file is None else chunks(file)


class GrowingRace:
    """The recording of a race that runs. One thread adds to it.

    Attributes:
        lanes: the recordings of its lanes, of which many may read.
    """

    def __init__(self, store: RunStore, run_id: str, lanes: list[LaneRecording]) -> None:
        self.lanes, self._store, self._run_id = lanes, store, run_id
        self._stored: list[tuple[int, str | None]] | None = None
        """Number of steps and failure of each lane that are stored."""

    def add(self, record: LaneStep | LaneFailed) -> None:
        """Append a record."""
        lane = self.lanes[record.lane]
        if isinstance(record, LaneFailed):
            lane.failure = record.reason
        else:
            lane.steps.append(record)
            lane.steps.pack(record.lane, at_least=_PACKED_STEPS)

    def checkpoint(self) -> None:
        """Store the steps so far, once there are any.

        Raises:
            StorageFull, StorageFailed: if they cannot be stored.
        """
        if any(len(lane.steps) for lane in self.lanes):
            self.finish()

    def finish(self) -> None:
        """Store the recording, if it is not yet stored.

        Raises:
            StorageFull, StorageFailed: if it cannot be stored; it stays in memory then.
        """
        lanes = [lane.so_far() for lane in self.lanes]
        reached = [(len(lane.steps), lane.failure) for lane in lanes]
        if reached != self._stored:
            size = sum(lane.size for lane in lanes)
            self._store.put_artifact(self._run_id, RACE, race_chunks(lanes), size=size)
            self._stored = reached
