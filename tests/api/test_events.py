"""Event stream: the snapshot is consistent with the events published while it is read."""

import asyncio
import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from app.api import events
from app.api.deps import EventListener, Services
from app.events.bus import MAX_PENDING_PIECES
from app.events.event_records import DeletedRun, EvaluationEvent
from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import open_store
from app.storage.run import LIVE, QUEUED
from hexapods.domain.records import Record, to_json_bytes
from tests.storage.stores import training
from tests.timeouts import LONG_S


def evaluation(step: int) -> EvaluationEvent:
    return EvaluationEvent(run_id="a", step=step, distance_m=0.1, epsilon=0.5)


class ReceivedEvent(NamedTuple):
    """One server-sent event."""

    event: str
    id: int
    data: Any


def _received(text: str) -> ReceivedEvent:
    fields = dict(line.split(": ", 1) for line in text.split("\n"))
    return ReceivedEvent(fields["event"], int(fields.get("id", "0")), json.loads(fields["data"]))


class Stream:
    """The event stream of one client, on the event loop of the test."""

    def __init__(
        self, services: Services, last_event_id: int | None = None, *, has_picture: bool = False
    ) -> None:
        header = None if last_event_id is None else str(last_event_id)
        self.chunks: Any = events.stream_events(
            services,
            services.stages[0],
            None,
            EventListener("operator"),
            header,
            has_picture=has_picture,
        )
        self._received: list[ReceivedEvent] = []

    async def next(self) -> ReceivedEvent:
        while not self._received:
            chunk = await asyncio.wait_for(anext(self.chunks), LONG_S)
            self._received += map(_received, chunk.decode().removesuffix("\n\n").split("\n\n"))
        return self._received.pop(0)

    async def __aenter__(self) -> "Stream":
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.chunks.aclose()

    async def next_of(self, name: str) -> ReceivedEvent:
        while (event := await self.next()).event != name:
            pass
        return event


@pytest.fixture
def services(tmp_path: Path) -> Iterator[Services]:
    settings = Settings(data=tmp_path)
    with open_store(settings) as store:
        services: Services = create_app(settings, store).state.services
        yield services


class BlockedRead:
    """Blocks the read of a snapshot, before or after its query."""

    def __init__(self, services: Services, monkeypatch: pytest.MonkeyPatch, moment: str) -> None:
        self.reached, self.go_on = threading.Event(), threading.Event()
        self.thread: threading.Thread | None = None
        read = services.store.list

        def blocked_list(*args: Any, **filters: Any) -> Any:
            self.thread = threading.current_thread()
            page = read(*args, **filters) if moment == "after" else None
            self.reached.set()
            assert self.go_on.wait(LONG_S)
            return page or read(*args, **filters)

        monkeypatch.setattr(services.store, "list", blocked_list)


def change(services: Services, state: Any) -> None:
    """Change the state of run `a` and publish the change, as jobs do."""
    run = services.store.change("a", QUEUED | LIVE, state)
    services.bus.publish_run(run)


@pytest.mark.parametrize("moment", ["before", "after"])
def test_change_during_the_read_of_the_snapshot_is_neither_lost_nor_undone(
    services: Services, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    services.store.create(training("a"))
    blocked = BlockedRead(services, monkeypatch, moment)

    async def test() -> None:
        async with Stream(services) as stream:
            first = asyncio.create_task(stream.next())
            # The event loop is not blocked meanwhile.
            assert await asyncio.to_thread(blocked.reached.wait, LONG_S)
            change(services, "running")
            services.bus.publish("evaluation", evaluation(1), "a")
            change(services, "finished")
            blocked.go_on.set()
            snapshot = await first
            assert snapshot.event == "snapshot"
            shown = snapshot.data["runs"][0]["state"]
            assert shown == ("queued" if moment == "after" else "finished")
            received = [await stream.next(), await stream.next()]
            assert [(t.event, t.data.get("state")) for t in received] == [
                ("evaluation", None),
                ("run", "finished"),
            ]

    asyncio.run(test())
    assert blocked.thread is not threading.main_thread()


def test_snapshot_is_read_and_encoded_off_the_event_loop(
    services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number in range(200):
        services.store.create(training(f"run{number:03}"))
    monkeypatch.setattr(events, "NEWEST_RUNS", 200)
    threads: list[threading.Thread] = []

    def recorded(record: Record) -> bytes:
        threads.append(threading.current_thread())
        return to_json_bytes(record)

    monkeypatch.setattr("app.api.events.to_json_bytes", recorded)

    async def test() -> None:
        async with Stream(services) as stream:
            assert len((await stream.next()).data["runs"]) == 200

    asyncio.run(test())
    assert len(threads) == 1
    assert threads[0] is not threading.main_thread()


def test_client_that_reconnects_after_the_snapshot_misses_no_event(services: Services) -> None:
    """The snapshot's id precedes the ids of the events that follow it."""
    first = services.bus.last_id
    for step in range(1, 4):
        services.bus.publish("evaluation", evaluation(step), "a")

    async def test() -> None:
        last_id = first
        for _ in range(3):
            async with Stream(services, last_id) as left:
                last_id = (await left.next()).id
        async with Stream(services, last_id) as stream:
            assert (await stream.next()).event == "snapshot"
            assert [(await stream.next()).data["step"] for _ in range(3)] == [1, 2, 3]

    asyncio.run(test())


def test_replayed_deletion_does_not_remove_a_run_that_was_imported_again(
    services: Services,
) -> None:
    first = services.bus.last_id
    services.bus.publish("run-deleted", DeletedRun(id="a"), "a")
    services.bus.publish("run-deleted", DeletedRun(id="b"), "b")
    services.store.create(training("a", state="finished"))

    async def test() -> None:
        async with Stream(services, first) as stream:
            assert (await stream.next()).data["runs"][0]["id"] == "a"
            assert (await stream.next_of("run-deleted")).data["id"] == "b"
            services.store.delete("a")
            services.bus.publish("run-deleted", DeletedRun(id="a"), "a")
            assert (await stream.next_of("run-deleted")).data["id"] == "a"

    asyncio.run(test())


def test_pieces_of_the_picture_come_to_those_who_watch_alone(services: Services) -> None:
    stage = services.stages[0]

    async def test() -> None:
        async with Stream(services) as listening, Stream(services, has_picture=True) as watching:
            assert (await listening.next()).event == (await watching.next()).event == "snapshot"
            assert stage.viewers == 1
            stage.channel.publish("piece", evaluation(1))
            services.bus.publish("evaluation", evaluation(2), "a")
            assert (await listening.next()).event == "evaluation"
            assert [(await watching.next()).event for _ in range(2)] == ["piece", "evaluation"]
        assert stage.viewers == 0

    asyncio.run(test())


def test_a_client_that_does_not_read_has_few_pieces_waiting(services: Services) -> None:
    stage = services.stages[0]

    async def test() -> None:
        async with Stream(services, has_picture=True) as stream:
            await stream.next()
            for step in range(1, 50):
                stage.channel.publish("piece", evaluation(step))
                services.bus.publish("evaluation", evaluation(step), "a")
            received = [await stream.next() for _ in range(49 + MAX_PENDING_PIECES)]
            pieces = [event.data["step"] for event in received if event.event == "piece"]
            assert pieces == list(range(50 - MAX_PENDING_PIECES, 50))

    asyncio.run(test())


def test_a_quiet_stream_tells_the_time_of_the_servers_clock(
    services: Services, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(events, "_IDLE_S", 0.01)

    async def test() -> None:
        async with Stream(services) as stream:
            snapshot = await stream.next()
            clock = await stream.next()
            assert clock.event == "clock"
            assert clock.data["sent_s"] >= snapshot.data["stage"]["sent_s"]

    asyncio.run(test())
