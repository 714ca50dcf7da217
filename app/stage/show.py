"""What the shows have in common: something that is played, sought in, and ends."""

from dataclasses import dataclass, replace
from typing import Protocol

from app.stage.stage_frame import SceneSpec, StageFrame

TIME_LAPSE = "time-lapse"


@dataclass(frozen=True)
class RunLabel:
    """What the stage knows of a show, for its frames."""

    run_id: str | None
    name: str
    playing: bool = True
    replay: bool = False


class Show(Protocol):
    """One run, or none, on stage. Not thread-safe; the stage sees to that."""

    cast: SceneSpec

    @property
    def time_s(self) -> float:
        """Where the show is, in the run's own time."""

    @property
    def ended(self) -> bool:
        """Whether all there will ever be has been shown."""

    def advance(self, elapsed_s: float, speed: float | None, over: bool) -> None:
        """Go on.

        Args:
            elapsed_s: real time since the last call; 0 while it is not playing.
            speed: how many times real time; None leaves it to the show.
            over: whether the run will record no more.
        """

    def seek(self, time_s: float) -> None:
        """Go to a time, or to the nearest that can be shown."""

    def retime(self, clock: str) -> None:
        """Show the same under another clock, at the corresponding place."""

    def frame(self, run_label: RunLabel) -> StageFrame:
        """What is to be seen now."""


class IdleShow:
    """Robots that stand on the start line and wait for someone to press a button."""

    time_s = 0.0
    ended = True

    def __init__(self, cast: SceneSpec, still: StageFrame) -> None:
        self.cast, self._still = cast, still

    def advance(self, elapsed_s: float, speed: float | None, over: bool) -> None:
        """Nothing goes on."""

    def seek(self, time_s: float) -> None:
        """There is nowhere to go."""

    def retime(self, clock: str) -> None:
        """It takes no time."""

    def frame(self, run_label: RunLabel) -> StageFrame:
        """Always the same poses."""
        return replace(self._still, playing=run_label.playing)
