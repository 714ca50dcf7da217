"""Playback of a stored run: its show, and a replay that can be at any moment of it.

The stage has one playback position for everybody. A replay has none: it is asked for the frame at a
time, so that every page can have a position of its own.

As in adaptive streaming (HLS, DASH) a run's time is divided into segments of `SEGMENT_FRAMES`
frames. At level 0 they follow each other 30 times a second of the run's time, at each level above
half as often, at each level below twice as often: a page takes the level at which it draws about 30
pictures a second at its own speed.
"""

import json
import math
import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from app.domain.errors import InvalidInput
from app.domain.world import World
from app.runs.clocks import Clock
from app.runs.config import TrainingConfig
from app.runs.race_config import RaceConfig
from app.runs.recording import LaneRecording, PracticeRecording
from app.stage.practice_show import PracticeShow
from app.stage.race_show import RaceShow, original_of
from app.stage.scene_spec import race_scene, training_scene
from app.stage.show import RunLabel
from app.stage.stage_frame import StageFrame
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, Run, world_of

FRAMES_PER_S = 30.0
SEGMENT_FRAMES = 64
LOWEST_LEVEL, HIGHEST_LEVEL = -3, 7
"""From 240 frames a second of the run's time to one in 4.3 s."""
_KEPT_REPLAYS, _KEPT_BYTES = 64, 50_000_000
"""Replays that are kept at most, and the size of their recordings; the newest is always kept."""
_RUNNING_BYTES = _KEPT_BYTES // 8
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
        InvalidInput: if the run is an experiment.
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
        raise InvalidInput(f"{run.id!r} is an {run.kind}; only trainings and races can be shown")
    return PracticeShow(
        training_scene(config),
        config.steps,
        config.robot.step_s,
        pace,
        lambda: recordings.training(run.id),
        world=world,
        fell_at_step=(run.result or {}).get("fell_at_step"),
    )


class Replay:
    """A run that can be looked at in any moment. Thread-safe.

    Args:
        run: the run as it was when the replay was asked for.
        show: its show.
        ghost: another run of the same kind, complete, whose lanes are shown as ghosts, each at the
            same time of its own; in the end they stand still.
        held: its recordings; None while the run is computed.
    """

    def __init__(
        self,
        run: Run,
        show: RaceShow | PracticeShow,
        ghost: "Replay | None" = None,
        held: "_HeldRecordings | None" = None,
    ) -> None:
        self.run, self.show, self.ghost, self._held = run, show, ghost, held
        self.is_complete = run.state not in NOT_ENDED
        """Whether the run will record no more."""
        self._lock = threading.Lock()
        self._label = RunLabel(run.id, run.name, playing=True, replay=True)
        self._spec = replace(show.spec, ghosts=ghost.show.spec) if ghost else show.spec

    @property
    def version(self) -> str:
        """Identifies what the frames are made from, but for the steps that are still to come."""
        return _version_of(self.run, self.ghost.run if self.ghost else None)

    @property
    def size(self) -> int:
        """Approximate size of its recordings in memory [bytes], as far as they were read."""
        own = _RUNNING_BYTES if self._held is None else self._held.size
        return own + (self.ghost.size if self.ghost else 0)

    @property
    def recorded(self) -> tuple[tuple[float, float], ...]:
        """Intervals of the run's time that can be shown [s]; none before it has recorded any."""
        with self._lock:
            self.show.advance(0.0, 1.0, run_ended=self.is_complete)
            return self.show.recorded

    def plan(self) -> dict[str, Any]:
        """Return the recorded intervals, the steps and the marks of the run, in plain types."""
        with self._lock:
            show = self.show
            return {
                "run_id": self.run.id,
                "ghost_id": self.ghost.run.id if self.ghost else None,
                "kind": self.run.kind,
                "clock": show.clock if isinstance(show, RaceShow) else None,
                "complete": self.is_complete,
                "duration_s": show.duration_s,
                "recorded_s": [list(interval) for interval in show.recorded],
                "step_ends_s": [[round(t, 5) for t in ends] for ends in show.step_ends_s],
                "marks": [mark._asdict() for mark in show.marks()],
                "frame_s": 1 / FRAMES_PER_S,
                "segment_frames": SEGMENT_FRAMES,
                "lowest_level": LOWEST_LEVEL,
                "highest_level": HIGHEST_LEVEL,
            }

    def segment_times_s(self, level: int, number: int) -> list[float]:
        """Return the times of a segment's frames that are recorded; the end of the run is the last.

        Raises:
            NotFound: if the segment is past the end.
        """
        interval_s, end_s = 2.0**level / FRAMES_PER_S, self.recorded[-1][1]
        first = number * SEGMENT_FRAMES
        if first * interval_s > end_s:
            last = math.floor(end_s / interval_s / SEGMENT_FRAMES)
            raise NotFound(
                f"the recording ends at {end_s:.2f} s: at level {level} its last segment is {last}"
            )
        times_s = [(first + n) * interval_s for n in range(SEGMENT_FRAMES)]
        recorded = [time_s for time_s in times_s if time_s <= end_s]
        if len(recorded) < SEGMENT_FRAMES and self.is_complete:
            recorded.append(end_s)
        return recorded

    def frame_at(self, time_s: float) -> StageFrame:
        """Return the frame at a time [s], or at the nearest that is recorded."""
        with self._lock:
            self.show.seek(time_s)
            frame = self.show.frame(self._label)
        ghosts = self.ghost.frame_at(frame.time_s).lanes if self.ghost else frame.ghost_lanes
        return replace(frame, spec=self._spec, ghost_lanes=ghosts, shown_speed=1.0)


class _HeldRecordings:
    """Recordings of a run that has ended: read once, and kept as far as they are shown."""

    def __init__(self, recordings: Recordings) -> None:
        self._recordings = recordings
        self._training: PracticeRecording | None = None
        self._sizes: dict[str, int] = {}

    @property
    def size(self) -> int:
        """Approximate size in memory [bytes]."""
        return sum(list(self._sizes.values()))

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
    """

    def __init__(self, store: RunStore, recordings: Recordings) -> None:
        self._store, self._recordings = store, recordings
        self._kept: OrderedDict[tuple[str, Clock, str | None], Replay] = OrderedDict()
        self._lock = threading.Lock()

    def version(self, run_id: str, ghost_id: str | None = None) -> str:
        """Return the version that a replay would have; raises as `get`, but for a recording."""
        return _version_of(*self._runs(run_id, ghost_id))

    def get(self, run_id: str, clock: Clock, ghost_id: str | None = None) -> Replay:
        """Return the replay of a run, of a race as timed by a clock.

        Args:
            run_id: id of a training or race.
            clock: times a race.
            ghost_id: id of another run of the same kind, whose lanes are shown as ghosts.

        Raises:
            NotFound: if there is no such run.
            InvalidInput: if it is an experiment, or the ghost is the run itself or of another kind.
            Conflict: if it has no recording (yet), or the ghost still runs.
        """
        run, ghost = self._runs(run_id, ghost_id)
        key = (run_id, clock, ghost_id)
        with self._lock:
            replay = self._kept.pop(key, None)
            if replay is None or replay.version != _version_of(run, ghost):
                replay = self._replay(run, clock, self._replay(ghost, clock) if ghost else None)
            self._kept[key] = replay
        missing = [one.run for one in (replay, replay.ghost) if one and not one.recorded]
        with self._lock:
            # Their size is known once they were read.
            while len(self._kept) > 1 and self._is_over_capacity():
                self._kept.popitem(last=False)
        for one in missing:
            raise Conflict(f"{one.kind} {one.id} is {one.state} and has no recording", one.state)
        return replay

    def _runs(self, run_id: str, ghost_id: str | None) -> tuple[Run, Run | None]:
        run = self._store.get(run_id)
        ghost = None if ghost_id is None else self._store.get(ghost_id)
        if ghost is not None:
            _check_ghost(run, ghost)
        return run, ghost

    def _replay(self, run: Run, clock: Clock, ghost: Replay | None = None) -> Replay:
        world = world_of(run)
        if run.state in NOT_ENDED:
            show = show_of(run, self._store, self._recordings, clock, world=lambda: world)
            return Replay(run, show, ghost)
        held = _HeldRecordings(self._recordings)
        show = show_of(run, self._store, held, clock, world=lambda: world)
        return Replay(run, show, ghost, held)

    def _is_over_capacity(self) -> bool:
        size = sum(replay.size for replay in self._kept.values())
        return len(self._kept) > _KEPT_REPLAYS or size > _KEPT_BYTES


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


def _version_of(run: Run, ghost: Run | None) -> str:
    runs = [
        [one.id, one.created_at, one.state, one.name, one.changes] for one in (run, ghost) if one
    ]
    return json.dumps(runs, default=str)
