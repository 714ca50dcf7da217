"""The bus: order, what a slow listener gets, and what one gets that comes back."""

import asyncio
import json
import threading
from collections.abc import Callable, Coroutine
from typing import Any

from app.events.bus import MAX_PENDING, RING_EVENTS, Event, EventBus, Subscription


async def take(subscription: Subscription, count: int) -> list[Event]:
    taken: list[Event] = []
    async for event in subscription:
        taken.append(event)
        if len(taken) == count:
            break
    return taken


def in_loop(test: Callable[[], Coroutine[Any, Any, None]]) -> Callable[[], None]:
    return lambda: asyncio.run(asyncio.wait_for(test(), 30))


def test_events_come_in_order_and_from_any_thread() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()

        def publish() -> None:
            for n in range(100):
                bus.publish("e", {"n": n})

        threads = [threading.Thread(target=publish) for _ in range(4)]
        for thread in threads:
            thread.start()
        taken = await take(subscription, 400)
        ids = [event.id for event in taken]
        assert ids == sorted(set(ids))
        assert sorted(json.loads(e.data)["n"] for e in taken) == sorted([*range(100)] * 4)

    in_loop(run)()


def test_ids_go_on_rising_after_a_restart() -> None:
    before = EventBus()
    before.publish("e", {})
    first = before.last_id
    after = EventBus()
    after.publish("e", {})
    assert after.last_id >= first


def test_a_slow_listener_gets_the_newest_of_each_run() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()
        for n in range(5):
            bus.publish("run", {"n": n}, "a")
            bus.publish("run", {"n": n}, "b")
            bus.publish("evaluation", {"n": n}, "a")
        taken = await take(subscription, 7)
        runs = [(e.run_id, json.loads(e.data)["n"]) for e in taken if e.event == "run"]
        assert runs == [("a", 4), ("b", 4)]
        assert [json.loads(e.data)["n"] for e in taken if e.event == "evaluation"] == [*range(5)]

    in_loop(run)()


def test_one_run_only() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe("a")
        bus.publish("run", {"n": 1}, "b")
        bus.publish("stage", {"n": 2})
        bus.publish("run", {"n": 3}, "a")
        assert [json.loads(e.data)["n"] for e in await take(subscription, 1)] == [3]

    in_loop(run)()


def test_who_comes_back_gets_what_a_snapshot_does_not_say() -> None:
    async def run() -> None:
        bus = EventBus()
        bus.publish("evaluation", {"n": 0}, "a")
        seen = bus.last_id
        bus.publish("run", {"n": 1}, "a")
        bus.publish("evaluation", {"n": 2}, "a")
        bus.publish("run-deleted", {"n": 3}, "b")
        taken = await take(bus.subscribe(last_event_id=seen), 2)
        assert [json.loads(e.data)["n"] for e in taken] == [2, 3]
        future = bus.subscribe(last_event_id=bus.last_id + 1)
        bus.publish("e", {"n": 4})
        assert [json.loads(e.data)["n"] for e in await take(future, 1)] == [4]

    in_loop(run)()


def test_it_remembers_a_bounded_number() -> None:
    async def run() -> None:
        bus = EventBus()
        for n in range(RING_EVENTS + 10):
            bus.publish("e", {"n": n})
        late = bus.subscribe(last_event_id=0)
        bus.publish("e", {"n": -1})
        first = (await take(late, 1))[0]
        assert json.loads(first.data)["n"] >= 10

    in_loop(run)()


def test_one_that_never_reads_is_let_go() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()
        for n in range(MAX_PENDING + 1):
            bus.publish("e", {"n": n})
        taken = [event async for event in subscription]
        assert len(taken) <= MAX_PENDING + 1

    in_loop(run)()


def test_closing_ends_every_subscription() -> None:
    async def run() -> None:
        bus = EventBus()
        subscription = bus.subscribe()
        bus.publish("e", {})
        threading.Timer(0.05, bus.close).start()
        assert len([event async for event in subscription]) == 1
        assert [event async for event in bus.subscribe()] == []

    in_loop(run)()


def test_no_listener_is_kept_after_its_loop_is_gone() -> None:
    bus = EventBus()

    async def listen() -> None:
        bus.subscribe()

    asyncio.run(listen())
    bus.publish("e", {})
    bus.publish("e", {})


def test_a_number_that_json_has_not_breaks_no_stream() -> None:
    async def listen() -> list[str]:
        bus = EventBus()
        subscription = bus.subscribe()
        bus.publish("e", {"distance_m": float("nan"), "lanes": [float("inf"), 1.5]})
        bus.close()
        return [event.data async for event in subscription]

    assert asyncio.run(listen()) == ['{"distance_m": null, "lanes": [null, 1.5]}']
