"""The hub: one connection to viser, shown to every browser.

viser encodes anew for each client and has no notion of who may do what. So it has one reader, this
one, within the process, and browsers get the bytes it gets, on the app's own port. They cannot say
anything to viser: the hub listens to nothing but which robot they want to follow.
"""

import asyncio
import contextlib
import logging
from collections.abc import AsyncGenerator, Callable, Collection
from types import TracebackType
from typing import Self

from starlette.types import Scope
from starlette.websockets import WebSocket

from app.limits.places import NoPlace, Places
from app.viewer import follow, wire
from app.viewer.session import Counters, Session
from app.viewer.snapshot import UNWANTED, Snapshot

_RETRY_S = 0.5
_GOODBYE_S = 1.0
_REMOVALS_KEPT = 100

_PROTOCOL_ERROR = 1002
_GOING_AWAY = 1001
_SERVICE_RESTART = 1012
_TRY_AGAIN_LATER = 1013

Upstream = Callable[[], AsyncGenerator[bytes, None]]

_logger = logging.getLogger(__name__)


class Hub:
    """Relays viser's stream to many browsers, read-only.

    `async with hub:` keeps it connected; all of it runs on that event loop.
    """

    def __init__(
        self,
        upstream: Upstream | None = None,
        *,
        follow_position: follow.FollowPosition | None = None,
        follow_frame: str = "/world",
        max_viewers: int = 300,
        max_per_address: int | None = None,
        address_of: Callable[[Scope], str] | None = None,
        allowed_origins: Collection[str] = (),
        on_viewers_changed: Callable[[int], None] | None = None,
    ) -> None:
        """Connect to nothing yet.

        Args:
            upstream: Begins viser's stream of encoded frames, and ends with a ConnectionError
                when viser does; None while there is no viser.
            follow_position: Where the robots are that can be followed; without it, none can.
            follow_frame: The scene node that everything is drawn under.
            max_viewers: Further ones are asked to try again later; see `Places` for who is.
            max_per_address: So many spectators of one address; without it, as many as there are.
            address_of: Groups connections by where they are from; without it, by the client's host.
            allowed_origins: Origins beside the one that a request's own Host names, for a proxy
                that changes the Host.
            on_viewers_changed: Called with how many watch when that changes.
        """
        self.upstream = upstream
        """May be changed; counts from the next time that viser is lost and found."""
        self.counters = Counters()
        self._follow_position = follow_position
        self._follow_frame = follow_frame
        share = max_viewers + 1 if max_per_address is None else max_per_address
        self._places = Places[Session](max_viewers, share)
        self._address_of = address_of or _client_host
        self._allowed_origins = frozenset(allowed_origins)
        self._on_viewers_changed = on_viewers_changed
        self._sessions: set[Session] = set()
        self._snapshot = Snapshot()
        self._packed: dict[tuple[int | None, str], wire.Frame] = {}
        self._live = False
        self._relaying: asyncio.Task[None] | None = None

    @property
    def live(self) -> bool:
        """Whether viser is there, and has told all it had."""
        return self._live

    async def __aenter__(self) -> Self:
        self.start()
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.stop()

    def start(self) -> None:
        """Connect to viser, now and whenever it comes back. Needs a running event loop."""
        if self._relaying is None:
            self._relaying = asyncio.create_task(self._stay_connected())

    async def stop(self) -> None:
        """Close every viewer, in about a second at most, and disconnect. May be called twice."""
        relaying, self._relaying = self._relaying, None
        if relaying is None:
            return
        relaying.cancel()
        sessions = list(self._sessions)
        for session in sessions:
            session.close(_GOING_AWAY, "the server stops")
        await asyncio.gather(*(session.closed(_GOODBYE_S) for session in sessions))
        await asyncio.gather(relaying, return_exceptions=True)

    async def serve(self, websocket: WebSocket) -> None:
        """Serve one browser until it leaves: the endpoint of the websocket route.

        The query's `view` is what it follows at first; see `follow.chosen_view` for later.
        """
        if not self._is_same_origin(websocket):
            # Before accepting: answered with HTTP 403.
            await websocket.close()
            return
        offered = websocket.scope["subprotocols"]
        if refusal := self._refusal(offered):
            # A browser learns the reason only from a connection that was accepted.
            await websocket.accept(subprotocol=offered[0] if offered else None)
            await websocket.close(*refusal)
            return
        view = follow.valid_view(websocket.query_params.get("view")) or follow.FREE
        session = Session(websocket, view, self.counters, self._missed_by)
        is_operator = websocket.scope.get("state", {}).get("role") == "operator"
        try:
            # Before the first await, or a crowd at the door would all find it open.
            loser = self._places.take(session, self._address_of(websocket.scope), is_operator)
        except NoPlace as error:
            await websocket.accept(subprotocol=wire.SUBPROTOCOL)
            await websocket.close(_TRY_AGAIN_LATER, error.reason)
            return
        if loser is not None:
            loser.close(_TRY_AGAIN_LATER, "place taken")
        self._sessions.add(session)
        self._count_viewers()
        try:
            await websocket.accept(subprotocol=wire.SUBPROTOCOL)
            await session.run(self._show_view)
        finally:
            self._places.leave(session)
            self._sessions.discard(session)
            self._count_viewers()

    def _refusal(self, offered: list[str]) -> tuple[int, str] | None:
        if wire.SUBPROTOCOL not in offered:
            return _PROTOCOL_ERROR, "reload"
        if self._relaying is None:
            return _GOING_AWAY, "the server stops"
        return None

    def _is_same_origin(self, websocket: WebSocket) -> bool:
        origin = websocket.headers.get("origin")
        if origin is None or origin in self._allowed_origins:
            # Only browsers send an Origin, and only they carry someone else's cookies.
            return True
        return origin.partition("://")[2] == websocket.headers.get("host")

    def _count_viewers(self) -> None:
        self.counters.viewers = len(self._sessions)
        if self._on_viewers_changed is not None:
            self._on_viewers_changed(len(self._sessions))

    async def _stay_connected(self) -> None:
        while True:
            try:
                await self._relay()
            except ConnectionError as error:
                if self._live:
                    _logger.warning("lost viser, trying again: %s", error)
            except Exception:
                # A fault of ours in one frame must not end the show for good.
                _logger.exception("relaying failed, beginning anew")
            self._live = False
            await asyncio.sleep(_RETRY_S)

    async def _relay(self) -> None:
        if self.upstream is None:
            raise ConnectionError("there is no viser yet")
        self._snapshot = Snapshot()
        async with contextlib.aclosing(self.upstream()) as frames:
            async for raw in frames:
                self._take(wire.parse(raw).without(UNWANTED))

    def _take(self, frame: wire.Frame) -> None:
        self._snapshot.apply(frame)
        self._packed.clear()
        if self._live:
            if frame.messages:
                self._fan_out(frame)
            self._forget_removals()
        elif self._snapshot.complete:
            self._live = True
            self._begin()

    def _begin(self) -> None:
        for session in self._sessions:
            if session.version is None:
                session.wake()
            else:
                # Its page still has the old scene; reconnecting is what clears it.
                session.close(_SERVICE_RESTART, "resync")
                self.counters.resyncs += 1

    def _fan_out(self, frame: wire.Frame) -> None:
        by_view: dict[str, wire.Frame] = {}
        for session in self._sessions:
            if session.view not in by_view:
                # In the same frame, lest a browser draw the robot moved but not yet centred.
                by_view[session.view] = frame.extended(*self._centring(session.view))
            session.push(by_view[session.view], self._snapshot.version)

    def _missed_by(self, session: Session) -> tuple[wire.Frame, int] | None:
        if not self._live:
            return None
        # When all are behind they are so by the same, and must not each cost a frame's making.
        key = (session.version, session.view)
        if key not in self._packed:
            centring = self._centring(session.view)
            self._packed[key] = self._snapshot.pack(session.version, centring)
        return self._packed[key], self._snapshot.version

    def _show_view(self, session: Session) -> None:
        centring = self._centring(session.view)
        if centring and session.version is not None:
            frame = wire.pack(centring, (), self._snapshot.timestamp_s)
            session.push(frame, self._snapshot.version)

    def _centring(self, view: str) -> list[wire.Message]:
        if view == follow.FREE or self._follow_position is None:
            return []
        position = self._follow_position(view)
        return [] if position is None else [follow.centring(self._follow_frame, position)]

    def _forget_removals(self) -> None:
        if self._snapshot.removals > _REMOVALS_KEPT:
            versions = [one.version for one in self._sessions if one.version is not None]
            self._snapshot.forget_removals(min(versions, default=self._snapshot.version))


def _client_host(scope: Scope) -> str:
    return scope["client"][0] if scope.get("client") else ""
