"""A stage with viser, hub, event channel, roles and path, shared by many clients."""

import asyncio
from collections.abc import Mapping
from contextlib import ExitStack
from types import MappingProxyType
from typing import Self

from app.events.bus import Channel, EventBus
from app.events.event_records import ViewersEvent
from app.limits.client_slots import ClientSlots
from app.stage.roles import Roles
from app.stage.stage import Stage
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.viewer.hub import Hub
from app.viewer.session import Session
from app.viewer.stage_loop import StageLoop
from hexapods.domain.records import Record
from hexapods.drawing.scene import StageScene
from hexapods.drawing.track import Position
from hexapods.drawing.viser_internals.server import in_process_viser


class SharedStage:
    """A stage, viser that draws it, the hub that relays the picture, and the roles of clients.

    Several may be in one process, beside each other: they share the runs, their recordings and the
    bus, and the slots for viewers. Within `async with` viser, the drawing thread and the hub run.

    Attributes:
        path: path of its page, without a slash at its end, such as ""; that of the API begins with
            it.
        roles: roles of clients on it.
        session_path: path of the stage whose sessions operators have here.
        channel: channel of its events, and of those of the runs.
        stage: the stage: which run is shown, and its playback.
        hub: relays the picture to viewers.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        *,
        roles: Roles,
        viewer_slots: ClientSlots[Session],
        path: str = "",
        session_path: str | None = None,
        announces: bool = True,
        members: Mapping[str, Record] = MappingProxyType({}),
    ) -> None:
        """Create an empty stage and its hub; entering the context starts viser and the drawing.

        Args:
            store: store of the runs.
            recordings: recordings of the runs.
            bus: has the events of changed and deleted runs; receives the events of the stage.
            roles: see the class.
            viewer_slots: limit the viewers of all stages.
            path: see the class.
            session_path: path of the stage whose sessions operators have here; by default its own.
            announces: whether it shows earlier races by itself.
            members: records that features add to the state of the stage, by name.
        """
        self.path, self.roles = path, roles
        self.session_path = path if session_path is None else session_path
        self.channel = Channel(bus)
        self.stage = Stage(store, recordings, self.channel, announces=announces, members=members)
        self.hub = Hub(
            follow_position=self._follow_position,
            slots=viewer_slots,
            on_viewers_changed=lambda count: self.channel.publish(
                "viewers", ViewersEvent(count=count)
            ),
        )
        self._scene: StageScene | None = None
        self._resources = ExitStack()

    async def __aenter__(self) -> Self:
        await asyncio.to_thread(self._open)
        self.hub.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """End its event streams, close its viewers, and stop drawing. May be called twice."""
        self.channel.close()
        await self.hub.stop()
        await asyncio.to_thread(self._resources.close)

    def _open(self) -> None:
        server = self._resources.enter_context(in_process_viser())
        self.hub.upstream = server.frames
        self._scene = StageScene(server)
        loop = StageLoop(
            self.stage, self._scene, self.channel, lambda: self.hub.counters.viewers > 0
        )
        self._resources.enter_context(loop)

    def _follow_position(self, view: str) -> Position | None:
        return None if self._scene is None else self._scene.follow_position(view)
