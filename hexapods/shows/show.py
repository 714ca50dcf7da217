"""Interface of playbacks on the stage (`Show`), and the playback of the idle stage."""

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from hexapods.domain.records import Record
from hexapods.domain.text import whole
from hexapods.domain.types import FloatArray
from hexapods.runs.clocks import Clock
from hexapods.shows.playhead import Point, simplified
from hexapods.shows.scene_spec import idle_scene, rest_pose
from hexapods.shows.stage_frame import LaneFrame, SceneSpec, StageFrame

TIME_LAPSE = "time-lapse"
MIN_SPEED, MAX_SPEED = 0.25, 64
"""Speeds that a user may choose, times real time."""
_LONGEST_MOVE_S = 1 / 30
"""Longest time by which playback moves at once [s]: its automatic speed depends on its position."""


@dataclass(frozen=True)
class RunLabel:
    """Fields of a frame that the stage knows and the show does not."""

    run_id: str | None
    name: str
    playing: bool = True
    replay: bool = False
    outcome: str = "stopped"
    """State of a run that ended before its last step: `stopped`, `failed` or `interrupted`."""

    def at_step(self, step: int, steps: int, *, halted: bool) -> str:
        """Return the run's name with its progress: "Race 3, stopped at step 26 of 50"."""
        outcome = f"{self.outcome} at " if halted else ""
        return f"{self.name}, {outcome}step {whole(step)} of {whole(steps)}"


MarkKind = Literal["time-out", "crossing", "fall", "disturbance", "evaluation"]


@dataclass(frozen=True)
class ReplayMark(Record):
    """Something that happened in a run, as a point on its timeline.

    Attributes:
        lane: from 0; null if it concerns all lanes.
        step: that begins then, or in which a robot fell, from 0.
        distance_m: that an evaluation reached.
    """

    kind: MarkKind
    time_s: float
    lane: int | None
    step: int | None
    distance_m: float | None


class Show(Protocol):
    """Playback of one run, or of none. Not thread-safe: the stage holds a lock around calls."""

    spec: SceneSpec
    ends_at_time_out: bool
    """Whether the show of a race ends with its photo finish; without effect on others."""

    @property
    def time_s(self) -> float:
        """Playback position in the run's own time [s]."""

    @property
    def ended(self) -> bool:
        """Whether playback has reached the end of a run that will record no more."""

    @property
    def computed_s(self) -> float:
        """Time of the run up to which it is computed, and can be shown [s]."""

    @property
    def duration_s(self) -> float | None:
        """Duration of the run [s]; None while it is not known."""

    @property
    def time_out_s(self) -> float | None:
        """Time-out of a race [s]; None of others, and until it is known."""

    def update(self, *, run_ended: bool) -> None:
        """Take in what the run has recorded.

        Args:
            run_ended: whether it will record no more.
        """

    def move(self, elapsed_s: float, speed: float | None) -> None:
        """Advance the playback position by a short time, within what was taken in.

        Args:
            elapsed_s: real time [s].
            speed: times real time; None for the show's automatic speed.
        """

    def advance(self, elapsed_s: float, speed: float | None, run_ended: bool) -> None:
        """Take in what the run has recorded, and advance the playback position.

        Args:
            elapsed_s: real time since the last call [s]; 0 while playback is paused.
            speed: times real time; None for the show's automatic speed.
            run_ended: whether the run will record no more.
        """

    def upcoming(self, speed: float | None, longest_s: float) -> list[Point]:
        """Return the positions to come, from the present one on, as far as they are computed.

        Args:
            speed: times real time; None for the show's automatic speed.
            longest_s: real time up to which they are wanted [s].

        Returns:
            real times from now on [s], each with the time of the run that is shown then [s].
        """

    def seek(self, time_s: float) -> None:
        """Set the playback position to a time [s], or to the nearest that is recorded."""

    def seek_end(self) -> None:
        """Set the playback position to the end of the show."""

    def retime(self, clock: Clock) -> None:
        """Change the clock and keep the corresponding playback position."""

    def frame(self, run_label: RunLabel) -> StageFrame:
        """Return the frame at the playback position."""


class PlayedShow:
    """Base class of shows whose position moves by itself."""

    def advance(self: "Show", elapsed_s: float, speed: float | None, run_ended: bool) -> None:
        """Take in what the run has recorded, and advance the position; see `Show.advance`."""
        self.update(run_ended=run_ended)
        left_s = elapsed_s
        while True:
            self.move(min(left_s, _LONGEST_MOVE_S), speed)
            left_s -= _LONGEST_MOVE_S
            if left_s <= 0:
                return

    def upcoming(self: "Show", speed: float | None, longest_s: float) -> list[Point]:
        """Return the positions to come; see `Show.upcoming`."""
        # What is recorded is shared: only the position of the copy moves.
        ahead = copy.copy(self)
        points = [(0.0, ahead.time_s)]
        while points[-1][0] < longest_s and not ahead.ended:
            ahead.move(_LONGEST_MOVE_S, speed)
            points.append((points[-1][0] + _LONGEST_MOVE_S, ahead.time_s))
        return simplified(points)


def on_start_line(spec: SceneSpec, run_label: RunLabel, lanes: tuple[LaneFrame, ...]) -> StageFrame:
    """Return the frame of a run before its first step, with its lanes at rest."""
    return StageFrame(
        spec, run_label.run_id, "start-line", run_label.name, lanes, replay=run_label.replay
    )


class IdleShow:
    """Show of an idle stage: robots stand still on the start line."""

    time_s = computed_s = 0.0
    duration_s: float | None = None
    time_out_s: float | None = None
    recorded: tuple[tuple[float, float], ...] = ()
    step_ends_s: Sequence[FloatArray] = ()
    ended = True
    ends_at_time_out = True

    def __init__(self) -> None:
        self.spec = idle_scene()
        self._lanes = tuple(
            LaneFrame(rest_pose(self.spec), 0, 0, 0.0) for _ in self.spec.lane_specs
        )

    def marks(self) -> list[ReplayMark]:
        """Return none: nothing happens."""
        return []

    def update(self, *, run_ended: bool) -> None:
        """Do nothing: the show has no duration."""

    def advance(self, elapsed_s: float, speed: float | None, run_ended: bool) -> None:
        """Do nothing: the show has no duration."""

    def move(self, elapsed_s: float, speed: float | None) -> None:
        """Do nothing: the show has no duration."""

    def upcoming(self, speed: float | None, longest_s: float) -> list[Point]:
        """Return the only position."""
        del speed, longest_s
        return [(0.0, 0.0)]

    def seek(self, time_s: float) -> None:
        """Do nothing: the show has no duration."""

    def seek_end(self) -> None:
        """Do nothing: the show has no duration."""

    def retime(self, clock: Clock) -> None:
        """Do nothing: the show has no duration."""

    def start(self, run_label: RunLabel) -> StageFrame:
        """Return the only frame."""
        return self.frame(run_label)

    def frame(self, run_label: RunLabel) -> StageFrame:
        """Return the frame, which is always the same but for `playing`."""
        return StageFrame(
            self.spec,
            None,
            "start-line",
            run_label.name,
            self._lanes,
            playing=run_label.playing,
            ended=True,
        )
