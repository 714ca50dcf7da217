"""Event bus: publish and subscribe from any thread, or iterate on an asyncio loop.

Slow subscribers are handled by coalescing: state events replace pending ones with the same key. A
ring buffer replays the other events to subscribers that reconnect with `Last-Event-ID`.
"""

import asyncio
import itertools
import threading
import time
from collections import OrderedDict, deque
from collections.abc import AsyncIterator, Callable, Container
from typing import Any, NamedTuple

from fastapi.sse import format_sse_event

from app.events.run_view import view_of
from app.storage.run import AnyRun
from hexapods.domain.records import Record, to_json_bytes

RING_EVENTS = 4096
"""Capacity of the replay buffer in events."""
MAX_PENDING = 2048
"""Most pending events of a slow subscription."""
PIECE_EVENTS = frozenset({"piece"})
"""Names of events with frames of the picture: many bytes, and of no use after their time."""
MAX_PENDING_PIECES = 4
"""Most pending pieces of a slow subscription: a page fetches those that it needs and has missed."""


class Event(NamedTuple):
    """A published event.

    Attributes:
        id: increasing number, for `Last-Event-ID`.
        event: its name.
        data: JSON, encoded once for all subscribers.
        run_id: id of the run, or of what else it is about, or None.
        run: of a `run` event the run itself, for subscribers in this process.
        channel: the channel to whose subscribers alone it goes; None for all channels.
        is_state: whether it carries a full state.
        wire: it as a server-sent event, encoded once for all clients.
    """

    id: int
    event: str
    data: str
    run_id: str | None
    run: AnyRun | None = None
    channel: "Channel | None" = None
    is_state: bool = False
    wire: bytes = b""

    @property
    def key(self) -> Any:
        """Coalescing key: a new event replaces a pending one with the same key."""
        if self.event == "run-deleted":
            return ("run", self.run_id)
        return (self.event, self.run_id) if self.is_state else self.id


class Subscription:
    """Buffer of one subscriber: `drain()` it, or iterate: `async for event in subscription`.

    A slow subscriber receives only the newest of each event that carries a full state, and of `run`
    or `run-deleted` for each run.
    It is closed when it has `MAX_PENDING` pending events and another comes; the client then
    reconnects with `Last-Event-ID`.

    Attributes:
        since: id of an event after which it receives every event, but coalesced.
        channel: the channel to which it belongs; None for a subscription to all channels.
    """

    def __init__(
        self,
        bus: "EventBus",
        run_ids: Container[str | None] | None,
        names: Container[str] | None,
        channel: "Channel | None",
        since: int,
        *,
        has_picture: bool,
    ) -> None:
        self.since, self.channel, self._has_picture = since, channel, has_picture
        self._bus, self._run_ids, self._names = bus, run_ids, names
        self._pending: OrderedDict[Any, Event] = OrderedDict()
        self._lock = threading.Lock()
        self._closed = False
        self._wake: Callable[[], object] = lambda: None

    def push(self, event: Event) -> None:
        """Queue an event for the subscriber, coalescing by key; callable from any thread."""
        if self._run_ids is not None and event.run_id not in self._run_ids:
            return
        if self._names is not None and event.event not in self._names:
            return
        if event.event in PIECE_EVENTS and not self._has_picture:
            return
        if self.channel is not event.channel and None not in (self.channel, event.channel):
            return
        with self._lock:
            was_empty = not self._pending
            self._pending.pop(event.key, None)
            self._closed |= len(self._pending) >= MAX_PENDING
            if not self._closed:
                self._pending[event.key] = event
                self._drop_old_pieces()
        if self._closed:
            self.close()
        elif was_empty:
            self._wake_reader()

    def _drop_old_pieces(self) -> None:
        pieces = [key for key, event in self._pending.items() if event.event in PIECE_EVENTS]
        for key in pieces[:-MAX_PENDING_PIECES]:
            del self._pending[key]

    def close(self) -> None:
        """End the iteration after the pending events; callable from any thread."""
        self._closed = True
        self._bus.remove(self)
        self._wake_reader()

    def drain(self) -> list[Event]:
        """Remove and return the pending events; callable from any thread."""
        with self._lock:
            events = list(self._pending.values())
            self._pending.clear()
        return events

    async def __aiter__(self) -> AsyncIterator[Event]:
        async for events in self.batches():
            for event in events:
                yield event

    async def batches(self, idle_s: float | None = None) -> AsyncIterator[list[Event]]:
        """Yield the pending events when there are any, and none after a time without any.

        Args:
            idle_s: that time [s]; None to wait for events however long.
        """
        loop, ready = asyncio.get_running_loop(), asyncio.Event()
        self._wake = lambda: loop.call_soon_threadsafe(ready.set)
        ready.set()
        try:
            while True:
                is_idle = False
                try:
                    async with asyncio.timeout(idle_s):
                        await ready.wait()
                except TimeoutError:
                    is_idle = True
                ready.clear()
                events = self.drain()
                if events or is_idle:
                    yield events
                if self._closed:
                    return
        finally:
            self._bus.remove(self)

    def _wake_reader(self) -> None:
        try:
            self._wake()
        except RuntimeError:  # the loop is closed, and its subscribers with it
            self._bus.remove(self)


class EventBus:
    """Publishes events to all subscriptions, with a bounded replay buffer. Thread-safe.

    Attributes:
        state_events: names of events that carry a full state: a newer one of the same run, or of
            what else it is about, supersedes pending older ones.
    """

    def __init__(self) -> None:
        self.state_events = {"robots", "run", "stage", "summary", "viewers"}
        # Starts at the time [ms], so that ids keep increasing across restarts of the server.
        self._last_id = time.time_ns() // 1_000_000
        self._ids = itertools.count(self._last_id + 1)
        self._ring: deque[Event] = deque(maxlen=RING_EVENTS)
        self._subscriptions: set[Subscription] = set()
        self._lock = threading.RLock()
        self._closed = False

    @property
    def last_id(self) -> int:
        """Id of the newest event; before the first one, a lower number."""
        return self._last_id

    def publish_run(self, run: AnyRun, queue_position: int | None = None) -> None:
        """Send a `run` event for a run that has changed; arguments as of `view_of`."""
        self._send("run", view_of(run, queue_position), run.id, run=run)

    def publish(
        self,
        event: str,
        data: Record,
        run_id: str | None = None,
        channel: "Channel | None" = None,
    ) -> None:
        """Send an event to subscriptions, in the order of the calls; from any thread.

        Args:
            event: its name.
            data: of the event. A NaN or an infinity is sent as null, so that one run's number
                does not break every stream.
            run_id: the run, or what else it is about, if any.
            channel: the channel to whose subscribers alone it goes; None for all.
        """
        self._send(event, data, run_id, channel=channel)

    def _send(
        self,
        event: str,
        data: Record,
        run_id: str | None,
        run: AnyRun | None = None,
        channel: "Channel | None" = None,
    ) -> None:
        text = to_json_bytes(data).decode()
        with self._lock:
            is_state = event in self.state_events
            number = next(self._ids)
            wire = format_sse_event(data_str=text, event=event, id=str(number))
            published = Event(number, event, text, run_id, run, channel, is_state, wire)
            self._last_id = published.id
            if not is_state and event not in PIECE_EVENTS:
                self._ring.append(published)
            for subscription in list(self._subscriptions):
                subscription.push(published)

    def subscribe(
        self,
        run_ids: Container[str | None] | None = None,
        last_event_id: int | None = None,
        names: Container[str] | None = None,
        channel: "Channel | None" = None,
        *,
        has_picture: bool = False,
    ) -> Subscription:
        """Create a subscription.

        Args:
            run_ids: only events about these runs; None for all events.
            last_event_id: replay buffered events after this id first, except state events, which
                a snapshot supersedes. An id in the future counts as None.
            names: only events of these names; None for all.
            channel: only events of this channel, and those for all; None for every event.
            has_picture: whether it gets the pieces of the picture, too.
        """
        with self._lock:
            since = self._last_id
            if last_event_id is not None and last_event_id < since:
                since = last_event_id
            subscription = Subscription(
                self, run_ids, names, channel, since, has_picture=has_picture
            )
            self._subscriptions.add(subscription)
            for missed in self._ring if since < self._last_id else ():
                if missed.id > since:
                    subscription.push(missed)
        if self._closed or (channel is not None and channel.is_closed):
            subscription.close()
        return subscription

    def remove(self, subscription: Subscription) -> None:
        """Unsubscribe; does nothing if it is not subscribed."""
        with self._lock:
            self._subscriptions.discard(subscription)

    def close(self) -> None:
        """Close all subscriptions, and future ones at once."""
        self._closed = True
        self.close_subscriptions()

    def close_subscriptions(self, channel: "Channel | None" = None) -> None:
        """Close the present subscriptions of a channel; None for all."""
        with self._lock:
            subscriptions = list(self._subscriptions)
        for subscription in subscriptions:
            if channel in (None, subscription.channel):
                subscription.close()


class Channel:
    """The events of one stage, on a bus that it shares with other stages. Thread-safe.

    What is published here goes to its own subscribers; events about runs, which jobs publish on the
    bus, go to those of every channel.
    """

    def __init__(self, bus: EventBus) -> None:
        self._bus = bus
        self.is_closed = False

    def publish(self, event: str, data: Record, run_id: str | None = None) -> None:
        """Send an event to the subscribers of this channel; see `EventBus.publish`."""
        self._bus.publish(event, data, run_id, channel=self)

    def subscribe(
        self,
        run_ids: Container[str | None] | None = None,
        last_event_id: int | None = None,
        names: Container[str] | None = None,
        *,
        has_picture: bool = False,
    ) -> Subscription:
        """Create a subscription; see `EventBus.subscribe`."""
        return self._bus.subscribe(run_ids, last_event_id, names, self, has_picture=has_picture)

    def close(self) -> None:
        """Close all subscriptions of this channel, and future ones at once."""
        self.is_closed = True
        self._bus.close_subscriptions(self)
