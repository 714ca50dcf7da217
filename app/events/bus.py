"""The event bus: from whatever thread something happens in, to everyone who listens."""

import asyncio
import itertools
import threading
import time
from collections import OrderedDict, deque
from collections.abc import AsyncIterator, Mapping
from typing import Any, NamedTuple

from app.storage.json_text import json_text

RING_EVENTS = 4096
MAX_PENDING = 2048
_NEWEST_ONLY = frozenset({"run", "scene", "stage", "summary", "viewers"})
"""Events that say how something *is*: an older one is worth nothing once there is a newer."""


class Event(NamedTuple):
    """Something that happened."""

    id: int
    event: str
    data: str
    """JSON, encoded once for all listeners."""
    run_id: str | None

    @property
    def key(self) -> Any:
        """Pending events of the same key replace each other."""
        return (self.event, self.run_id) if self.event in _NEWEST_ONLY else self.id


class Subscription:
    """One listener: `async for event in subscription`, on the loop that it was made on.

    A slow listener gets the newest of each `run`, `scene`, `stage`, `summary` and `viewers`; one
    that is too slow even for the others is let go, and comes back with `Last-Event-ID`.
    """

    def __init__(self, bus: "EventBus", run_id: str | None) -> None:
        self._bus, self._run_id = bus, run_id
        self._loop = asyncio.get_running_loop()
        self._pending: OrderedDict[Any, Event] = OrderedDict()
        self._lock = threading.Lock()
        self._wake = asyncio.Event()
        self._closed = False

    def push(self, event: Event) -> None:
        """Take in an event; from any thread."""
        if self._run_id is not None and event.run_id != self._run_id:
            return
        with self._lock:
            was_empty = not self._pending
            self._pending.pop(event.key, None)
            self._pending[event.key] = event
            if len(self._pending) > MAX_PENDING:
                self._closed = True
        if was_empty or self._closed:
            self._call_loop()

    def close(self) -> None:
        """End the iteration after what is pending; from any thread."""
        self._closed = True
        self._bus.remove(self)
        self._call_loop()

    async def __aiter__(self) -> AsyncIterator[Event]:
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                for event in self._take():
                    yield event
                if self._closed:
                    return
        finally:
            self._bus.remove(self)

    def _take(self) -> list[Event]:
        with self._lock:
            taken = list(self._pending.values())
            self._pending.clear()
        return taken

    def _call_loop(self) -> None:
        try:
            self._loop.call_soon_threadsafe(self._wake.set)
        except RuntimeError:  # the loop is closed, so nobody listens
            self._bus.remove(self)


class EventBus:
    """Publishes to all subscribers, and remembers a bounded number of events."""

    def __init__(self) -> None:
        # From the time of day, so that ids keep rising when the server is started again.
        self._last_id = time.time_ns() // 1_000_000
        self._ids = itertools.count(self._last_id + 1)
        self._ring: deque[Event] = deque(maxlen=RING_EVENTS)
        self._subscriptions: set[Subscription] = set()
        self._lock = threading.RLock()
        self._closed = False

    @property
    def last_id(self) -> int:
        """Of the newest event; before the first, lower than that will be."""
        return self._last_id

    def publish(self, event: str, data: Mapping[str, Any] | str, run_id: str | None = None) -> None:
        """Tell everyone; from any thread, in the order of the calls.

        Args:
            event: its name.
            data: what is to be said, or the JSON of it. A NaN or an infinity is sent as null: one
                run's number is no reason to end every stream.
            run_id: the run that it is about.
        """
        text = data if isinstance(data, str) else json_text(data)
        with self._lock:
            made = Event(next(self._ids), event, text, run_id)
            self._last_id = made.id
            if event not in _NEWEST_ONLY:
                self._ring.append(made)
            for subscription in list(self._subscriptions):
                subscription.push(made)

    def subscribe(
        self, run_id: str | None = None, last_event_id: int | None = None
    ) -> Subscription:
        """Listen from now on, to one run's events or to all.

        With `last_event_id`, what happened since then comes first, except what a snapshot says
        better. An id that is yet to come counts as none.
        """
        subscription = Subscription(self, run_id)
        with self._lock:
            if last_event_id is not None and last_event_id <= self._last_id:
                for missed in self._ring:
                    if missed.id > last_event_id:
                        subscription.push(missed)
            self._subscriptions.add(subscription)
        if self._closed:
            subscription.close()
        return subscription

    def remove(self, subscription: Subscription) -> None:
        """Tell it nothing any more."""
        with self._lock:
            self._subscriptions.discard(subscription)

    def close(self) -> None:
        """End every subscription, now and to come."""
        self._closed = True
        for subscription in list(self._subscriptions):
            subscription.close()
