"""Response models of `/events`: the data of each server-sent event; see `answers`."""

from collections.abc import Iterable, Mapping
from dataclasses import field
from functools import cache
from typing import Any, ClassVar

from app.answer import Answer, Count, extended
from app.api.run_views import ListedRunView
from app.events.event_records import (
    ClockEvent,
    DeletedRun,
    Evaluation,
    EvaluationEvent,
    RatesEvent,
    ReferenceEvent,
    RobotsEvent,
    ViewersEvent,
)
from app.feature import Feature, stage_members
from app.stage.stage_view import StageView, stage_view
from app.viewer.picture_feed import PieceEvent
from hexapods.shows.scene_view import SceneView


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
    piece: PieceEvent
    clock: ClockEvent
    viewers: ViewersEvent
    robots: RobotsEvent


@cache
def snapshot_view(features: tuple[type[Feature], ...]) -> type[SnapshotView]:
    """Return the record of a snapshot, whose stage has what it keeps for features."""
    return extended(SnapshotView, {"stage": stage_view(tuple(stage_members(features).items()))})


def event_bodies(features: Iterable[type[Feature]]) -> type[EventBodies]:
    """Return `EventBodies` with the events of features, and with what the stage keeps for them."""
    features = tuple(features)
    snapshot = snapshot_view(features)
    bodies: dict[str, Any] = {"snapshot": snapshot, "stage": snapshot.__annotations__["stage"]}
    bodies |= {name: body for feature in features for name, body in feature.event_bodies.items()}
    return extended(EventBodies, bodies)
