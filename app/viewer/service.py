"""The stage, viser and the hub, put together: built with the app, running with its lifespan."""

import asyncio
import threading
from collections.abc import Callable, Collection, Sequence
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.types import Scope

from app.events.bus import EventBus
from app.runs.clocks import Clock
from app.runs.config import RaceConfig
from app.runs.recording import LaneRecording
from app.stage.stage import Stage
from app.viewer.client_page import ViewerPage, clean_query
from app.viewer.follow import Position
from app.viewer.hub import Hub
from app.viewer.in_process import in_process_viser
from app.viewer.recorded_stream import recorded_stream
from app.viewer.scene import StageScene
from app.viewer.stage_loop import StageLoop


class ViewerService:
    """`async with theatre:` lets the show go on; viser listens nowhere."""

    def __init__(
        self,
        stage: Stage,
        bus: EventBus,
        allowed_origins: Collection[str] = (),
        *,
        max_viewers: int = 300,
        max_per_address: int | None = None,
        address_of: Callable[[Scope], str] | None = None,
    ) -> None:
        """Start nothing yet.

        Args:
            stage: says what is shown.
            bus: is told what is shown, and how many watch.
            allowed_origins: see `Hub`, as for all below.
            max_viewers: at once.
            max_per_address: of them, of one address.
            address_of: a connection.
        """
        self._stage, self._bus = stage, bus
        self._scene: StageScene | None = None
        self._running = ExitStack()
        self._filming = threading.Lock()
        self.hub = Hub(
            follow_position=self._follow_position,
            allowed_origins=allowed_origins,
            max_viewers=max_viewers,
            max_per_address=max_per_address,
            address_of=address_of,
            on_viewers_changed=lambda count: bus.publish("viewers", {"count": count}),
        )

    async def __aenter__(self) -> Self:
        await asyncio.to_thread(self._open)
        self.hub.start()
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.hub.stop()
        await asyncio.to_thread(self._running.close)

    def recorded_stream(
        self, config: RaceConfig, lanes: Sequence[LaneRecording], name: str, clock: Clock
    ) -> bytes:
        """A race as a file that viser's client plays; one is made at a time."""
        with self._filming:
            return recorded_stream(config, lanes, name, clock)

    def _open(self) -> None:
        server = self._running.enter_context(in_process_viser())
        self.hub.upstream = server.frames
        self._scene = StageScene(server)
        self._running.enter_context(StageLoop(self._stage, self._scene, self._bus))

    def _follow_position(self, view: str) -> Position | None:
        return None if self._scene is None else self._scene.follow_position(view)


def viewer_routes(hub: Hub) -> list[BaseRoute]:
    """Routes for `/viewer/`, all of them for whoever may watch. Reads viser's client once.

    Raises:
        RuntimeError: This version of viser has a client that the skin does not fit.
    """
    page = ViewerPage()

    async def show(request: Request) -> Response:
        cleaned = clean_query(request.query_params)
        if cleaned is not None:
            return RedirectResponse(f"?{cleaned}")
        return page.response(request.headers)

    async def add_slash(request: Request) -> Response:
        # Relative, so that it holds behind a proxy that serves the app under a prefix.
        return RedirectResponse(f"viewer/?{request.url.query}".removesuffix("?"))

    return [
        Route("/viewer", add_slash, name="viewer-slash"),
        Route("/viewer/", show, name="viewer"),
        # viser's client leaves the slash out where the skin does not tell it better.
        WebSocketRoute("/viewer", hub.serve, name="viewer-socket-slash"),
        WebSocketRoute("/viewer/", hub.serve, name="viewer-socket"),
    ]
