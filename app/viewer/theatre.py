"""The stage, viser and the hub, put together: built with the app, running with its lifespan."""

import asyncio
import contextlib
from collections.abc import Collection, Iterator, Sequence
from types import TracebackType
from typing import Self

import rich
import viser

from app.runs.config import RaceConfig
from app.runs.recording import LaneRecording
from app.services.bus import EventBus
from app.services.stage import Stage
from app.viewer.follow import Position
from app.viewer.hub import Hub
from app.viewer.scene import StageScene
from app.viewer.stage_loop import StageLoop


class Theatre:
    """`async with theatre:` lets the show go on; all of viser stays on loopback."""

    def __init__(self, stage: Stage, bus: EventBus, allowed_origins: Collection[str] = ()) -> None:
        """Start nothing yet.

        Args:
            stage: says what is shown.
            bus: is told what is shown, and how many watch.
            allowed_origins: see `Hub`.
        """
        self._stage, self._bus = stage, bus
        self._scene: StageScene | None = None
        self._viser: viser.ViserServer | None = None
        self._loop: StageLoop | None = None
        self.hub = Hub(
            0,  # until viser has one
            follow_position=self._follow_position,
            allowed_origins=allowed_origins,
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
        await asyncio.to_thread(self._close)

    def film(self, config: RaceConfig, lanes: Sequence[LaneRecording]) -> bytes:
        """A race as a file that viser's client plays."""
        raise NotImplementedError

    def _open(self) -> None:
        # viser's own default is every interface, without a question who asks.
        with _quiet():
            self._viser = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        self.hub.port = self._viser.get_port()
        self._scene = StageScene(self._viser)
        self._loop = StageLoop(self._stage, self._scene, self._bus)
        self._loop.start()

    def _close(self) -> None:
        if self._loop is not None:
            self._loop.stop()
        if self._viser is not None:
            with _quiet():
                self._viser.stop()

    def _follow_position(self, view: str) -> Position | None:
        return None if self._scene is None else self._scene.follow_position(view)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep to itself the box with its own address that viser prints: it is for nobody."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
