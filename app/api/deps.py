"""FastAPI dependencies of routes: the services, the stage, the client's role, a start request."""

import hashlib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, NamedTuple, TypeVar

from fastapi import Depends, Header, HTTPException, Request
from starlette.requests import ClientDisconnect

from app.active_features import Features
from app.api.descriptions import VALID
from app.api.identity import Identity
from app.api.stage_paths import stage_of
from app.cache import BytesCache
from app.events.event_records import RobotsEvent
from app.events.run_metrics import RunMetrics
from app.jobs.jobs import Jobs
from app.jobs.stopping import Stopping
from app.limits.client_slots import ClientSlots
from app.limits.memory_budget import MemoryBudget
from app.settings import Settings
from app.stage.roles import Role
from app.storage.database.store import RunStore
from app.storage.idempotency import Create, Idempotency
from app.storage.recordings import Recordings
from app.storage.run import MAX_KEY_LENGTH, Run
from app.viewer.replay_frames import ReplayFrames
from app.viewer.shared_stage import SharedStage

T = TypeVar("T")


class PageFiles(NamedTuple):
    """Folders from which the page's files are served.

    Attributes:
        folder: folder of the dashboard, with its `index.html` and a folder `features`.
        without: names of the features whose folders are left out.
        added: folders of the pages of features of other packages, by the feature's name.
    """

    folder: Path
    without: Collection[str] = ()
    added: Mapping[str, Path] = MappingProxyType({})


@dataclass(frozen=True)
class Services:
    """Services that `create_app` builds and routes use.

    Attributes:
        settings: settings of the server.
        store, recordings, bus, jobs, idempotency: the services of these names.
        stages: all stages, the first of which has the path "".
        agents: names of the agents that were registered at server start.
        replays: encodes runs for pages that play them by themselves.
        stopping: flag that ends long work in threads when the server stops.
        listeners: slots of event streams, of all stages.
        new_stage: makes a further stage with a path, which uses the sessions of the first.
        features: features of the server.
        page_files: folders of the files of the page.
        downloads: memory budget of files that clients are still reading.
        shared_answers: encoded views of runs, which all pages that watch one request at once.
    """

    settings: Settings
    store: RunStore
    recordings: Recordings
    bus: RunMetrics
    jobs: Jobs
    stages: list[SharedStage]
    idempotency: Idempotency
    agents: tuple[str, ...]
    replays: ReplayFrames
    stopping: Stopping
    listeners: ClientSlots["EventListener"]
    new_stage: Callable[[str], SharedStage]
    features: Features
    page_files: PageFiles
    downloads: MemoryBudget = field(default_factory=lambda: MemoryBudget(64 << 20, 64 << 20))
    shared_answers: BytesCache = field(default_factory=lambda: BytesCache(16 << 20))
    _provided: dict[type, Any] = field(default_factory=dict)

    def provide(self, service: T) -> T:
        """Offer a service of a feature to its routes, which get it by its class; return it."""
        self._provided[type(service)] = service
        return service

    def of(self, kind: type[T]) -> T:
        """Return the service of this class that a feature has provided."""
        service: T = self._provided[kind]
        return service

    def publish_robots(self) -> None:
        """Send an event to all pages, as stored robots have changed."""
        robots = self.store.robots
        event = RobotsEvent(count=len(robots.stored()), version=robots.version)
        self.bus.publish("robots", event)


class EventListener:
    """A client of the event stream, with its role; `close` ends its stream, if one is open."""

    def __init__(self, role: Role, identity: Identity | None = None) -> None:
        self.role, self.identity = role, identity
        self.close: Callable[[], None] = lambda: None


class StartRequest(NamedTuple):
    """A start request as it was sent, with its idempotency key."""

    address: str
    body: bytes
    key: str | None
    """Idempotency key of the client, which makes a repeated request safe; None if none was sent."""

    def with_hashed_key(self) -> "StartRequest":
        """Return the request with the SHA-256 of its key in place of the key, which is a secret."""
        if self.key is None:
            return self
        return self._replace(key=hashlib.sha256(self.key.encode()).hexdigest())

    def runs(self, services: Services, create: Create) -> Sequence[Run]:
        """Return the runs that `create` creates, or that an earlier request with this key did."""
        request = self.address.encode() + b"\n" + self.body
        return services.idempotency.runs(self.key, request, create)


# These are coroutines, as FastAPI would call functions in another thread, which takes longer.
async def _services(request: Request) -> Services:
    services: Services = request.app.state.services
    return services


async def _stage(request: Request) -> SharedStage:
    return stage_of(request.scope)


async def _role(request: Request) -> Role:
    role: Role = request.state.role
    return role


async def _identity(request: Request) -> Identity | None:
    identity: Identity | None = request.state.identity
    return identity


async def _body(request: Request) -> bytes:
    try:
        return await request.body()
    except ClientDisconnect as error:
        raise HTTPException(400) from error


IdempotencyKeyHeader = Annotated[
    str | None,
    Header(
        pattern=rf"^[\x21-\x7e]{{1,{MAX_KEY_LENGTH}}}$",
        description=VALID["idempotency-key"],
    ),
]


async def _start_request(
    request: Request,
    body: Annotated[bytes, Depends(_body)],
    idempotency_key: IdempotencyKeyHeader = None,
) -> StartRequest:
    return StartRequest(f"{request.url.path}?{request.url.query}", body, idempotency_key)


ServicesDep = Annotated[Services, Depends(_services)]
StageDep = Annotated[SharedStage, Depends(_stage)]
"""The stage that the request's path is about."""
StartRequestDep = Annotated[StartRequest, Depends(_start_request)]
BodyDep = Annotated[bytes, Depends(_body)]
"""The body of a request, as it was sent."""
IdentityDep = Annotated[Identity | None, Depends(_identity)]
"""The client as a feature knows it; None for operators, and for other spectators."""
RoleDep = Annotated[Role, Depends(_role)]
