"""Interface of playbacks on the stage (`Show`), and the playback of the idle stage."""

from dataclasses import dataclass, replace
from typing import Protocol

from app.stage.stage_frame import SceneSpec, StageFrame

TIME_LAPSE = "time-lapse"


@dataclass(frozen=True)
class RunLabel:
    """Fields of a frame that the stage knows and the show does not."""

    run_id: str | None
    name: str
    playing: bool = True
    replay: bool = False


class Show(Protocol):
    """Playback of one run, or of none. Not thread-safe: the stage holds a lock around calls."""

    spec: SceneSpec

    @property
    def time_s(self) -> float:
        """Playback position in the run's own time [s]."""

    @property
    def ended(self) -> bool:
        """Whether playback has reached the end of a run that will record no more."""

    def advance(self, elapsed_s: float, speed: float | None, run_ended: bool) -> None:
        """Advance the playback position.

        Args:
            elapsed_s: real time since the last call [s]; 0 while playback is paused.
            speed: times real time; None for the show's automatic speed.
            run_ended: whether the run will record no more.
        """

    def seek(self, time_s: float) -> None:
        """Set the playback position to a time [s], or to the nearest that is recorded."""

    def retime(self, clock: str) -> None:
        """Change the clock and keep the corresponding playback position."""

    def frame(self, run_label: RunLabel) -> StageFrame:
        """Return the frame at the playback position."""


class IdleShow:
    """Show of an idle stage: robots stand still on the start line.

    Args:
        spec: the scene.
        still: the frame that is always shown.
    """

    time_s = 0.0
    ended = True

    def __init__(self, spec: SceneSpec, still: StageFrame) -> None:
        self.spec, self._still = spec, still

    def advance(self, elapsed_s: float, speed: float | None, run_ended: bool) -> None:
        """Do nothing: the show has no duration."""

    def seek(self, time_s: float) -> None:
        """Do nothing: the show has no duration."""

    def retime(self, clock: str) -> None:
        """Do nothing: the show has no duration."""

    def frame(self, run_label: RunLabel) -> StageFrame:
        """Return the constant frame."""
        return replace(self._still, playing=run_label.playing)
