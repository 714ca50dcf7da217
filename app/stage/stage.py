"""The stage: chooses the run that all viewers are shown, and executes playback commands."""

import json
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Literal

from app.domain.errors import HexapodError
from app.domain.world import UNDISTURBED, World
from app.events.bus import Event, EventBus
from app.runs.clocks import Clock
from app.runs.config import TrainingConfig
from app.stage.playback import show_of
from app.stage.show import TIME_LAPSE, IdleShow, RunLabel, Show
from app.stage.stage_frame import StageFrame
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, Run, world_of

REPLAY_AFTER_S = 20.0
_MAX_FRAME_S = 0.25
"""Longest time by which one frame advances playback: after a stall nothing is skipped."""
_RUN_EVENTS = frozenset({"run", "run-deleted"})
_RECENT_RACES = 20


class Stage:
    """Holds the current show and its playlist, and executes playback commands. Thread-safe.

    Runs are read from the store when they are put on the playlist; from then on the bus tells of
    their changes.

    Args:
        store: store of the runs.
        recordings: recordings of the runs.
        bus: tells of changed and deleted runs; receives a `stage` event at each change.
        now: monotonic clock of playback [s].
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._store, self._recordings, self._bus, self._now = store, recordings, bus, now
        self._lock = threading.RLock()
        self._clock: Clock = "paper"
        self._show: Show
        self._world: World
        """All that happens in the run on stage, as far as it is known."""
        self._playlist: list[Run] = []
        """The run on stage, followed by those to be shown after it."""
        self._changes = bus.subscribe(run_ids=())
        """Events about the runs of the playlist."""
        self._replay, self._playing = False, True
        self._speed: float | None = None
        """Speed chosen by a user; None for the show's automatic speed."""
        self._idle_since_s: float | None = None
        self._last_frame_s = self._now()
        self._show_idle_scene()

    def offer(self, run_id: str) -> bool:
        """Show a run that was just submitted, unless a live run is on stage.

        A race that waits for its own trainings is shown after them.

        Returns:
            Whether the run is on stage or in the playlist; if not, `set` can still force it.

        Raises:
            NotFound: if there is no such run.
        """
        with self._lock:
            self._update_playlist()
            run = self._store.get(run_id)
            if self._has_live_run():
                return any(run_id == scheduled.id for scheduled in self._playlist)
            self._load([*run.waiting_for, run_id])
            return True

    def set(
        self,
        run_id: str | None = None,
        time_s: float | None = None,
        playing: bool | None = None,
        speed: float | Literal["time-lapse"] | None = None,
        clock: Clock | None = None,
    ) -> None:
        """Execute playback commands, which the API has validated; None leaves a setting unchanged.

        Args:
            run_id: show this run from its start, unless it is on stage.
            time_s: seek to this time [s].
            playing: play or pause. A show that has ended plays again from its start.
            speed: times real time, or `time-lapse` for the show's automatic speed.
            clock: times a race; see `app.runs.clocks`.

        Raises:
            NotFound: if there is no such run.
            InvalidInput: if the run is an experiment.
        """
        with self._lock:
            self._update_playlist()
            if run_id is not None and run_id != self._run_id:
                self._load([run_id])
            if clock is not None:
                self._show.retime(clock)
                self._clock = clock
            if speed is not None:
                self._speed = None if isinstance(speed, str) else speed
            if playing and self._show.ended and time_s is None:
                time_s = 0.0
            if playing is not None:
                self._playing = playing
            if time_s is not None:
                self._show.seek(time_s)
                self._idle_since_s = None
            self._publish()

    def state(self) -> dict[str, Any]:
        """Return the state of playback in plain types, as `GET /stage` responds."""
        with self._lock:
            self._update_playlist()
            run = self._playlist[0] if self._playlist else None
            return {
                "run_id": self._run_id,
                "kind": self._show.spec.kind,
                "time_s": round(self._show.time_s, 3),
                "playing": self._playing,
                "speed": TIME_LAPSE if self._speed is None else self._speed,
                "clock": self._clock,
                "replay": self._replay,
                "live": run is not None and run.state in NOT_ENDED,
                "ended": self._show.ended,
                "next_run_id": self._playlist[1].id if len(self._playlist) > 1 else None,
                "holder": self._playlist[-1].id if self._has_live_run() else None,
            }

    def frame(self) -> StageFrame:
        """Advance playback to now, by the playback clock, and return its frame."""
        with self._lock:
            now = self._now()
            elapsed_s = min(max(now - self._last_frame_s, 0.0), _MAX_FRAME_S)
            self._last_frame_s = now
            self._update_playlist()
            ended = self._show.ended
            run_ended = not self._playlist or self._playlist[0].state not in NOT_ENDED
            self._show.advance(elapsed_s if self._playing else 0.0, self._speed, run_ended)
            self._advance_playlist(now)
            if self._show.ended != ended:
                self._publish()
            return self._show.frame(self._run_label())

    def scene(self) -> dict[str, Any]:
        """Return the current frame in plain types for the page, without advancing playback."""
        with self._lock:
            return self._show.frame(self._run_label()).scene()

    @property
    def _run_id(self) -> str | None:
        return self._playlist[0].id if self._playlist else None

    def _run_label(self) -> RunLabel:
        name = self._playlist[0].name if self._playlist else "On the start line"
        return RunLabel(self._run_id, name, self._playing, self._replay)

    def _has_live_run(self) -> bool:
        return any(run.state in NOT_ENDED for run in self._playlist)

    def _update_playlist(self) -> None:
        """Apply what the bus told of the playlist's runs since the last call."""
        on_stage = self._run_id
        changes = self._changes.drain()
        for event in changes:
            changed = [_changed(run, event) for run in self._playlist]
            self._playlist = [run for run in changed if run is not None]
        if self._run_id == on_stage:
            if changes and self._playlist:
                self._world = world_of(self._playlist[0])
            return
        if self._playlist:
            self._play(self._playlist)
        else:
            self._show_idle_scene()
            self._publish()

    def _advance_playlist(self, now: float) -> None:
        """After the end of a show start the next of the playlist, or later a replay."""
        if not self._show.ended:
            self._idle_since_s = None
            return
        if len(self._playlist) > 1:
            self._play(self._playlist[1:])
            return
        if self._idle_since_s is None:
            self._idle_since_s = now
        elif now - self._idle_since_s >= REPLAY_AFTER_S:
            self._idle_since_s = now
            self._start_replay()

    def _start_replay(self) -> None:
        finished = self._store.list(kind="race", state="finished", limit=_RECENT_RACES)
        for run in finished.runs:
            try:
                if self._recordings.race(run.id):
                    self._load([run.id], replay=True)
                    return
            except HexapodError:
                # Deleted since it was listed, or its recording cannot be read.
                continue

    def _load(self, run_ids: Sequence[str], replay: bool = False) -> None:
        """Read runs from the store and play them."""
        # Subscribed before the runs are read: each change is in what is read, or comes after it.
        changes = self._bus.subscribe(run_ids, names=_RUN_EVENTS)
        try:
            self._play([self._store.get(run_id) for run_id in run_ids], replay)
        except HexapodError:
            self._bus.remove(changes)
            raise
        self._bus.remove(self._changes)
        self._changes = changes

    def _play(self, playlist: list[Run], replay: bool = False) -> None:
        run = playlist[0]
        show = show_of(
            run,
            self._store,
            self._recordings,
            self._clock,
            world=lambda: self._world,
            pace=lambda: self._pace(run.id),
        )
        self._show, self._world = show, world_of(run)
        self._playlist, self._replay = playlist, replay
        self._playing, self._speed, self._idle_since_s = True, None, None
        self._publish()

    def _pace(self, run_id: str) -> float | str:
        """Return the present pace of a training: its last change, or the configured one."""
        run = next(run for run in self._playlist if run.id == run_id)
        paces = [change["pace"] for change in run.changes if change.get("pace") is not None]
        first = run.config.pace if isinstance(run.config, TrainingConfig) else "max"
        pace: float | str = paces[-1] if paces else first
        return pace

    def _show_idle_scene(self) -> None:
        self._show, self._world, self._playlist = IdleShow(), UNDISTURBED, []
        self._replay, self._playing = False, True
        self._speed, self._idle_since_s = None, None

    def _publish(self) -> None:
        self._bus.publish("stage", self.state())


def _changed(run: Run, event: Event) -> Run | None:
    """Return a run as it is after an event; None if it was deleted or became unreadable."""
    if event.run_id != run.id:
        return run
    view = json.loads(event.data)
    if event.event == "run-deleted" or "damaged" in view:
        return None
    return replace(run, state=view["state"], changes=tuple(view.get("changes", ())))
