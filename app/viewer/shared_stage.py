"""A stage with event channel, picture, viewers, roles and path, shared by many clients."""

import asyncio
from collections.abc import Mapping
from contextlib import ExitStack
from types import MappingProxyType
from typing import Self

from app.events.bus import Channel, EventBus
from app.stage.roles import Roles
from app.stage.stage import Stage
from app.storage.database.store import RunStore
from app.storage.recordings import Recordings
from app.viewer.picture_feed import PictureFeed
from app.viewer.replay_frames import ReplayFrames
from hexapods.domain.records import Record


class SharedStage:
    """A stage, the feed of its picture, and the roles of clients.

    Several may be in one process, beside each other: they share the runs, their recordings and
    frames, and the bus. Within `async with` the stage advances.

    Attributes:
        path: path of its page, without a slash at its end, such as ""; that of the API begins with
            it.
        roles: roles of clients on it.
        session_path: path of the stage whose sessions operators have here.
        channel: channel of its events, and of those of the runs.
        stage: the stage: which run is shown, and its playback.
        viewers: number of pages that watch it.
    """

    def __init__(
        self,
        store: RunStore,
        recordings: Recordings,
        bus: EventBus,
        *,
        frames: ReplayFrames,
        roles: Roles,
        path: str = "",
        session_path: str | None = None,
        announces: bool = True,
        members: Mapping[str, Record] = MappingProxyType({}),
    ) -> None:
        """Create an empty stage; entering the context starts its feed.

        Args:
            store: store of the runs.
            recordings: recordings of the runs.
            bus: has the events of changed and deleted runs; receives the events of the stage.
            frames: encodes the frames of runs.
            roles: see the class.
            path: see the class.
            session_path: path of the stage whose sessions operators have here; by default its own.
            announces: whether it shows earlier races by itself.
            members: records that features add to the state of the stage, by name.
        """
        self.path, self.roles = path, roles
        self.session_path = path if session_path is None else session_path
        self.channel = Channel(bus)
        self.stage = Stage(store, recordings, self.channel, announces=announces, members=members)
        self.viewers = 0
        self._feed = PictureFeed(self.stage, frames, self.channel, lambda: self.viewers)
        self._resources = ExitStack()

    @property
    def pieces(self) -> int:
        """Number of pieces of the picture that were pushed."""
        return self._feed.pieces

    async def __aenter__(self) -> Self:
        self._resources.enter_context(self._feed)
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """End its event streams, and stop the feed. May be called twice."""
        self.channel.close()
        await asyncio.to_thread(self._resources.close)

    def count_viewer(self, change: int) -> None:
        """Count a page that begins to watch (1), or has left (-1). On the event loop."""
        self.viewers += change
        if self.viewers == 1:
            # The first need not wait for the next advance.
            self.stage.changed.set()
