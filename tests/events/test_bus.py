"""Event bus: order, coalescing for slow subscribers, and replay after a reconnection."""

import asyncio
import json
import threading
from collections.abc import Callable, Coroutine
from typing import Any

from app.answer import Answer
from app.events.bus import MAX_PENDING, RING_EVENTS, Event, EventBus, Subscription


class Number(Answer):
    """An event's number."""

    n: int


class Distances(Answer):
    """Distances that may be no numbers."""

    distance_m: float
    lanes: list[float]


async def receive(subscription: Subscription, count: int) -> list[Event]:
    events: list[Event] = []
    async for event in subscription:
        events.append(event)
        if len(events) == count:
            break
    return events


def in_loop(test: Callable[[], Coroutine[Any, Any, None]]) -> Callable[[], None]:
    return lambda: asyncio.run(asyncio.wait_for(test(), 30))


def test_events_published_from_many_threads_arrive_in_order() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()

        def publish() -> None:
            for n in range(100):
                bus.publish("e", Number(n=n))

        threads = [threading.Thread(target=publish) for _ in range(4)]
        for thread in threads:
            thread.start()
        events = await receive(subscription, 400)
        ids = [event.id for event in events]
        assert ids == sorted(set(ids))
        assert sorted(json.loads(e.data)["n"] for e in events) == sorted([*range(100)] * 4)

    in_loop(run)()


def test_event_ids_increase_across_restarts() -> None:
    before = EventBus()
    before.publish("e", Number(n=0))
    first = before.last_id
    after = EventBus()
    after.publish("e", Number(n=0))
    assert after.last_id >= first


def test_state_events_of_a_slow_subscriber_are_coalesced() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()
        for n in range(5):
            bus.publish("run", Number(n=n), "a")
            bus.publish("run", Number(n=n), "b")
            bus.publish("evaluation", Number(n=n), "a")
        events = await receive(subscription, 7)
        runs = [(e.run_id, json.loads(e.data)["n"]) for e in events if e.event == "run"]
        assert runs == [("a", 4), ("b", 4)]
        assert [json.loads(e.data)["n"] for e in events if e.event == "evaluation"] == [*range(5)]

    in_loop(run)()


def test_subscription_to_one_run_receives_only_its_events() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe({"a"})
        bus.publish("run", Number(n=1), "b")
        bus.publish("stage", Number(n=2))
        bus.publish("run", Number(n=3), "a")
        assert [json.loads(e.data)["n"] for e in await receive(subscription, 1)] == [3]

    in_loop(run)()


def test_reconnection_replays_all_but_state_events() -> None:
    async def run() -> None:
        bus = EventBus()
        bus.publish("evaluation", Number(n=0), "a")
        seen = bus.last_id
        bus.publish("run", Number(n=1), "a")
        bus.publish("evaluation", Number(n=2), "a")
        bus.publish("run-deleted", Number(n=3), "b")
        events = await receive(bus.subscribe(last_event_id=seen), 2)
        assert [json.loads(e.data)["n"] for e in events] == [2, 3]
        future = bus.subscribe(last_event_id=bus.last_id + 1)
        bus.publish("e", Number(n=4))
        assert [json.loads(e.data)["n"] for e in await receive(future, 1)] == [4]

    in_loop(run)()


def test_replay_buffer_is_bounded() -> None:
    async def run() -> None:
        bus = EventBus()
        for n in range(RING_EVENTS + 10):
            bus.publish("e", Number(n=n))
        late = bus.subscribe(last_event_id=0)
        bus.publish("e", Number(n=-1))
        first = (await receive(late, 1))[0]
        assert json.loads(first.data)["n"] >= 10

    in_loop(run)()


def test_subscription_with_too_many_pending_events_is_closed() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()
        for n in range(MAX_PENDING + 1):
            bus.publish("e", Number(n=n))
        events = [event async for event in subscription]
        assert len(events) <= MAX_PENDING + 1

    in_loop(run)()


def test_closing_the_bus_ends_every_subscription() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()
        bus.publish("e", Number(n=0))
        threading.Timer(0.05, bus.close).start()
        assert len([event async for event in subscription]) == 1
        assert [event async for event in bus.subscribe()] == []

    in_loop(run)()


def test_subscription_of_a_closed_loop_is_removed() -> None:
    bus = EventBus()

    async def listen() -> None:
        events = aiter(bus.subscribe())
        bus.publish("e", Number(n=0))
        await anext(events)

    asyncio.run(listen())
    bus.publish("e", Number(n=0))
    bus.publish("e", Number(n=0))


def test_nan_and_infinity_are_sent_as_null() -> None:
    async def listen() -> list[str]:
        bus = EventBus()
        subscription = bus.subscribe()
        bus.publish("e", Distances(distance_m=float("nan"), lanes=[float("inf"), 1.5]))
        bus.close()
        return [event.data async for event in subscription]

    assert asyncio.run(listen()) == ['{"distance_m":null,"lanes":[null,1.5]}']


def test_events_can_be_drained_without_a_loop() -> None:
    bus = EventBus()
    subscription = bus.subscribe(names={"run", "run-deleted"})
    bus.publish("run", Number(n=1), "a")
    bus.publish("evaluation", Number(n=2), "a")
    bus.publish("run", Number(n=3), "a")
    bus.publish("run-deleted", Number(n=4), "b")
    assert [json.loads(event.data)["n"] for event in subscription.drain()] == [3, 4]
    assert subscription.drain() == []


def test_full_subscription_grows_no_more_and_continues_after_its_last_event() -> None:
    bus = EventBus()
    stalled = bus.subscribe()
    count = MAX_PENDING + 1000
    for n in range(count):
        bus.publish("evaluation", Number(n=n))
    received = stalled.drain()
    assert len(received) == MAX_PENDING
    received += bus.subscribe(last_event_id=received[-1].id).drain()
    assert [json.loads(event.data)["n"] for event in received] == [*range(count)]


def test_long_replay_is_continued_where_it_was_cut() -> None:
    bus = EventBus()
    first = bus.last_id
    for n in range(RING_EVENTS):
        bus.publish("evaluation", Number(n=n))
    received: list[Event] = []
    while len(received) < RING_EVENTS:
        since = received[-1].id if received else first
        replay = bus.subscribe(last_event_id=since)
        assert replay.since == since
        received += replay.drain()
    assert [json.loads(event.data)["n"] for event in received] == [*range(RING_EVENTS)]
