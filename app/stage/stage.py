"""What everyone is shown: one show at a time, never dead, and never fought over."""

import math
import threading
import time
from collections.abc import Callable
from typing import Any

from app.domain.errors import InvalidInput
from app.events.bus import EventBus
from app.runs.clocks import Clock, check_clock
from app.runs.config import RaceConfig, TrainingConfig
from app.stage.practice_show import PracticeShow
from app.stage.race_show import RaceShow
from app.stage.scene_spec import idle_scene, race_scene, rest_pose, training_scene
from app.stage.show import TIME_LAPSE, IdleShow, RunLabel, Show
from app.stage.stage_frame import LaneView, StageFrame
from app.storage.errors import Damaged, NotFound
from app.storage.recordings import Recordings
from app.storage.store import UNENDED, Run, RunStore

REPLAY_AFTER_S = 20.0
MIN_SPEED, MAX_SPEED = 0.25, 64.0
_LONGEST_FRAME_S = 0.25
"""A stall of the process is not made up for: nothing may be skipped unseen."""
_LOOK_AGAIN_S = 0.1
_RECENT_RACES = 20


class Stage:
    """Holds the show, and obeys whoever may command it. Safe to use from any thread.

    Args:
        store: knows the runs.
        recordings: what the runs did.
        bus: is told by a `stage` event what changes.
        now: the clock that shows go by, in seconds.
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
        self._bill: list[Run] = []
        """The run on stage, and those that follow."""
        self._replay, self._playing = False, True
        self._speed: float | None = None
        """Chosen by someone; None leaves it to the show."""
        self._idle_since_s: float | None = None
        self._last_s = self._looked_s = self._now()
        self._clear()

    def show(self, run_id: str) -> None:
        """Show a run from its start, whatever is on stage.

        Raises:
            NotFound: if there is no such run.
        """
        with self._lock:
            self._put_on([self._store.get(run_id)])

    def offer(self, run_id: str) -> bool:
        """Show a run that was just started, unless a live run holds the stage.

        A race that waits for its own trainings is shown after them.

        Returns:
            Whether the run has the stage; if not, its starter may still ask for it by `show`.

        Raises:
            NotFound: if there is no such run.
        """
        with self._lock:
            run = self._store.get(run_id)
            if self._is_live():
                return any(run_id == on_bill.id for on_bill in self._bill)
            self._put_on([*map(self._store.get, run.waiting_for), run])
            return True

    def set(
        self,
        run_id: str | None = None,
        time_s: float | None = None,
        playing: bool | None = None,
        speed: float | str | None = None,
        clock: str | None = None,
    ) -> None:
        """Command the show; what is None stays as it is.

        Args:
            run_id: show this run from its start.
            time_s: go there.
            playing: go on, or hold. A show that has ended begins again.
            speed: times real time, or `time-lapse` for the show's own.
            clock: one of `app.runs.clocks.CLOCKS`.

        Raises:
            NotFound: if there is no such run.
            InvalidInput: if the speed, time or clock is none, or the run is an experiment.
        """
        own_speed = None if speed is None else _speed(speed)
        if clock is not None:
            check_clock(clock)
        if time_s is not None and not (math.isfinite(time_s) and time_s >= 0):
            raise InvalidInput(f"time_s must be at least 0 and finite, not {time_s}")
        with self._lock:
            if run_id is not None and run_id != self._run_id:
                self._put_on([self._store.get(run_id)])
            if clock is not None:
                self._show.retime(clock)
                self._clock = clock  # type: ignore[assignment]  # checked above
            if speed is not None:
                self._speed = own_speed
            if playing and self._show.ended and time_s is None:
                time_s = 0.0
            if playing is not None:
                self._playing = playing
            if time_s is not None:
                self._show.seek(time_s)
                self._idle_since_s = None
            self._tell()

    def state(self) -> dict[str, Any]:
        """What `GET /stage` answers."""
        with self._lock:
            run = self._bill[0] if self._bill else None
            return {
                "run_id": self._run_id,
                "kind": self._show.cast.kind,
                "time_s": round(self._show.time_s, 3),
                "playing": self._playing,
                "speed": TIME_LAPSE if self._speed is None else self._speed,
                "clock": self._clock,
                "replay": self._replay,
                "live": run is not None and run.state in UNENDED,
                "ended": self._show.ended,
                "next_run_id": self._bill[1].id if len(self._bill) > 1 else None,
                "holder": self._bill[-1].id if self._is_live() else None,
            }

    def frame(self, now: float | None = None) -> StageFrame:
        """Go on to this moment, and see what is on stage then."""
        with self._lock:
            now = self._now() if now is None else now
            elapsed_s = min(max(now - self._last_s, 0.0), _LONGEST_FRAME_S)
            self._last_s = now
            self._look_again(now)
            ended = self._show.ended
            over = not self._bill or self._bill[0].state not in UNENDED
            self._show.advance(elapsed_s if self._playing else 0.0, self._speed, over)
            self._follow_on(now)
            if self._show.ended != ended:
                self._tell()
            return self._show.frame(self._billing())

    def scene(self) -> dict[str, Any]:
        """What is on stage now in plain types, for the page."""
        with self._lock:
            return self._show.frame(self._billing()).scene()

    @property
    def _run_id(self) -> str | None:
        return self._bill[0].id if self._bill else None

    def _billing(self) -> RunLabel:
        name = self._bill[0].name if self._bill else "On the start line"
        return RunLabel(self._run_id, name, self._playing, self._replay)

    def _is_live(self) -> bool:
        return any(run.state in UNENDED for run in self._fresh_bill())

    def _fresh_bill(self) -> list[Run]:
        """The bill with each run as it is now; one that was deleted, or is damaged, is off it."""
        fresh = []
        for run in self._bill:
            try:
                fresh.append(self._store.get(run.id))
            except (NotFound, Damaged):
                continue
        return fresh

    def _look_again(self, now: float) -> None:
        if now - self._looked_s < _LOOK_AGAIN_S:
            return
        self._looked_s = now
        on_stage, self._bill = self._run_id, self._fresh_bill()
        if self._run_id == on_stage:
            return
        if self._bill:
            self._put_on(self._bill)
        else:
            self._clear()
            self._tell()

    def _follow_on(self, now: float) -> None:
        """What comes after the show: what is next on the bill, or in the end a replay."""
        if not self._show.ended:
            self._idle_since_s = None
            return
        if len(self._bill) > 1:
            self._put_on(self._bill[1:])
            return
        if self._idle_since_s is None:
            self._idle_since_s = now
        elif now - self._idle_since_s >= REPLAY_AFTER_S:
            self._idle_since_s = now
            self._put_on_replay()

    def _put_on_replay(self) -> None:
        finished = self._store.list(kind="race", state="finished", limit=_RECENT_RACES)
        for run in finished.runs:
            if self._recordings.race(run.id):
                self._put_on([run], replay=True)
                return

    def _put_on(self, bill: list[Run], replay: bool = False) -> None:
        self._show = self._show_of(bill[0])
        self._bill, self._replay = bill, replay
        self._playing, self._speed, self._idle_since_s = True, None, None
        self._tell()

    def _show_of(self, run: Run) -> Show:
        config, recordings = run.config, self._recordings
        if isinstance(config, RaceConfig):
            cast = race_scene(config)
            return RaceShow(cast, config.steps, self._clock, lambda: recordings.race(run.id))
        if not isinstance(config, TrainingConfig):
            raise InvalidInput(f"{run.id!r} is an {run.kind}; on stage are trainings and races")
        return PracticeShow(
            training_scene(config),
            config.steps,
            config.robot.step_s,
            lambda: self._pace(run.id),
            lambda: recordings.training(run.id),
        )

    def _pace(self, run_id: str) -> float | str:
        """How a training runs now: as it began, or as it was last told."""
        run = next(run for run in self._bill if run.id == run_id)
        paces = [change["pace"] for change in run.changes if change.get("pace") is not None]
        first = run.config.pace if isinstance(run.config, TrainingConfig) else "max"
        pace: float | str = paces[-1] if paces else first
        return pace

    def _clear(self) -> None:
        """Nobody's show: three robots on the start line."""
        cast = idle_scene()
        lanes = tuple(LaneView(rest_pose(cast), 0, 0, 0.0) for _ in cast.roles)
        still = StageFrame(cast, None, "start-line", "On the start line", lanes)
        self._show, self._bill = IdleShow(cast, still), []
        self._replay, self._playing = False, True
        self._speed, self._idle_since_s = None, None

    def _tell(self) -> None:
        self._bus.publish("stage", self.state())


def _speed(speed: float | str) -> float | None:
    if speed == TIME_LAPSE:
        return None
    if isinstance(speed, bool | str) or not MIN_SPEED <= speed <= MAX_SPEED:
        raise InvalidInput(
            f"speed must be from {MIN_SPEED:g} to {MAX_SPEED:g}, or {TIME_LAPSE}, not {speed}"
        )
    return float(speed)
