"""Response models of `/events`: the data of each server-sent event; see `answers`."""

from collections.abc import Iterable, Mapping
from dataclasses import field
from functools import cache
from typing import Any, ClassVar, Literal

from app.answer import Answer, Count, extended
from app.api.answers import StageView
from app.api.recorded_answers import Evaluation
from app.api.run_views import ListedRunView
from app.events.run_view import NewPace, NewSettings
from app.feature import Feature
from hexapods.runs.clocks import Clock


class SceneLane(Answer):
    """A lane at the moment that the stage shows; `halted` if its run ended before it was done.

    Attributes:
        step: the step that it takes, counted from 1; at its end the last.
        steps_made: steps that have ended.
        done: whether it has used all its steps, or failed.
    """

    lane: Count
    agent: str
    name: str
    color: str
    distance_m: float
    step: Count
    steps: Count
    steps_made: Count
    thinking: bool
    futures: Count
    futures_total: Count
    done: bool
    halted: bool
    crossed: bool
    rank: int
    marching: bool
    failure: str | None


class GhostView(Answer):
    """A robot in the state after an earlier evaluation."""

    step: Count
    distance_m: float


class GhostLane(GhostView):
    """A robot of another run that is shown as a ghost."""

    lane: Count
    name: str


class NextAction(Answer):
    """An action: the leg pair, and the cell to which it moves."""

    pair: Count
    cell: Count


class SceneActionValues(Answer):
    """Action values of a learner in its present state.

    Attributes:
        values_m: by leg pair and cell; null where the foot already stands.
        current: the cell of each leg pair.
    """

    agent: str
    lane: Count
    pairs: list[list[int]]
    cell_names: list[str]
    cells_m: list[tuple[float, float]]
    values_m: list[list[float | None]]
    visits: list[list[float | None]]
    current: list[int]
    next: NextAction | None
    low: float
    high: float


class SceneView(Answer):
    """The moment of a run that the stage shows, without poses.

    Attributes:
        computed_s: time of the run up to which it is computed.
    """

    run_id: str | None
    kind: Literal["idle", "training", "race"]
    phase: str
    time_s: float
    duration_s: float | None
    computed_s: float
    time_out_s: float | None
    ended: bool
    shown_speed: float
    playing: bool
    clock: Clock
    replay: bool
    label: str
    lanes: list[SceneLane]
    ghosts: list[GhostView]
    ghost_lanes: list[GhostLane]
    action_values: SceneActionValues | None


class SnapshotView(Answer):
    """State of the server when the stream begins: the newest runs, or the one that is followed.

    Attributes:
        role: `operator`, `spectator`, or another one of clients whom a feature knows.
        robots_version: of the list of stored robots; a greater one than in the options that a
            client has means that they have changed since.
    """

    version: str
    role: str
    viewers: Count
    robots_version: Count
    runs: list[ListedRunView]
    stage: StageView
    scene: SceneView
    evaluations: list[Evaluation] = field(default_factory=list)


class DeletedRun(Answer):
    """A run that was deleted."""

    id: str


class EvaluationEvent(Evaluation):
    """An evaluation of a training that runs."""

    run_id: str


class ReferenceEvent(Answer):
    """Distances [m] of greedy and of the best known walk on the robot of a training."""

    run_id: str
    greedy_distance_m: float
    best_known_m: float | None


class RatesEvent(Answer):
    """A change of a training's pace and live settings; what stayed is left out."""

    run_id: str
    step: Count
    pace: NewPace = None
    settings: NewSettings = field(default_factory=dict)


class ViewersEvent(Answer):
    """The number of pages that watch the stage."""

    count: Count


class RobotsEvent(Answer):
    """Stored robots have changed; `GET /options` has them. `count` leaves hidden ones out."""

    count: Count
    version: Count


class EventBodies(Answer):
    """Data of each server-sent event of the core, by the event's name."""

    json_names: ClassVar[Mapping[str, str]] = {"run_deleted": "run-deleted"}

    snapshot: SnapshotView
    run: ListedRunView
    run_deleted: DeletedRun
    evaluation: EvaluationEvent
    reference: ReferenceEvent
    rates: RatesEvent
    stage: StageView
    scene: SceneView
    viewers: ViewersEvent
    robots: RobotsEvent


@cache
def stage_view(features: tuple[type[Feature], ...]) -> type[StageView]:
    """Return the record of the stage's state, with what it keeps for features."""
    kinds = {name: kind for feature in features for name, kind in feature.stage_members.items()}
    return extended(StageView, kinds)


def event_bodies(features: Iterable[type[Feature]]) -> type[EventBodies]:
    """Return `EventBodies` with the events of features, and with what the stage keeps for them."""
    features = tuple(features)
    stage = stage_view(features)
    bodies: dict[str, Any] = {"snapshot": extended(SnapshotView, {"stage": stage}), "stage": stage}
    bodies |= {name: body for feature in features for name, body in feature.event_bodies.items()}
    return extended(EventBodies, bodies)
