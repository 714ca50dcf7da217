"""The stage: draws what its state machine says, and executes playback commands."""

import logging
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, Literal

from app.events.bus import Channel, Event, Subscription
from app.stage import planning
from app.stage.playback import show_of, version_of
from app.stage.recorded_runs import newest_race, run_of_last_work
from app.stage.stage_view import Announcement, Picture, StageView, stage_view
from app.stage.state_machine import Origin, StagedRun, StageState
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, Run, world_of
from hexapods.domain.errors import HexapodError
from hexapods.domain.records import Record
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.clocks import Clock
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.shows.playhead import Playhead
from hexapods.shows.race_show import RaceShow
from hexapods.shows.scene_view import SceneView, scene_view
from hexapods.shows.show import IdleShow, RunLabel, Show
from hexapods.shows.stage_frame import StageFrame

ANNOUNCE_AFTER_S, NEXT_AFTER_S = 10.0, 10.0
"""Time after the end of a show until a replay is announced, and from then until it begins [s]."""
_LONGEST_STALL_S = 2.0
"""Longest time by which playback advances at once: a machine that was suspended goes on there."""
_RUN_EVENTS = frozenset({"run", "run-deleted"})
_logger = logging.getLogger(__name__)
_NO_MEMBERS: Mapping[str, Record] = MappingProxyType({})


class Stage:
    """Holds the stage's state and the show of its run. Thread-safe.

    Runs are read from the store when they are put on the playlist; from then on events tell
    of their changes.

    Args:
        store: store of the runs.
        recordings: recordings of the runs.
        channel: has events of changed and deleted runs; receives a `stage` event at each change.
        now: the server's clock, monotonic [s].
        announces: whether it shows earlier races by itself.
        members: records that features add to its state, by the member's name.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        channel: Channel,
        now: Callable[[], float] = time.monotonic,
        *,
        announces: bool = True,
        members: Mapping[str, Record] = _NO_MEMBERS,
    ) -> None:
        self._store, self._recordings, self.now = store, recordings, now
        self._channel, self._announces = channel, announces
        self._lock = threading.RLock()
        self._clock: Clock = "paper"
        self._state = StageState()
        self._runs: dict[str, Run] = {}
        """The runs of the playlist."""
        self._show: Show = IdleShow()
        self._world: World = UNDISTURBED
        """World of the run on stage, with its disturbances as far as they are known."""
        self._changes = channel.subscribe(run_ids=())
        """Events about the runs of the playlist."""
        self._members = dict(members)
        self._view = stage_view(tuple((name, type(member)) for name, member in members.items()))
        self._playing = True
        self._speed: float | None = None
        """Speed chosen by a user; None for the show's automatic speed."""
        self._waiting_since_s: float | None = None
        """When the show ended, or the next one was announced."""
        self._last_s = self.now()
        """When playback was last advanced, by the clock."""
        self._playhead = self._planned(self._last_s)
        self.changed = threading.Event()
        """Set when somebody has changed what is shown; who waits for it clears it."""

    def restore(self) -> None:
        """Show the end of the run that was last at work, after a start of the server.

        Where it cannot be shown, the stage is empty: its recording is damaged, or of another
        version.
        """
        with self._lock:
            try:
                self._restore()
            except Exception:  # whatever a file holds, the server starts
                _logger.exception("the last run cannot be shown again")
                self._state, self._runs = StageState(), {}
                self._begin()

    def _restore(self) -> None:
        run = run_of_last_work(self._store, self._recordings)
        if run is None:
            return
        try:
            self._load([run.id], "restored")
        except HexapodError:
            return  # it cannot be read; the stage is empty
        self._show.advance(0.0, None, run_ended=True)
        self._show.seek_end()
        self._follow_picture()
        self._publish()

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
            wanted = [*run.waiting_for, run_id]
            if self._state.is_held and self.run_id not in wanted:
                return run_id in self._runs
            self._load(wanted, "started")
            self.changed.set()
            return True

    def set(
        self,
        *,
        run_id: str | None = None,
        time_s: float | None = None,
        playing: bool | None = None,
        speed: float | Literal["time-lapse"] | None = None,
        clock: Clock | None = None,
        end_at_time_out: bool | None = None,
        members: Mapping[str, Record] = _NO_MEMBERS,
        stay: bool = False,
    ) -> None:
        """Execute playback commands, which the API has validated; None leaves a setting unchanged.

        Args:
            run_id: show this run from its start, unless it is on stage; it stays until a person
                chooses another, or a run is started.
            time_s: seek to this time [s].
            playing: play or pause. A show that has ended plays again from its start.
            speed: times real time, or `time-lapse` for the show's automatic speed.
            clock: times a race; see `hexapods.runs.clocks`.
            end_at_time_out: whether the show of a race ends with its photo finish, where the
                ranking is settled, or goes on until its last lane has ended.
            members: new records of members that features add to the state, by name.
            stay: keep the run on stage, as if a person had chosen it.

        Raises:
            NotFound: if there is no such run.
            InvalidInput: if the run is no walk.
        """
        with self._lock:
            self._update_playlist()
            self._move(self.now())
            if run_id is not None:
                self._load([run_id], "chosen")
            if stay:
                self._state = self._state.stay()
            if clock is not None:
                self._show.retime(clock)
                self._clock = clock
            if speed is not None:
                self._speed = None if isinstance(speed, str) else float(speed)
            if end_at_time_out is not None:
                self._show.ends_at_time_out = end_at_time_out
            self._members |= members
            if playing and self._show.ended and time_s is None:
                time_s = 0.0
            if playing is not None:
                self._playing = playing
            if time_s is not None:
                self._show.seek(time_s)
            self._follow_picture()
            self._publish()
            self.changed.set()

    def state(self) -> StageView:
        """Return the state of playback, with the members that features add."""
        with self._lock:
            self._update_playlist()
            state, ids = self._state, [run.id for run in self._state.playlist]
            members: Mapping[str, Any] = self._members
            return self._view(
                run_id=self.run_id,
                kind=self._show.spec.kind,
                phase=state.phase,
                origin=state.origin,
                time_s=round(self._show.time_s, 3),
                playing=self._playing,
                speed="time-lapse" if self._speed is None else self._speed,
                clock=self._clock,
                end_at_time_out=self._show.ends_at_time_out,
                replay=state.origin == "automatic",
                live=state.run is not None and state.run.is_computed,
                ended=self._show.ended,
                next_run_id=ids[1] if len(ids) > 1 else None,
                holder=ids[-1] if state.is_held else None,
                announced=self._announcement(),
                sent_s=round(self.now(), 4),
                version=self._version,
                playhead=self._playhead,
                **members,
            )

    def advance(self) -> bool:
        """Advance playback to now.

        Returns:
            whether the picture follows another playhead since, of which no event has told.
        """
        with self._lock:
            now = self.now()
            self._update_playlist()
            self._move(now)
            if self._follow_picture():
                self._publish()
            self._show_next(now)
            return self._plan(now)

    def frame(self) -> StageFrame:
        """Advance playback to now, and return its frame."""
        with self._lock:
            self.advance()
            return self._show.frame(self._run_label())

    def picture(self) -> Picture:
        """Return what is shown, and at which time."""
        with self._lock:
            run = self._state.run
            is_computed = run is not None and run.is_computed
            return Picture(self.run_id, self._version, self._clock, self._playhead, is_computed)

    def publish(self) -> None:
        """Publish a `stage` event."""
        with self._lock:
            self._publish()

    def scene(self) -> SceneView:
        """Return the view of the current frame for pages, without advancing playback."""
        with self._lock:
            return scene_view(self._show.frame(self._run_label()))

    @property
    def run_id(self) -> str | None:
        """Id of the run on stage. Waits for nothing."""
        run = self._state.run
        return run.id if run else None

    @property
    def _version(self) -> str | None:
        return version_of(self._runs[self.run_id]) if self.run_id else None

    def _move(self, now: float) -> None:
        """Advance the show to a time of the clock [s], as far as the run is recorded."""
        elapsed_s = min(max(now - self._last_s, 0.0), _LONGEST_STALL_S)
        self._last_s = now
        run = self._state.run
        run_ended = run is None or not run.is_computed
        if self._playing:
            self._show.advance(elapsed_s, self._speed, run_ended)
        else:
            self._show.update(run_ended=run_ended)

    def _plan(self, now: float) -> bool:
        """Plan the playhead anew unless the picture still follows it; return if that was needed."""
        is_outdated = planning.is_outdated(self._playhead, self._show, now, is_held=self._is_held)
        if is_outdated:
            self._playhead = self._planned(now)
        return is_outdated

    def _planned(self, now: float) -> Playhead:
        """Return the playhead from a time of the clock on [s]."""
        run = self._state.run
        is_computed = run is not None and run.is_computed
        return planning.planned(
            self._show, now, self._speed, is_held=self._is_held, is_computed=is_computed
        )

    @property
    def _is_held(self) -> bool:
        return not self._playing or self._show.ended

    def _run_label(self) -> RunLabel:
        run = self._state.run
        if run is None:
            return RunLabel(None, "On the start line", self._playing)
        replay, name = self._state.origin == "automatic", self._runs[run.id].name
        return RunLabel(run.id, name, self._playing, replay, run.state)

    def _announcement(self) -> Announcement | None:
        if self._state.announced is None or self._waiting_since_s is None:
            return None
        left_s = self._waiting_since_s + NEXT_AFTER_S - self.now()
        return Announcement(run_id=self._state.announced, in_s=round(max(0.0, left_s), 1))

    def _follow_picture(self) -> bool:
        """Report to the state machine whether the picture is at its end; return if it was not."""
        before = self._state
        self._state = before.apply("reached-end" if self._show.ended else "left-end")
        if self._state is not before:
            self._waiting_since_s = None
        return self._state is not before

    def _update_playlist(self) -> None:
        """Apply the events about runs of the playlist since the last call."""
        changes = self._changes.drain()
        if not changes:
            return
        before, on_stage, version = self._state, self.run_id, self._version
        resumed = [self._apply(event) for event in changes]
        if self.run_id != on_stage or any(resumed):
            self._begin()
        elif self._state != before or self._version != version:
            self._publish()

    def _apply(self, event: Event) -> bool:
        """Apply an event of the bus: a changed run, or one that was deleted or is unreadable.

        Returns:
            whether the race on stage was resumed, which is recorded anew.
        """
        run_id, changed = event.run_id or "", event.run
        if not isinstance(changed, Run):
            self._runs.pop(run_id, None)
            self._state = self._state.remove(run_id)
            return False
        run = self._runs.get(run_id)
        if run is None:
            return False
        self._runs[run_id] = changed
        self._state = self._state.change(_staged(changed))
        if run_id != self.run_id:
            return False
        self._world = world_of(changed)
        # The bus keeps only the newest of several events: the race may have ended again since.
        return run.kind == "race" and run.state not in NOT_ENDED and changed.state != run.state

    def _show_next(self, now: float) -> None:
        """After the end of a show begin the next of the playlist, or announce a replay."""
        state = self._state
        if state.phase == "ended" and len(state.playlist) > 1:
            self._state = state.advance()
            self._begin()
            return
        if not (state.may_announce and self._announces):
            self._waiting_since_s = None
            return
        if self._waiting_since_s is None:
            self._waiting_since_s = now
        waited_s = now - self._waiting_since_s
        if state.announced is not None:
            if waited_s >= NEXT_AFTER_S:
                self._start_replay(state.announced)
        elif waited_s >= ANNOUNCE_AFTER_S:
            self._waiting_since_s = now
            self._announce()

    def _announce(self) -> None:
        """Announce a replay of the newest finished race that is recorded, if there is one."""
        run = newest_race(self._store, self._recordings)
        if run is None:
            return
        # Its deletion ends the announcement.
        changes = self._channel.subscribe([*self._runs, run.id], names=_RUN_EVENTS)
        self._update_playlist()
        self._follow_changes(changes)
        self._state = self._state.announce(run.id)
        self._publish()

    def _start_replay(self, run_id: str) -> None:
        try:
            self._load([run_id], "automatic", is_anew=True)
        except HexapodError:
            # Deleted since it was announced.
            self._state = self._state.remove(run_id)
            self._waiting_since_s = None
            self._publish()

    def _load(self, run_ids: Sequence[str], origin: Origin, *, is_anew: bool = False) -> None:
        """Read runs from the store and show them.

        Args:
            run_ids: ids of the playlist.
            origin: why the first of them is shown.
            is_anew: whether a run that is on stage begins anew; else it goes on.
        """
        # Subscribed before the runs are read: each change is in what is read, or comes after it.
        changes = self._channel.subscribe(run_ids, names=_RUN_EVENTS)
        before = self._state, self._runs
        try:
            runs = [self._store.get(run_id) for run_id in run_ids]
            self._runs = {run.id: run for run in runs}
            playlist = tuple(map(_staged, runs))
            self._state = before[0].show(playlist, origin)
            if is_anew or before[0].run is None or before[0].run.id != playlist[0].id:
                shown = before[0].run, self._show.time_s
                self._begin()
                self._keep_moment(*shown)
            else:
                self._publish()
        except HexapodError:
            self._state, self._runs = before
            changes.close()
            raise
        self._follow_changes(changes)

    def _keep_moment(self, original: StagedRun | None, time_s: float) -> None:
        """Show a race that branches off from the one before at the moment at which both part."""
        config = self._runs[self.run_id].config if self.run_id else None
        branch = config.branch_from if isinstance(config, RaceConfig) else None
        if branch and original and branch.race_id == original.id:
            if isinstance(self._show, RaceShow):
                self._show.seek_branch(time_s)
            self._follow_picture()
            self._publish()

    def _follow_changes(self, changes: Subscription) -> None:
        """Take the events of a new subscription, instead of those of the one before."""
        self._changes.close()
        self._changes = changes

    def _begin(self) -> None:
        """Begin the show of the run that the state machine has put on stage."""
        run_id = self.run_id
        if run_id is None:
            show: Show = IdleShow()
            world = UNDISTURBED
        else:
            run = self._runs[run_id]
            show = show_of(
                run,
                self._store,
                self._recordings,
                self._clock,
                world=lambda: self._world,
                pace=lambda: self._pace(run_id),
            )
            world = world_of(run)
        show.ends_at_time_out = True
        self._show, self._world = show, world
        self._playing, self._speed = True, None
        self._waiting_since_s = None
        self._last_s = self.now()
        self._follow_picture()
        self._publish()

    def _pace(self, run_id: str) -> float | str:
        """Return the present pace of a training: its last change, or the configured one."""
        run = self._runs[run_id]
        paces = [change["pace"] for change in run.changes if change.get("pace") is not None]
        first = run.config.pace if isinstance(run.config, TrainingConfig) else "max"
        pace: float | str = paces[-1] if paces else first
        return pace

    def _publish(self) -> None:
        self._playhead = self._planned(self.now())
        self._channel.publish("stage", self.state())


def _staged(run: Run) -> StagedRun:
    return StagedRun(run.id, run.state, run.started_at is not None)
