"""Server-sent events: how everything is, and then what changes."""

from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse, ServerSentEvent

from app import __version__
from app.api.deps import Listener, Services, ServicesDep, Who
from app.api.descriptions import VALID
from app.limits.addresses import client_of
from app.limits.client_slots import NoFreeSlot, Refusal
from app.storage.errors import Busy
from app.storage.json_text import json_text

NEWEST_RUNS = 50
RETRY_MS = 1000
RETRY_AFTER_S = 10
_REFUSALS: dict[Refusal, str] = {
    "full": "As many follow the events as can; there is room when someone leaves.",
    "address full": "As many follow the events from this address as may from one.",
}

router = APIRouter(prefix="/events", tags=["events"])


def _known_run(
    services: ServicesDep,
    run_id: Annotated[str | None, Query(max_length=64, description=VALID["run_id"])] = None,
) -> str | None:
    """The run to listen to, checked while the answer may still be 404."""
    return None if run_id is None else services.store.find(run_id).id


async def _place(request: Request, services: ServicesDep, role: Who) -> AsyncIterator[Listener]:
    """A place among those who listen, until the stream ends.

    Raises:
        Busy: if there is none.
    """
    listener = Listener()
    try:
        loser = services.listeners.take(listener, client_of(request.scope), role == "operator")
    except NoFreeSlot as error:
        raise Busy(_REFUSALS[error.reason], RETRY_AFTER_S) from error
    if loser is not None:
        loser.close()
    try:
        yield listener
    finally:
        services.listeners.leave(listener)


@router.get("", summary="What happens, as it happens", response_class=EventSourceResponse)
async def get_events(
    services: ServicesDep,
    role: Who,
    run_id: Annotated[str | None, Depends(_known_run)],
    listener: Annotated[Listener, Depends(_place)],
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterator[ServerSentEvent]:
    """A `snapshot` first, then changes; with `run_id` those of one run only."""
    # Subscribed before anything is read: each change is in the snapshot, or comes after it.
    run_ids = None if run_id is None else {run_id}
    subscription = services.bus.subscribe(run_ids, _event_id(last_event_id))
    listener.close = subscription.close
    try:
        known_id = services.bus.last_id
        # In a thread: the event loop must not wait for the database or the stage's lock.
        text, listed = await run_in_threadpool(_snapshot, services, role, run_id)
        # The id is one after which everything comes: a client that goes now misses nothing.
        since = str(subscription.since)
        yield ServerSentEvent(event="snapshot", id=since, raw_data=text, retry=RETRY_MS)
        async for event in subscription:
            if event.event == "run-deleted" and event.id <= known_id and event.run_id in listed:
                continue  # deleted before the snapshot, and imported again
            yield ServerSentEvent(event=event.event, id=str(event.id), raw_data=event.data)
    finally:
        # A client may leave before the first event.
        services.bus.remove(subscription)


def _snapshot(services: Services, role: str, run_id: str | None) -> tuple[str, set[str]]:
    """The snapshot as JSON, and the ids of the runs in it."""
    store = services.store
    runs = store.list(limit=NEWEST_RUNS).items if run_id is None else [store.find(run_id)]
    shown: dict[str, Any] = {
        "version": __version__,
        "role": role,
        "viewers": services.audience().viewers,
        "runs": [services.jobs.view(run) for run in runs],
        "stage": services.stage.state(),
        "scene": services.stage.scene(),
    }
    if run_id is not None:
        shown["evaluations"] = store.evaluations(run_id)
    return json_text(shown), {run.id for run in runs}


def _event_id(header: str | None) -> int | None:
    """Ours are whole numbers; whatever else is sent counts as none."""
    if header is None or not header.isascii() or not header.isdigit():
        return None
    return int(header[:18])
