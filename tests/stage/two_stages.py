"""Test set-up: a server with a second stage, at a path of its own."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from app.api.deps import Services
from app.server import create_app
from app.settings import Settings
from app.stage.playback import Replays
from app.stage.roles import Roles
from app.storage.database.opening import open_store
from app.viewer.replay_frames import ReplayFrames
from app.viewer.shared_stage import SharedStage
from tests.running_app import running

SECOND = "/r/second"
TOKENS = {"": "a-token-for-tests", SECOND: "another-token-for-tests"}
"""Token of each stage, by its path."""


@contextmanager
def two_stages(data: Path) -> Iterator[int]:
    """Serve both; yield the port."""
    settings = Settings(data=data, job_niceness=0, token=TOKENS[""])
    with open_store(settings) as store:
        app = create_app(settings, store)
        services: Services = app.state.services
        second = SharedStage(
            store,
            services.recordings,
            services.bus,
            frames=ReplayFrames(Replays(store, services.recordings)),
            roles=Roles(TOKENS[SECOND]),
            path=SECOND,
            members=services.features.stage_members(),
        )
        services.stages.append(second)
        with running(app) as port:
            yield port
