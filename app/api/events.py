"""Server-sent events: a snapshot, then the changes."""

from collections.abc import AsyncIterator, Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import format_sse_event
from starlette.responses import Response, StreamingResponse

from app.api.contract import sends_events
from app.api.deps import (
    EventListener,
    IdentityDep,
    RoleDep,
    Services,
    ServicesDep,
    StageDep,
)
from app.api.descriptions import VALID
from app.api.event_answers import SnapshotView, snapshot_view
from app.api.policy import WATCH_STAGE, api_router, policy
from app.api.record_response import RecordResponse
from app.events.bus import Event
from app.events.event_records import ClockEvent, Evaluation
from app.feature import Feature
from app.limits.addresses import client_of
from app.limits.client_slots import NoFreeSlot, Refusal
from app.storage.errors import Busy
from app.viewer.shared_stage import SharedStage
from hexapods.domain.records import to_json_bytes
from hexapods.version import __version__

NEWEST_RUNS = 50
RETRY_MS = 1000
RETRY_AFTER_S = 10
_IDLE_S = 10.0
"""Time without events after which a `clock` event is sent [s]."""
_REFUSALS: dict[Refusal, str] = {
    "full": "The event stream has its maximum number of clients; try again later.",
    "address full": "The event stream has its maximum number of clients from this address; "
    "try again later.",
}


class EventStream(StreamingResponse):
    """Response with server-sent events, which are encoded already.

    FastAPI's own would encode each event for each client, and pass it through two queues.
    """

    media_type = "text/event-stream"

    def __init__(self, events: AsyncIterator[bytes], status_code: int = 200) -> None:
        """Send events as they come."""
        # The second is for nginx.
        headers = {"Cache-Control": "no-cache", "X-Accel-Buffering": "no"}
        super().__init__(events, status_code, headers)


EVENT_STREAM: dict[str, Any] = {
    "response_class": EventStream,
    "openapi_extra": sends_events("EventBodies"),
}
"""Keyword arguments that declare a route which returns an `EventStream` of `stream_events`."""
PictureQuery = Annotated[bool, Query(description=VALID["picture"])]

router = api_router(prefix="/events", tags=["events"])


def _existing_run_id(
    services: ServicesDep,
    run_id: Annotated[str | None, Query(max_length=64, description=VALID["run_id"])] = None,
) -> str | None:
    """Return the id of the run to follow; raise `NotFound` before the stream's status is sent."""
    return None if run_id is None else services.store.find(run_id).id


async def client_slot(
    request: Request,
    services: ServicesDep,
    role: RoleDep,
    identity: IdentityDep,
) -> AsyncIterator[EventListener]:
    """Occupy a client slot until the stream ends, evicting another client if the slots allow it.

    Raises:
        Busy: if no slot is free.
    """
    listener = EventListener(role, identity)
    try:
        evicted = services.listeners.take(listener, client_of(request.scope), role == "operator")
    except NoFreeSlot as error:
        raise Busy(_REFUSALS[error.reason], RETRY_AFTER_S) from error
    if evicted is not None:
        evicted.close()
    try:
        yield listener
    finally:
        services.listeners.leave(listener)


@router.get(
    "",
    summary="Stream the events of all runs and of the stage",
    responses={404: {}},
    **EVENT_STREAM,
)
@policy(access=WATCH_STAGE)
async def get_events(
    *,
    services: ServicesDep,
    shared: StageDep,
    run_id: Annotated[str | None, Depends(_existing_run_id)],
    listener: Annotated[EventListener, Depends(client_slot)],
    picture: PictureQuery = False,
    last_event_id: Annotated[str | None, Header()] = None,
) -> Response:
    """Stream a `snapshot` event, then changes; with `run_id` only those of this run.

    With `picture` the frames of the run on stage come, too, as `piece` events, and the client
    counts as a viewer.
    """
    return EventStream(
        stream_events(services, shared, run_id, listener, last_event_id, has_picture=picture)
    )


def snapshot_routes(features: Sequence[type[Feature]]) -> APIRouter:
    """Return the route of a snapshot, whose stage has what it keeps for features."""
    snapshots = api_router(prefix="/events", tags=["events"])

    @snapshots.get(
        "/snapshot",
        response_model=snapshot_view(tuple(features)),
        summary="Get what the event stream begins with",
    )
    @policy(access=WATCH_STAGE)
    def get_snapshot(
        services: ServicesDep, shared: StageDep, role: RoleDep, identity: IdentityDep
    ) -> Response:
        """Return the data of a `snapshot` event, for clients that streams do not reach."""
        snapshot, _ = _snapshot(services, shared, EventListener(role, identity), None)
        return RecordResponse(snapshot)

    return snapshots


async def stream_events(
    services: Services,
    shared: SharedStage,
    run_id: str | None,
    listener: EventListener,
    last_event_id: str | None,
    *,
    has_picture: bool,
) -> AsyncIterator[bytes]:
    """Yield the events of a stage for one client, who sees no run that a feature hides.

    Args:
        services: of the server.
        shared: the stage.
        run_id: of the run that the client follows; None for all.
        listener: the client, in its slot.
        last_event_id: the header of this name.
        has_picture: whether it gets the frames, and counts as a viewer.
    """
    # Subscribe before reading, so that each change is in the snapshot or follows it.
    run_ids = None if run_id is None else {run_id}
    subscription = shared.channel.subscribe(
        run_ids, _event_id(last_event_id), has_picture=has_picture
    )
    listener.close = subscription.close
    if has_picture:
        shared.count_viewer(1)
    try:
        id_before_read = services.bus.last_id
        # In a thread: the database and the stage's lock would block the event loop.
        text, listed_ids = await run_in_threadpool(
            _encoded_snapshot, services, shared, listener, run_id
        )
        # All events after this id follow: a client that reconnects with it misses none.
        since = str(subscription.since)
        yield format_sse_event(event="snapshot", data_str=text, id=since, retry=RETRY_MS)
        async for events in subscription.batches(_IDLE_S):
            wires = [
                event.wire
                for event in events
                if not _is_outdated(event, id_before_read, listed_ids)
                and not _is_hidden(services, listener, event.run_id)
            ]
            if not events:
                clock = to_json_bytes(ClockEvent(sent_s=shared.stage.now())).decode()
                wires = [format_sse_event(event="clock", data_str=clock)]
            if wires:
                yield b"".join(wires)
    finally:
        # A client may disconnect before the first event.
        subscription.close()
        if has_picture:
            shared.count_viewer(-1)


def _is_outdated(event: Event, id_before_read: int, listed_ids: set[str]) -> bool:
    """Whether a run was deleted before the snapshot, and imported again."""
    is_before = event.event == "run-deleted" and event.id <= id_before_read
    return is_before and event.run_id in listed_ids


def _is_hidden(services: Services, listener: EventListener, run_id: str | None) -> bool:
    return listener.role != "operator" and services.features.is_hidden(run_id, listener.identity)


def _encoded_snapshot(
    services: Services, shared: SharedStage, listener: EventListener, run_id: str | None
) -> tuple[str, set[str]]:
    """Return the snapshot as JSON, and the ids of the runs in it."""
    snapshot, listed_ids = _snapshot(services, shared, listener, run_id)
    return to_json_bytes(snapshot).decode(), listed_ids


def _snapshot(
    services: Services, shared: SharedStage, listener: EventListener, run_id: str | None
) -> tuple[SnapshotView, set[str]]:
    """Return the snapshot, and the ids of the runs in it."""
    store, role, identity = services.store, listener.role, listener.identity
    condition = None if role == "operator" else services.features.visible_runs(identity)
    if run_id is None:
        runs = store.list(limit=NEWEST_RUNS, condition=condition).items
    else:
        runs = [store.find(run_id)]
    rows = [] if run_id is None else store.curves.get(run_id)
    snapshot = snapshot_view(services.features.classes)(
        version=__version__,
        role=role if identity is None else identity.page_role,
        viewers=shared.viewers,
        robots_version=store.robots.version,
        runs=[services.jobs.view(run) for run in runs],
        stage=shared.stage.state(),
        scene=shared.stage.scene(),
        evaluations=[Evaluation(**row) for row in rows],
    )
    return snapshot, {run.id for run in runs}


def _event_id(header: str | None) -> int | None:
    """Parse a Last-Event-ID header; None if it is not a whole number, as all our ids are."""
    if header is None or not header.isascii() or not header.isdigit():
        return None
    return int(header[:18])
