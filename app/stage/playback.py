"""Playback of stored runs: their shows, and a cache of their replays.

The stage has one playback position for everybody. A replay (`hexapods.shows.replay`) has none: it
is asked for the frame at a time, so that every page can have a position of its own.
"""

import hashlib
import itertools
import json
import threading
from collections.abc import Callable, Sequence
from typing import Protocol

from cachetools import LRUCache

from app.storage.database.store import RunStore
from app.storage.errors import Conflict
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, Run, world_of
from app.storage.run_kind import with_article
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.world import World
from hexapods.runs.clocks import Clock
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording, PracticeRecording
from hexapods.runs.results import TrainingResult
from hexapods.shows.practice_show import PracticeShow
from hexapods.shows.race_show import Original, RaceShow
from hexapods.shows.replay import Replay
from hexapods.shows.scene_spec import race_scene, training_scene
from hexapods.shows.show import RunLabel

KEPT_BYTES = 50_000_000
"""Capacity of the cache of replays, by the size of their recordings [bytes]; it keeps at least
the newest."""
_KEPT_REPLAYS = 64
_RUNNING_BYTES = KEPT_BYTES // 8
"""Size that a replay of a run that is still computed counts as: its recording grows."""


def show_of(
    run: Run,
    store: RunStore,
    recordings: "Recordings | _HeldRecordings",
    clock: Clock,
    *,
    world: Callable[[], World],
    pace: Callable[[], float | str] = lambda: "max",
) -> RaceShow | PracticeShow:
    """Return the show of a run, at its start.

    Args:
        run: a training or a race.
        store: store of the runs.
        recordings: recordings of the runs.
        clock: times a race.
        world: returns all that happens in a training, as far as it is known.
        pace: returns the present pace of a training that runs.

    Raises:
        InvalidInput: if the run is neither.
    """
    config = run.config
    if isinstance(config, RaceConfig):
        return RaceShow(
            race_scene(config),
            config.steps,
            clock,
            lambda: recordings.race(run.id),
            world=config.world,
            original=original_of(config, store, recordings),
        )
    if not isinstance(config, TrainingConfig):
        article = with_article(run.kind)
        raise InvalidInput(f"{run.id!r} is {article}; only trainings and races can be shown")
    return PracticeShow(
        training_scene(config),
        config.steps,
        config.robot.step_s,
        pace,
        lambda: recordings.training(run.id),
        world=world,
        fell_at_step=run.result.fell_at_step if isinstance(run.result, TrainingResult) else None,
    )


class RaceRecordings(Protocol):
    """The recordings of races that can be read, such as `Recordings`."""

    def race(self, run_id: str) -> Sequence[LaneRecording] | None:
        """Return the recordings of a race's lanes; None if there are none."""


def original_of(config: RaceConfig, store: RunStore, recordings: RaceRecordings) -> Original | None:
    """Return the race from which another branched off; None if there is none, or no longer."""
    branch = config.branch_from
    if branch is None:
        return None
    try:
        world = world_of(store.get(branch.race_id))
        lanes = recordings.race(branch.race_id)
    except HexapodError:
        # Deleted, or its recording cannot be read: the fork can be shown all the same.
        return None
    return Original(branch.step, world, lanes) if lanes else None


_numbers = itertools.count()


class StoredReplay(Replay):
    """Replay of a stored run.

    Args:
        run: the run as it was when the replay was asked for.
        show: its show.
        ghost: see `Replay`.
        recordings: its recordings; None while the run is computed.
    """

    def __init__(
        self,
        run: Run,
        show: RaceShow | PracticeShow,
        ghost: "StoredReplay | None" = None,
        recordings: "_HeldRecordings | None" = None,
    ) -> None:
        label = RunLabel(run.id, run.name, playing=True, replay=True, outcome=run.state)
        super().__init__(show, label, ghost, is_complete=run.state not in NOT_ENDED)
        self.run, self.stored_ghost, self._held = run, ghost, recordings
        self._number = next(_numbers)

    @property
    def version(self) -> str:
        """Version of the frames, see `version_of`."""
        return version_of(self.run, self.stored_ghost.run if self.stored_ghost else None)

    @property
    def recording_number(self) -> tuple[int, int]:
        """Another value for each recording of a run, in this process."""
        show = self.show
        return self._number, show.recording_number if isinstance(show, RaceShow) else 0

    @property
    def size(self) -> int:
        """Approximate size of its recordings in memory [bytes], as far as they were read."""
        size = _RUNNING_BYTES if self._held is None else self._held.size
        return size + (self.stored_ghost.size if self.stored_ghost else 0)


class _HeldRecordings:
    """Recordings of a run that has ended: read once, and kept as far as they are shown."""

    def __init__(self, recordings: Recordings) -> None:
        self._recordings = recordings
        self._training: PracticeRecording | None = None
        self._sizes: dict[str, int] = {}

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        return sum(list(self._sizes.values()))  # whole numbers

    def training(self, run_id: str) -> PracticeRecording | None:
        """Return the recording of the training that is shown; None if there is none."""
        if self._training is None:
            recording = self._recordings.training(run_id)
            if recording is not None:
                self._training = recording.without_evaluation_motions()
                self._sizes[run_id] = self._training.size
        return self._training

    def race(self, run_id: str) -> list[LaneRecording] | None:
        """See `Recordings.race`; a show asks once, and keeps the lanes."""
        lanes = self._recordings.race(run_id)
        self._sizes[run_id] = sum(lane.size for lane in lanes or ())
        return lanes


class Replays:
    """Makes the replays of runs, and keeps the last few. Thread-safe.

    Args:
        store: store of the runs.
        recordings: recordings of the runs.
        max_bytes: capacity of the cache, by the size of the recordings.
    """

    def __init__(
        self, store: RunStore, recordings: Recordings, max_bytes: int = KEPT_BYTES
    ) -> None:
        self._store, self._recordings = store, recordings
        # Each counts as a share of the whole at least, which limits their number, and as the whole
        # at most, so that the newest is kept.
        least = max_bytes // _KEPT_REPLAYS
        self._kept: LRUCache[tuple[str, Clock, str | None], StoredReplay] = LRUCache(
            max_bytes, lambda replay: min(max(replay.size, least), max_bytes)
        )
        self._lock = threading.Lock()

    def version(self, run_id: str, ghost_id: str | None = None) -> str:
        """Return the version that a replay would have; raises as `get`, but for a recording."""
        return version_of(*self._runs(run_id, ghost_id))

    def get(
        self,
        run_id: str,
        clock: Clock,
        ghost_id: str | None = None,
        *,
        needs_recording: bool = True,
    ) -> StoredReplay:
        """Return the replay of a run, of a race as timed by a clock.

        Args:
            run_id: id of a training or race.
            clock: times a race.
            ghost_id: id of another run of the same kind, whose lanes are shown as ghosts.
            needs_recording: whether a run that has ended must have a recording; else it is shown
                on the start line.

        Raises:
            NotFound: if there is no such run.
            InvalidInput: if it is neither, or the ghost is the run itself or of another kind.
            Conflict: if it has ended without a recording, or the ghost still runs.
        """
        run, ghost = self._runs(run_id, ghost_id)
        key = (run_id, clock, ghost_id)
        with self._lock:
            replay = self._kept.get(key)
            if replay is None or replay.version != version_of(run, ghost):
                replay = self._replay(run, clock, self._replay(ghost, clock) if ghost else None)
                self._kept[key] = replay
        # A run that is computed may have no recording yet.
        missing = [
            shown.run
            for shown in (replay, replay.stored_ghost)
            if shown and not shown.recorded and shown.is_complete
        ]
        with self._lock:
            # Its size is known once it was read.
            self._kept[key] = replay
        for run in missing if needs_recording else ():
            raise Conflict(f"{run.kind} {run.id} is {run.state} and has no recording", run.state)
        return replay

    def _runs(self, run_id: str, ghost_id: str | None) -> tuple[Run, Run | None]:
        run = self._store.get(run_id)
        ghost = None if ghost_id is None else self._store.get(ghost_id)
        if ghost is not None:
            _check_ghost(run, ghost)
        return run, ghost

    def _replay(self, run: Run, clock: Clock, ghost: StoredReplay | None = None) -> StoredReplay:
        world = world_of(run)
        if run.state in NOT_ENDED:
            show = show_of(run, self._store, self._recordings, clock, world=lambda: world)
            return StoredReplay(run, show, ghost)
        recordings = _HeldRecordings(self._recordings)
        show = show_of(run, self._store, recordings, clock, world=lambda: world)
        return StoredReplay(run, show, ghost, recordings)


def _check_ghost(run: Run, ghost: Run) -> None:
    if ghost.id == run.id:
        raise InvalidInput(f"{run.kind} {run.id} cannot be its own ghost; choose another run")
    if ghost.kind != run.kind:
        raise InvalidInput(
            f"{ghost.kind} {ghost.id} cannot be the ghost of {run.kind} {run.id}; choose another "
            f"{run.kind}"
        )
    if ghost.state in NOT_ENDED:
        raise Conflict(
            f"{ghost.kind} {ghost.id} is {ghost.state}; it can be a ghost once it has ended",
            ghost.state,
        )


def version_of(run: Run, ghost: Run | None = None) -> str:
    """Return the version of a run's frames: a hash of all that they depend on but its recording."""
    runs = [
        [
            *(shown.id, shown.created_at, shown.name, shown.changes),
            *(() if shown.state in NOT_ENDED else (shown.state, shown.ended_at)),
        ]
        for shown in (run, ghost)
        if shown
    ]
    return hashlib.sha256(json.dumps(runs, default=str).encode()).hexdigest()[:16]
