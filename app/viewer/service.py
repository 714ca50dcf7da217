"""Assembly of the viewer: viser, the drawing thread, the hub, and the routes of `/viewer/`."""

import asyncio
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Self

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute

from app.events.bus import EventBus
from app.jobs.stopping import Stopping
from app.stage.stage import Stage
from app.viewer.hub import Hub
from app.viewer.stage_loop import StageLoop
from app.viewer.viewer_page import sanitized_query, viewer_page
from hexapods.drawing.scene import StageScene
from hexapods.drawing.track import Position
from hexapods.drawing.viser_internals.server import in_process_viser
from hexapods.exports.recorded_stream import recorded_stream
from hexapods.runs.clocks import Clock
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.recording import LaneRecording
from hexapods.shows.race_show import Original


class ViewerService:
    """Runs viser, the drawing thread and the hub within `async with`, for the app's lifespan."""

    def __init__(
        self,
        stage: Stage,
        bus: EventBus,
        *,
        max_viewers: int,
        max_per_address: int,
        stopping: Stopping,
    ) -> None:
        """Create the hub; entering the context starts the rest.

        Args:
            stage: the stage to draw.
            bus: receives events with the scene and with the number of viewers.
            max_viewers: maximum number of viewers.
            max_per_address: maximum number of spectators per address.
            stopping: whether the server stops.
        """
        self._stage, self._bus = stage, bus
        self._scene: StageScene | None = None
        self._resources = ExitStack()
        self._stopping, self._recording_lock = stopping, threading.Lock()
        self.hub = Hub(
            follow_position=self._follow_position,
            max_viewers=max_viewers,
            max_per_address=max_per_address,
            on_viewers_changed=lambda count: bus.publish("viewers", {"count": count}),
        )

    async def __aenter__(self) -> Self:
        await asyncio.to_thread(self._open)
        self.hub.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.hub.stop()
        await asyncio.to_thread(self._resources.close)

    def recorded_stream(
        self,
        config: RaceConfig,
        lanes: Sequence[LaneRecording],
        name: str,
        clock: Clock,
        original: Original | None,
    ) -> bytes:
        """Return a race as a `.viser` file; only one is rendered at a time."""
        with self._recording_lock:
            return recorded_stream(config, lanes, name, clock, original, check=self._stopping.check)

    def _open(self) -> None:
        server = self._resources.enter_context(in_process_viser())
        self.hub.upstream = server.frames
        self._scene = StageScene(server)
        loop = StageLoop(self._stage, self._scene, self._bus, lambda: self.hub.counters.viewers > 0)
        self._resources.enter_context(loop)

    def _follow_position(self, view: str) -> Position | None:
        return None if self._scene is None else self._scene.follow_position(view)


def viewer_routes(hub: Hub) -> list[BaseRoute]:
    """Return the routes of `/viewer/`, which spectators may use.

    Raises:
        RuntimeError: The patch does not fit the client of the installed viser.
    """
    page = viewer_page()

    async def show(request: Request) -> Response:
        cleaned = sanitized_query(request.query_params)
        if cleaned is not None:
            return RedirectResponse(f"?{cleaned}")
        return page.response(request.headers)

    async def add_slash(request: Request) -> Response:
        # Relative, so that it also works behind a proxy that serves the app under a prefix.
        return RedirectResponse(f"viewer/?{request.url.query}".removesuffix("?"))

    return [
        Route("/viewer", add_slash, name="viewer-slash"),
        Route("/viewer/", show, name="viewer"),
        # viser's unpatched client connects to the path without the slash.
        WebSocketRoute("/viewer", hub.serve, name="viewer-socket-slash"),
        WebSocketRoute("/viewer/", hub.serve, name="viewer-socket"),
    ]
