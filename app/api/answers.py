"""Response models that several routes share; see `app.answer`."""

from typing import Annotated, Literal

from pydantic import Field

from app.answer import Answer
from app.events.run_view import DamagedRunView, RaceView, Settings, TrainingView
from app.stage.state_machine import Origin, Phase
from hexapods.runs.clocks import Clock


class Page(Answer):
    """Page of a list, with cursor pagination.

    Attributes:
        next_cursor: Cursor of the next page; null on the last page.
    """

    next_cursor: str | None


class TrainingPage(Page):
    """Page of trainings."""

    items: list[TrainingView | DamagedRunView]


class RacePage(Page):
    """Page of races."""

    items: list[RaceView | DamagedRunView]


class KeptRun(Answer):
    """A run that could not be deleted, and why."""

    id: str
    reason: str


class DeletedView(Answer):
    """Ids of the runs that were deleted, and those that could not be."""

    deleted: list[str]
    kept: list[KeptRun]


class Announcement(Answer):
    """A replay that the stage will show by itself; `PUT /stage` with `stay` keeps the run."""

    run_id: str
    in_s: Annotated[float, Field(ge=0)]


class StageView(Answer):
    """State of the stage, which shows one run to all viewers.

    Attributes:
        phase: `empty`; `live`: the run is computed; `decided`: it is computed, and its picture is
            at time-out; `showing`: it has ended, its picture has not; `ended`: both have.
        origin: why the run is on stage: it was `started`, a person has `chosen` it, the server
            replays it (`automatic`), or it was shown last before the server's start (`restored`).
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


class SeedsView(Answer):
    """Result of many seeds with these settings: their distances [m] and interquartile mean."""

    settings: Settings
    steps_per_episode: int
    distances_m: list[float]
    walkers: Annotated[float, Field(ge=0, le=1)]
    iqm_m: float


class ComparisonView(Answer):
    """The chosen settings of a practice compared with the defaults."""

    seeds: int
    greedy_m: float
    chosen: SeedsView
    default: SeedsView
    compute_s: float
