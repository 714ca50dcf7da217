"""Settings of the export formats, each declared once with its limits."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Le, MultipleOf

from hexapods.domain.settings import Setting, declared_fields
from hexapods.runs.clocks import Clock

_MIN_SIDE = 64
DEFAULT_CLOCK: Clock = "free"
"""Clock of all exports: robot time, the motion alone, in which servos and joints move without gaps.
"""
_Clock = Annotated[
    Clock,
    Setting(
        title="Clock",
        help="Times a race: free, the motion alone; paper and wall, with the time that decisions "
        "take. A training has the motion alone.",
    ),
]


@dataclass(frozen=True)
class ExportOptions:
    """Base class of a format's options: checks them against their declarations.

    Raises:
        InvalidInput: if one is not valid; the message names what is.
    """

    def __post_init__(self) -> None:
        for name, setting in declared_fields(type(self)).items():  # type: ignore[arg-type]
            setting.check(getattr(self, name))


@dataclass(frozen=True)
class ClockOptions(ExportOptions):
    """Option of an export: the clock by which a race is timed."""

    clock: _Clock = DEFAULT_CLOCK


@dataclass(frozen=True)
class TrajectoryOptions(ClockOptions):
    """Options of a table: its clock, and the lanes of a race that it contains."""

    lane: Annotated[
        int | None, Ge(0), Setting(title="Lane", help="Of a race, from 0 on; all if absent.")
    ] = None


@dataclass(frozen=True)
class VideoOptions(ExportOptions):
    """Settings of a rendered video."""

    width: Annotated[
        int,
        Ge(_MIN_SIDE),
        Le(1920),
        MultipleOf(2),
        Setting(title="Width", help="Of the picture.", unit="pixels"),
    ] = 640
    height: Annotated[
        int,
        Ge(_MIN_SIDE),
        Le(1080),
        MultipleOf(2),
        Setting(title="Height", help="Of the picture.", unit="pixels"),
    ] = 360
    fps: Annotated[
        int, Ge(1), Le(60), Setting(title="Frame rate", help="Frames per second of the video.")
    ] = 30
    playback_speed: Annotated[
        float | None,
        Ge(0.05),
        Le(64),
        Setting(
            title="Playback speed",
            help="Times the run's own time; if absent 1, or as much more as a long run needs.",
        ),
    ] = None
    clock: _Clock = DEFAULT_CLOCK
