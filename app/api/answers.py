"""Response models that several routes share; see `app.answer`."""

from datetime import datetime
from typing import Annotated

from pydantic import Field

from app.answer import Answer
from app.events.run_view import DamagedRunView, RaceView, Settings, TrainingView


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
    """A run that could not be deleted, and why; of other things that is an error."""

    id: str
    reason: str


class DeletedView(Answer):
    """Ids of what was deleted, and the runs that could not be.

    Attributes:
        restorable_until: until when `POST …/{id}/restore`, below the address of their list, brings
            them all back; null where one is gone for good.
    """

    deleted: list[str]
    kept: list[KeptRun]
    restorable_until: datetime | None


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
