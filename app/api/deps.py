"""Dependencies of routes: the services that `create_app` built, and the client's role."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Annotated, NamedTuple, Protocol

from fastapi import Depends, Header, HTTPException, Request
from starlette.requests import ClientDisconnect

from app.api.auth import Role
from app.api.descriptions import VALID
from app.events.run_metrics import RunMetrics
from app.jobs.jobs import Jobs
from app.limits.client_slots import ClientSlots
from app.limits.memory_budget import MemoryBudget
from app.runs.clocks import Clock
from app.runs.config import RaceConfig
from app.runs.recording import LaneRecording
from app.stage.stage import Stage
from app.storage.database.store import RunStore
from app.storage.idempotency import Idempotency, Start
from app.storage.recordings import Recordings
from app.storage.run import Run
from app.what_if.what_if import WhatIf

Film = Callable[[RaceConfig, Sequence[LaneRecording], str, Clock], bytes]
"""From a race, its name and a clock to a file that viser's client plays."""


class Audience(Protocol):
    """Those who watch the stage, as the hub counts them."""

    viewers: int
    frames_sent: int
    frames_merged: int


@dataclass(frozen=True)
class Services:
    """All that the API stands on.

    Attributes:
        store, recordings, bus, jobs, stage, idempotency: the services.
        agents: the names that were registered when the server started.
        audience: counts who watches the stage, and what they were sent.
        ready: says what is not ready, or None.
        what_if: tries settings out.
        film: makes a race's recording playable.
        listeners: places for streams of events.
        exports: counts what exports hold in memory until they are read.
    """

    store: RunStore
    recordings: Recordings
    bus: RunMetrics
    jobs: Jobs
    stage: Stage
    idempotency: Idempotency
    agents: tuple[str, ...]
    audience: Callable[[], Audience]
    ready: Callable[[], str | None]
    film: Film
    what_if: WhatIf
    listeners: ClientSlots["Listener"]
    exports: MemoryBudget = field(default_factory=lambda: MemoryBudget(64 << 20, 64 << 20))


class Listener:
    """Someone who follows the events; `close` ends the stream, once there is one."""

    def __init__(self) -> None:
        self.close: Callable[[], None] = lambda: None


class StartRequest(NamedTuple):
    """A request to start something, as it was sent."""

    address: str
    body: bytes
    key: str | None
    """Chosen by the client, so that it can ask again without starting twice."""

    def start(self, services: Services, start: Start) -> Run:
        """The run that `start` creates, or created when this was asked for before."""
        return services.idempotency.run(self.key, self.address.encode() + b"\n" + self.body, start)


def _services(request: Request) -> Services:
    services: Services = request.app.state.services
    return services


def _role(request: Request) -> Role:
    role: Role = request.state.role
    return role


async def _asked(
    request: Request,
    idempotency_key: Annotated[
        str | None,
        Header(pattern=r"^[\x21-\x7e]{1,200}$", description=VALID["idempotency-key"]),
    ] = None,
) -> StartRequest:
    try:
        body = await request.body()
    except ClientDisconnect as error:
        raise HTTPException(400) from error
    return StartRequest(f"{request.url.path}?{request.url.query}", body, idempotency_key)


ServicesDep = Annotated[Services, Depends(_services)]
StartRequestDep = Annotated[StartRequest, Depends(_asked)]
Who = Annotated[Role, Depends(_role)]
