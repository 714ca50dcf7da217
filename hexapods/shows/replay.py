"""Replays: a show that can be at any moment of its run, in segments of frames.

As in adaptive streaming (HLS, DASH) a run's time is divided into segments of `SEGMENT_FRAMES`
frames. At level 0 they follow each other 30 times a second of the run's time, at each level above
half as often, at each level below twice as often: a page takes the level at which it draws about 30
pictures a second at its own speed.
"""

import math
import threading
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from hexapods.domain.errors import HexapodError
from hexapods.domain.records import Record
from hexapods.runs.clocks import Clock
from hexapods.shows.practice_show import PracticeShow
from hexapods.shows.race_show import RaceShow
from hexapods.shows.show import IdleShow, ReplayMark, RunLabel
from hexapods.shows.stage_frame import StageFrame

FRAMES_PER_S = 30.0
SEGMENT_FRAMES = 64
_ROUNDED_S = 0.0005 + 1e-9
"""Time by which the end of what is recorded may be told too late [s]."""
LOWEST_LEVEL, HIGHEST_LEVEL = -3, 7
"""From 240 frames a second of the run's time to one in 4.3 s."""
SCENES_PER_S = 5.0
"""Rate at which pages receive the figures of a moment beside its picture."""


def level_of(rate: float) -> int:
    """Return the level at which about 30 frames are shown a second.

    Args:
        rate: seconds of the run's time per second.
    """
    if rate <= 0:
        return LOWEST_LEVEL
    return min(max(round(math.log2(rate)), LOWEST_LEVEL), HIGHEST_LEVEL)


def interval_s(level: int) -> float:
    """Return the time between two frames of a level [s]."""
    return 2.0**level / FRAMES_PER_S


class NoSuchSegment(HexapodError):
    """A segment is past the end of what is recorded."""


@dataclass(frozen=True, kw_only=True)
class ReplayView(Record):
    """Plan by which a page plays a run by itself; times are the run's own [s].

    Attributes:
        ghost_id: of the run whose lanes are shown as ghosts.
        clock: that times a race; null for a training.
        complete: whether the run will record no more.
        duration_s: null while it is not known.
        recorded_s: intervals that can be shown; of a long practice the first and newest steps.
        step_ends_s: for each lane, of its recorded steps.
        frame_s: time between two frames of level 0.
        segment_frames: number of frames in a segment.
        lowest_level: each level has half as many frames as the one below.
        version: version of the frames; a segment that is requested with it never changes once it
            has all its frames.
    """

    run_id: str
    ghost_id: str | None
    kind: Literal["training", "race"]
    clock: Clock | None
    complete: bool
    duration_s: float | None
    recorded_s: list[tuple[float, float]]
    step_ends_s: list[list[float]]
    marks: list[ReplayMark]
    frame_s: float
    segment_frames: int
    lowest_level: int
    highest_level: int
    version: str


class Replay:
    """A run that can be looked at in any moment. Thread-safe.

    Args:
        show: playback of the run.
        label: what its frames say of it.
        ghost: another run of the same kind, complete, whose lanes are shown as ghosts, each at the
            same time of its own; in the end they stand still.
        is_complete: whether the run will record no more.
    """

    def __init__(
        self,
        show: RaceShow | PracticeShow | IdleShow,
        label: RunLabel,
        ghost: "Replay | None" = None,
        *,
        is_complete: bool = True,
    ) -> None:
        self.show, self.label, self.ghost, self.is_complete = show, label, ghost, is_complete
        self._lock = threading.Lock()
        self._spec = replace(show.spec, ghosts=ghost.show.spec) if ghost else show.spec

    @property
    def recorded(self) -> tuple[tuple[float, float], ...]:
        """Intervals of the run's time that can be shown [s]; none before it has recorded any."""
        with self._lock:
            self.show.update(run_ended=self.is_complete)
            return self.show.recorded

    @property
    def version(self) -> str:
        """Version of the frames; empty for a replay that nothing stores."""
        return ""

    def plan(self) -> ReplayView:
        """Return the recorded intervals, the steps and the marks of the run."""
        with self._lock:
            show = self.show
            return ReplayView(
                run_id=self.label.run_id or "",
                ghost_id=self.ghost.label.run_id if self.ghost else None,
                kind="race" if isinstance(show, RaceShow) else "training",
                clock=show.clock if isinstance(show, RaceShow) else None,
                complete=self.is_complete,
                duration_s=show.duration_s,
                recorded_s=list(show.recorded),
                step_ends_s=[
                    [round(t, 5) for t in np.asarray(ends).tolist()] for ends in show.step_ends_s
                ],
                marks=show.marks(),
                frame_s=1 / FRAMES_PER_S,
                segment_frames=SEGMENT_FRAMES,
                lowest_level=LOWEST_LEVEL,
                highest_level=HIGHEST_LEVEL,
                version=self.version,
            )

    def segment_times_s(self, level: int, number: int) -> list[float]:
        """Return the times of a segment's frames that are recorded; the end of the run is the last.

        Playheads tell in milliseconds how much is recorded: a segment that begins at the end as it
        is told has the end as its frame.

        Raises:
            NoSuchSegment: if the segment is past the end, or nothing is recorded yet.
        """
        recorded = self.recorded
        if not recorded:
            raise NoSuchSegment("nothing is recorded yet; request the segment again later")
        step_s, end_s = interval_s(level), recorded[-1][1]
        first = number * SEGMENT_FRAMES
        if first * step_s > end_s + _ROUNDED_S:
            last = math.floor(end_s / step_s / SEGMENT_FRAMES)
            raise NoSuchSegment(
                f"the recording ends at {end_s:.2f} s: at level {level} its last segment is {last}"
            )
        times_s = [(first + n) * step_s for n in range(SEGMENT_FRAMES)]
        recorded_times_s = [time_s for time_s in times_s if time_s <= end_s]
        if not recorded_times_s or (len(recorded_times_s) < SEGMENT_FRAMES and self.is_complete):
            recorded_times_s.append(end_s)
        return recorded_times_s

    def start_frame(self) -> StageFrame:
        """Return the frame before the first step: the same whatever is recorded."""
        with self._lock:
            frame = self.show.start(self.label)
        ghosts = self.ghost.start_frame().lanes if self.ghost else frame.ghost_lanes
        return replace(frame, spec=self._spec, ghost_lanes=ghosts)

    def frame_at(self, time_s: float) -> StageFrame:
        """Return the frame at a time [s], or at the nearest that is recorded.

        That at the time-out of a race is its photo finish.
        """
        with self._lock:
            self.show.seek(time_s)
            frame = self.show.frame(self.label)
        if frame.time_s == frame.time_out_s and not frame.ended:
            frame = replace(frame, phase="photo-finish")
        ghosts = self.ghost.frame_at(frame.time_s).lanes if self.ghost else frame.ghost_lanes
        return replace(frame, spec=self._spec, ghost_lanes=ghosts, shown_speed=1.0)
