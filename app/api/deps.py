"""What routes are given: the services that `create_app` built, and who is asking."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from app.api.auth import Role
from app.runs.clocks import Clock
from app.runs.config import RaceConfig
from app.runs.recording import LaneRecording
from app.services.bus import EventBus
from app.services.jobs import Jobs
from app.services.recordings import Recordings
from app.services.stage import Stage
from app.services.store import RunStore

Film = Callable[[RaceConfig, Sequence[LaneRecording], str, Clock], bytes]
"""From a race, its name and a clock to a file that viser's client plays."""


@dataclass(frozen=True)
class Services:
    """All that the API stands on.

    Attributes:
        store, recordings, bus, jobs, stage: the services.
        agents: the names that were registered when the server started.
        viewers: counts who watches the stage now.
        ready: says what is not ready, or None.
        film: makes a race's recording playable.
    """

    store: RunStore
    recordings: Recordings
    bus: EventBus
    jobs: Jobs
    stage: Stage
    agents: tuple[str, ...]
    viewers: Callable[[], int]
    ready: Callable[[], str | None]
    film: Film


def _services(request: Request) -> Services:
    services: Services = request.app.state.services
    return services


def _role(request: Request) -> Role:
    role: Role = request.state.role
    return role


Given = Annotated[Services, Depends(_services)]
Who = Annotated[Role, Depends(_role)]
