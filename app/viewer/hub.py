"""The hub: fans one viser stream out to many browsers over websockets.

viser encodes anew for each client and has no authorization. So the hub is its only reader, in the
same process, and browsers receive the same bytes on the app's own port. They cannot send anything
to viser: the hub accepts only the message that chooses the robot to follow. Websockets of foreign
pages do not come here; `api.host_check` refuses them.
"""

import asyncio
import contextlib
import logging
import sys
from collections.abc import AsyncGenerator, Callable

from starlette.websockets import WebSocket

from app.limits.addresses import client_of
from app.limits.client_slots import ClientSlots, NoFreeSlot
from app.viewer.session import ELSEWHERE, FREE, Counters, Session, valid_view
from app.viewer.snapshot import Snapshot
from hexapods.drawing.track import WORLD, Position
from hexapods.drawing.viser_internals import stream

_RETRY_S = 0.5
_CLOSE_TIMEOUT_S = 1.0
_MAX_TOMBSTONES = 100

_PROTOCOL_ERROR = 1002
_GOING_AWAY = 1001
_SERVICE_RESTART = 1012
_TRY_AGAIN_LATER = 1013

Upstream = Callable[[], AsyncGenerator[bytes, None]]

FollowPosition = Callable[[str], Position | None]
"""Returns the position in the scene [m] of a view's robot, None if there is no such robot.
Called for each view in use at each frame, on the event loop."""

_logger = logging.getLogger(__name__)


class Hub:
    """Relays viser's stream to many browsers, read-only, and reconnects when viser is lost.

    All of it runs on the event loop on which it is started.
    """

    def __init__(
        self,
        upstream: Upstream | None = None,
        *,
        follow_position: FollowPosition | None = None,
        slots: ClientSlots[Session] | None = None,
        on_viewers_changed: Callable[[int], None] | None = None,
    ) -> None:
        """Create the hub; `start` connects it.

        Args:
            upstream: Opens viser's stream of encoded frames, which raises ConnectionError when
                viser stops; None while there is no viser.
            follow_position: Positions of the robots that can be followed; without it, none can.
            slots: Decides who is refused or evicted, by default nobody. Hubs may share it.
            on_viewers_changed: Called with the number of viewers when that changes.
        """
        self.upstream = upstream
        """May be replaced; used at the next reconnection."""
        self.counters = Counters()
        self._follow_position = follow_position
        self._slots = ClientSlots[Session](sys.maxsize, sys.maxsize) if slots is None else slots
        self._on_viewers_changed = on_viewers_changed
        self._sessions: set[Session] = set()
        self._snapshot = Snapshot()
        self._catch_up_frames: dict[tuple[int | None, str], stream.Frame] = {}
        self._live = False
        self._relay_task: asyncio.Task[None] | None = None

    @property
    def live(self) -> bool:
        """Whether viser is connected and its whole scene was received."""
        return self._live

    def start(self) -> None:
        """Connect to viser, and reconnect after each loss. Needs a running event loop."""
        if self._relay_task is None:
            self._relay_task = asyncio.create_task(self._stay_connected())

    async def stop(self) -> None:
        """Close all viewers within about a second, and disconnect. May be called twice."""
        relay_task, self._relay_task = self._relay_task, None
        if relay_task is None:
            return
        relay_task.cancel()
        sessions = list(self._sessions)
        for session in sessions:
            session.close(_GOING_AWAY, "the server stops")
        await asyncio.gather(*(session.closed(_CLOSE_TIMEOUT_S) for session in sessions))
        await asyncio.gather(relay_task, return_exceptions=True)

    async def serve(self, websocket: WebSocket) -> None:
        """Serve one browser until it disconnects: the endpoint of the websocket route.

        The query's `view` is what it follows at first; see `session.decode_view` for later changes.
        """
        subprotocols = websocket.scope["subprotocols"]
        if refusal := self._refusal(subprotocols):
            # Browsers get a close code and reason only after an accepted handshake.
            await websocket.accept(subprotocol=subprotocols[0] if subprotocols else None)
            await websocket.close(*refusal)
            return
        view = valid_view(websocket.query_params.get("view")) or FREE
        session = Session(websocket, view, self.counters, self._catch_up_frame)
        is_operator = websocket.scope.get("state", {}).get("role") == "operator"
        try:
            # Before the first await: otherwise concurrent connections would exceed the limit.
            evicted = self._slots.take(session, client_of(websocket.scope), is_operator)
        except NoFreeSlot as error:
            await websocket.accept(subprotocol=stream.SUBPROTOCOL)
            await websocket.close(_TRY_AGAIN_LATER, error.reason)
            return
        if evicted is not None:
            evicted.close(_TRY_AGAIN_LATER, "place taken")
        self._sessions.add(session)
        self._publish_viewer_count()
        try:
            await websocket.accept(subprotocol=stream.SUBPROTOCOL)
            await session.run(self._send_view)
        finally:
            self._slots.leave(session)
            self._sessions.discard(session)
            self._publish_viewer_count()

    def _refusal(self, subprotocols: list[str]) -> tuple[int, str] | None:
        if stream.SUBPROTOCOL not in subprotocols:
            return _PROTOCOL_ERROR, "reload"
        if self._relay_task is None:
            return _GOING_AWAY, "the server stops"
        return None

    def _publish_viewer_count(self) -> None:
        self.counters.viewers = len(self._sessions)
        if self._on_viewers_changed is not None:
            self._on_viewers_changed(len(self._sessions))

    async def _stay_connected(self) -> None:
        while True:
            try:
                await self._relay()
            except ConnectionError as error:
                if self._live:
                    _logger.warning("lost the connection to viser, trying again: %s", error)
            except Exception:
                # An error of the hub itself in one frame must not end relaying for good.
                _logger.exception("relaying failed, restarting it")
            self._live = False
            await asyncio.sleep(_RETRY_S)

    async def _relay(self) -> None:
        if self.upstream is None:
            raise ConnectionError("there is no viser yet")
        self._snapshot = Snapshot()
        async with contextlib.aclosing(self.upstream()) as frames:
            async for raw in frames:
                self._apply(stream.parse(raw).without_blocked())

    def _apply(self, frame: stream.Frame) -> None:
        self._snapshot.apply(frame)
        self._catch_up_frames.clear()
        if self._live:
            if frame.messages:
                self._fan_out(frame)
            self._drop_tombstones()
        elif self._snapshot.complete:
            self._live = True
            self._start_sessions()

    def _start_sessions(self) -> None:
        for session in self._sessions:
            if session.version is None:
                session.wake()
            else:
                # The browser still has the old scene, which only a reconnection clears.
                session.close(_SERVICE_RESTART, "resync")
                self.counters.resyncs += 1

    def _fan_out(self, frame: stream.Frame) -> None:
        by_view: dict[str, stream.Frame] = {}
        for session in self._sessions:
            if session.view == ELSEWHERE:
                continue
            if session.view not in by_view:
                # In the same frame, so that no browser draws the robot moved but not yet centred.
                by_view[session.view] = frame.with_messages(*self._centring_messages(session.view))
            session.push(by_view[session.view], self._snapshot.version)

    def _catch_up_frame(self, session: Session) -> tuple[stream.Frame, int | None] | None:
        if session.view == ELSEWHERE:
            # viser's client waits for the end of the backlog before it shows anything.
            return stream.pack([{"type": stream.REPLAY_DONE}], (), self._snapshot.timestamp_s), None
        if not self._live:
            return None
        # Cached: sessions that lag by the same version share one encoding.
        key = (session.version, session.view)
        if key not in self._catch_up_frames:
            centring_message = self._centring_messages(session.view)
            self._catch_up_frames[key] = self._snapshot.pack(session.version, centring_message)
        return self._catch_up_frames[key], self._snapshot.version

    def _send_view(self, session: Session) -> None:
        if session.view == ELSEWHERE:
            session.forget()
            return
        if session.version is None:
            session.resume()
            return
        centring_message = self._centring_messages(session.view)
        if centring_message:
            frame = stream.pack(centring_message, (), self._snapshot.timestamp_s)
            session.push(frame, self._snapshot.version)

    def _centring_messages(self, view: str) -> list[stream.Message]:
        """Return the message that translates the world by minus the position of a view's robot.

        Not in height: a bouncing robot would shake the ground.
        """
        if view == FREE or self._follow_position is None:
            return []
        position = self._follow_position(view)
        if position is None:
            return []
        return [stream.position_message(WORLD, (-position[0], -position[1], 0.0))]

    def _drop_tombstones(self) -> None:
        if self._snapshot.tombstones > _MAX_TOMBSTONES:
            versions = [
                session.version for session in self._sessions if session.version is not None
            ]
            self._snapshot.drop_tombstones(min(versions, default=self._snapshot.version))
