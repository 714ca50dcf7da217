"""FastAPI dependencies of routes: the services, the client's role, a start request."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple, Protocol

from fastapi import Depends, Header, HTTPException, Request
from starlette.requests import ClientDisconnect

from app.api.auth import Role
from app.api.descriptions import VALID
from app.cache import BytesCache
from app.events.run_metrics import RunMetrics
from app.explanations.service import Explanations
from app.exports.file_renderer import FileRenderer
from app.jobs.jobs import Jobs
from app.jobs.stopping import Stopping
from app.limits.client_slots import ClientSlots
from app.limits.memory_budget import MemoryBudget
from app.limits.token_bucket import RateLimiter
from app.settings import Settings
from app.stage.stage import Stage
from app.storage.database.store import RunStore
from app.storage.idempotency import Idempotency, Import, Start
from app.storage.recordings import Recordings
from app.storage.run import MAX_KEY_LENGTH, Run
from app.what_if.estimate import Estimates
from app.what_if.what_if import WhatIf
from hexapods.domain.types import Cells
from hexapods.exports.export_format import EncodedReplay
from hexapods.runs.clocks import Clock
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.shows.race_show import Original

StreamEncoder = Callable[[RaceConfig, Sequence[LaneRecording], str, Clock, Original | None], bytes]
"""Encodes a race's lanes as a recorded stream for viser: with the race's name, under a clock, and
with the race from which it branched off, if any."""


class HubCounters(Protocol):
    """Counters of the viewer hub: connected viewers, frames sent and frames coalesced."""

    viewers: int
    frames_sent: int
    frames_merged: int


class FrameEncoder(Protocol):
    """Encodes the frames of runs: see `app.viewer.replay_frames`."""

    def plan(self, run_id: str, clock: Clock, ghost_id: str | None) -> dict[str, Any]:
        """Return what a page needs to play a run."""

    def scene(self, run_id: str, ghost_id: str | None) -> bytes:
        """Return the scene at the start of a run."""

    def moment(self, run_id: str, clock: Clock, time_s: float, ghost_id: str | None) -> bytes:
        """Return the frame at a time."""

    def segment(
        self, run_id: str, clock: Clock, level: int, number: int, ghost_id: str | None
    ) -> bytes:
        """Return the frames of a segment."""

    def posture(self, run_id: str, clock: Clock, time_s: float, lane: int, cells: Cells) -> bytes:
        """Return a ghost of a lane's robot in a state."""

    def encoded(self, run_id: str, clock: Clock) -> EncodedReplay:
        """Return all frames of a run, each encoded when it is asked for."""


@dataclass(frozen=True)
class Services:
    """Services that `create_app` builds and routes use.

    Attributes:
        settings: settings of the server.
        store, recordings, bus, jobs, stage, idempotency: the services of these names.
        agents: names of the agents that were registered at server start.
        audience: returns the counters of the viewer hub.
        ready: returns why runs cannot be started, in a sentence; None if they can.
        what_if: computes what-ifs.
        explanations: explains steps, and shows tables of any moment.
        estimates: estimates how long runs would take.
        recorded_stream: encodes a race's recording as a recorded stream for viser.
        replays: encodes frames of runs for pages that play them by themselves.
        renderer: renders large files, such as videos.
        stopping: ends what takes long in threads when the server stops.
        what_if_limiter: limits what-ifs of spectators, by their number and time.
        listeners: slots of event streams.
        exports: memory budget of exports that clients are still reading.
        analyses: gait analyses and timelines, which all pages that watch a run request at once.
    """

    settings: Settings
    store: RunStore
    recordings: Recordings
    bus: RunMetrics
    jobs: Jobs
    stage: Stage
    idempotency: Idempotency
    agents: tuple[str, ...]
    audience: Callable[[], HubCounters]
    ready: Callable[[], str | None]
    recorded_stream: StreamEncoder
    replays: FrameEncoder
    renderer: FileRenderer
    what_if: WhatIf
    explanations: Explanations
    estimates: Estimates
    stopping: Stopping
    what_if_limiter: RateLimiter
    listeners: ClientSlots["EventListener"]
    exports: MemoryBudget = field(default_factory=lambda: MemoryBudget(64 << 20, 64 << 20))
    analyses: BytesCache = field(default_factory=lambda: BytesCache(16 << 20))


class EventListener:
    """A client of the event stream; `close` ends its stream, if one is open."""

    def __init__(self) -> None:
        self.close: Callable[[], None] = lambda: None


class StartRequest(NamedTuple):
    """A start request as it was sent, with its idempotency key."""

    address: str
    body: bytes
    key: str | None
    """Idempotency key of the client, which makes a repeated request safe; None if none was sent."""

    def start(self, services: Services, start: Start) -> Run:
        """Return the run that `start` creates, or that an earlier request with this key created."""
        return services.idempotency.run(self.key, self._bytes, start)

    def import_runs(self, services: Services, create: Import) -> Sequence[Run]:
        """Return the runs that `create` creates, or that an earlier request with this key did."""
        return services.idempotency.runs(self.key, self._bytes, create)

    @property
    def _bytes(self) -> bytes:
        return self.address.encode() + b"\n" + self.body


def _services(request: Request) -> Services:
    services: Services = request.app.state.services
    return services


def _role(request: Request) -> Role:
    role: Role = request.state.role
    return role


async def _body(request: Request) -> bytes:
    try:
        return await request.body()
    except ClientDisconnect as error:
        raise HTTPException(400) from error


async def _start_request(
    request: Request,
    body: Annotated[bytes, Depends(_body)],
    idempotency_key: Annotated[
        str | None,
        Header(
            pattern=rf"^[\x21-\x7e]{{1,{MAX_KEY_LENGTH}}}$", description=VALID["idempotency-key"]
        ),
    ] = None,
) -> StartRequest:
    return StartRequest(f"{request.url.path}?{request.url.query}", body, idempotency_key)


ServicesDep = Annotated[Services, Depends(_services)]
StartRequestDep = Annotated[StartRequest, Depends(_start_request)]
RoleDep = Annotated[Role, Depends(_role)]
