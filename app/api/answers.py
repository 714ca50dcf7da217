"""Response models: the schemas of JSON responses, for the OpenAPI document and the tests.

Those of a run of any kind, of what runs recorded and of `/options` are in `run_views`,
`recorded_answers` and `option_answers`.

Services build responses from plain types, which are sent unvalidated; these models are used at run
time only to describe them. Tests validate real responses against the models.
"""

from dataclasses import dataclass, field
from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from app.answer import Answer, Count
from app.stage.state_machine import Origin, Phase
from app.storage.run import State
from hexapods.domain.disturbance_documents import AnyDisturbance
from hexapods.domain.settings import Value
from hexapods.runs.clocks import Clock
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import LaneConfig, PlanningModel
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.results import RaceResult, TrainingResult

Settings = Annotated[dict[str, Value], Field(description="settings of the agent, by name")]


@dataclass(frozen=True, kw_only=True)
class TrainingConfigView(TrainingConfig):
    """Config of a training."""

    continue_from: str | None


@dataclass(frozen=True, kw_only=True)
class LaneView(LaneConfig):
    """A lane of a race, with the id of the training whose Q-table it uses.

    The settings of an agent with training are those of the training.

    Attributes:
        plans_with: model that it plans with; null if it does not search.
        plans_with_by_default: whether `plans_with` was left out.
    """

    plans_with: PlanningModel | None
    plans_with_by_default: bool
    training_id: str | None


@dataclass(frozen=True, kw_only=True)
class RaceConfigView(RaceConfig):
    """Config of a race."""

    lanes: tuple[LaneView, ...]


class ProgressView(Answer):
    """Progress: steps of a training or of all lanes of a race, or what else a kind counts."""

    done: Count
    total: Count


class RunView(Answer):
    """Members common to all kinds of runs. Times are ISO 8601 in UTC.

    Attributes:
        can_resume: whether its state allows it; what it needs may have been deleted, or a stopped
            training's table used since.
    """

    id: str
    name: str
    is_named: Annotated[
        bool, Field(description="whether somebody named it; else its name tells its config")
    ]
    state: State
    can_resume: bool
    queue_position: Annotated[int, Field(ge=1)] | None
    progress: ProgressView
    eta_s: float | None
    error: str | None
    tags: list[str]
    notes: str
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None


class Change(Answer):
    """A change while it ran, and the step after which it applies; what stayed is left out."""

    step: Count
    pace: float | Literal["max"] | None = None
    settings: Settings = field(default_factory=dict)
    disturbance: AnyDisturbance | None = None


class TrainingView(RunView):
    """A training."""

    kind: Literal["training"]
    config: TrainingConfigView
    result: TrainingResult | None
    greedy_distance_m: float | None
    changes: list[Change]


class RaceView(RunView):
    """A race. `best_known_m` is null where it was not computed, or something happens in between."""

    kind: Literal["race"]
    config: RaceConfigView
    result: RaceResult | None
    best_known_m: float | None
    waiting_for: list[str]


class Page(Answer):
    """Page of a list, with cursor pagination.

    Attributes:
        next_cursor: Cursor of the next page; null on the last page.
    """

    next_cursor: str | None


class TrainingPage(Page):
    """Page of trainings."""

    items: list[TrainingView]


class RacePage(Page):
    """Page of races."""

    items: list[RaceView]


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
