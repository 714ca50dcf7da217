"""Views of runs: their form in responses of the API, in events and in output of commands."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Annotated, Any, Literal, TypeVar

from pydantic import Field

from app.answer import Answer, Count
from app.storage.run import (
    PAUSED,
    RESUMABLE,
    AnyRun,
    DamagedRun,
    Run,
    State,
)
from app.storage.run_kind import added_kind, run_kinds
from app.storage.run_names import is_named
from hexapods.domain.disturbance_documents import DISTURBANCE_SCHEMA
from hexapods.domain.records import JsonForm, to_json
from hexapods.domain.settings import Value
from hexapods.runs.best_known import best_known_in_race_m
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import LaneConfig, PlanningModel, plans_with
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.results import RaceResult, TrainingResult

T = TypeVar("T")


def _time(time: datetime) -> str:
    return time.astimezone(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


Time = Annotated[
    datetime,
    JsonForm(datetime.fromisoformat, _time, {"format": "date-time", "type": "string"}),
]
"""A time, in JSON in UTC with milliseconds."""
Settings = Annotated[dict[str, Value], Field(description="settings of the agent, by name")]
NewPace = Annotated[float | Literal["max"] | None, Field(exclude_if=lambda pace: pace is None)]
NewSettings = Annotated[Settings, Field(exclude_if=lambda settings: not settings)]
_NewPresses = Annotated[
    list[Annotated[list[float], Field(min_length=2, max_length=2)]],
    Field(exclude_if=lambda presses: not presses),
]
_KindName = Annotated[str, JsonForm(str, str, lambda: {"enum": [*run_kinds()], "type": "string"})]
_NewDisturbance = Annotated[
    Annotated[Mapping[str, Any], JsonForm(dict, dict, DISTURBANCE_SCHEMA)] | None,
    Field(exclude_if=lambda disturbance: disturbance is None),
]


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
    """Progress: steps of a training or of all lanes of a race; other kinds count other things."""

    done: Count
    total: Count


class RunView(Answer):
    """Members common to all kinds of runs. Times are ISO 8601 in UTC.

    Attributes:
        can_resume: whether its state allows `resume`, which is still refused if a run that it needs
            was deleted, or if a stopped training's table has been used since.
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
    created_at: Time
    started_at: Time | None
    ended_at: Time | None


class Change(Answer):
    """A change of a running training, and the step after which it applies.

    Fields that did not change are left out.

    Attributes:
        presses: of those who watch: pairs of the steps done in the picture, and a value from -1 to
            1.
    """

    step: Count
    pace: NewPace = None
    settings: NewSettings = field(default_factory=dict)
    disturbance: _NewDisturbance = None
    presses: _NewPresses = field(default_factory=list)


class TrainingView(RunView):
    """A training."""

    kind: Literal["training"] = field()
    config: TrainingConfigView
    result: TrainingResult | None
    greedy_distance_m: float | None
    changes: list[Change]


class RaceView(RunView):
    """A race. `best_known_m` is null where it was not computed, as of worlds that change."""

    kind: Literal["race"] = field()
    config: RaceConfigView
    result: RaceResult | None
    best_known_m: float | None
    waiting_for: list[str]


class DamagedRunView(Answer):
    """A run that cannot be read, and why. It can be deleted."""

    id: str
    kind: _KindName | None
    name: str | None
    state: State | None
    created_at: Time | None
    damaged: str


def view_of(run: AnyRun, queue_position: int | None = None) -> RunView | DamagedRunView:
    """Return the view of a run; that of a damaged one has its readable fields and the reason.

    Args:
        run: the run in its present state.
        queue_position: position of a queued run, 1 for the next to start; None for others.
    """
    if isinstance(run, DamagedRun):
        return DamagedRunView(
            id=run.id,
            kind=run.kind,
            name=run.name,
            state=run.state,
            created_at=run.created_at,
            damaged=run.damaged,
        )
    view = RunView(
        id=run.id,
        name=run.name,
        is_named=is_named(run),
        state=run.state,
        can_resume=run.state in RESUMABLE | PAUSED,
        queue_position=queue_position,
        progress=ProgressView(done=run.done, total=run.total),
        eta_s=run.eta_s,
        error=run.error,
        tags=list(run.tags),
        notes=run.notes,
        created_at=run.created_at,
        started_at=run.started_at,
        ended_at=run.ended_at,
    )
    config: Any = run.config
    if (kind := added_kind(run.kind)) is not None:
        model: type[RunView] = kind.response_model()
        of_kind = {"kind": run.kind, "config": config, "result": run.result, **kind.view(run)}
        return model(**vars(view), **of_kind)
    if run.kind == "race":
        return RaceView(
            **vars(view),
            kind="race",
            config=_race_config(run, config),
            result=run.result,
            best_known_m=best_known_in_race_m(config),
            waiting_for=list(run.waiting_for),
        )
    return TrainingView(
        **vars(view),
        kind="training",
        config=_extended(TrainingConfigView, config, continue_from=run.continued_from),
        result=run.result,
        greedy_distance_m=run.greedy_distance_m,
        changes=[Change(**change) for change in run.changes],
    )


def run_view(run: AnyRun) -> dict[str, Any]:
    """Return a run in plain types, as commands print it."""
    return to_json(view_of(run))


def _race_config(run: Run, config: RaceConfig) -> RaceConfigView:
    lanes = tuple(
        _extended(
            LaneView,
            lane,
            plans_with=plans_with(lane, config),
            plans_with_by_default=lane.plans_with is None,
            training_id=training_id,
        )
        for lane, training_id in zip(config.lanes, run.lane_training_ids, strict=True)
    )
    return _extended(RaceConfigView, config, lanes=lanes)


def _extended(kind: type[T], config: TrainingConfig | RaceConfig | LaneConfig, **members: Any) -> T:
    """Return a config with further members, not validated again, which takes 0.3 ms."""
    extended = object.__new__(kind)
    vars(extended).update(vars(config) | members)
    return extended
