"""Records of a stage: its state as clients have it, and the picture that it shows."""

from functools import cache
from typing import Annotated, Literal, NamedTuple

from annotated_types import Ge

from app.answer import Answer, extended
from app.stage.state_machine import Origin, Phase
from hexapods.domain.records import Record
from hexapods.runs.clocks import Clock
from hexapods.shows.playhead import Playhead


class Announcement(Answer):
    """A run that the stage will show again by itself; `PUT /stage` with `stay` keeps its own."""

    run_id: str
    in_s: Annotated[float, Ge(0)]


class StageView(Answer):
    """State of the stage, which shows one run to all viewers.

    Attributes:
        phase: `empty`; `live`: the run is computed; `decided`: it is computed, and its picture is
            at time-out; `showing`: it has ended, its picture has not; `ended`: both have.
        sent_s: time of the server's clock when this was written [s]; only differences count.
        version: of the frames of the run on the stage; null for an empty stage.
        playhead: the moment that is shown, now and later.
        origin: why the run is on the stage: it was `started`, a person has `chosen` it, the server
            shows it again (`automatic`), or it was shown last before the server's start
            (`restored`).
    """

    run_id: str | None
    kind: Literal["idle", "training", "race"]
    phase: Phase
    origin: Origin
    time_s: float
    playing: bool
    speed: float | Literal["time-lapse"]
    clock: Clock
    end_at_time_out: bool
    replay: bool
    live: bool
    ended: bool
    next_run_id: str | None
    holder: str | None
    announced: Announcement | None
    sent_s: float
    version: str | None
    playhead: Playhead


class Picture(NamedTuple):
    """What a stage shows: a run as timed by a clock, or none, and at which time of it."""

    run_id: str | None
    version: str | None
    """Version of the run's frames."""
    clock: Clock
    playhead: Playhead
    is_computed: bool
    """Whether the run is still computed."""


@cache
def stage_view(members: tuple[tuple[str, type[Record]], ...]) -> type[StageView]:
    """Return the record of a stage's state, with members of these names and types."""
    return extended(StageView, dict(members))
