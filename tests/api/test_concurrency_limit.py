"""Concurrency limit: slots by role, fair by client, and not held by slow clients."""

import asyncio

from starlette.types import Message, Receive, Scope, Send

from app.api.auth import Role
from app.api.concurrency_limit import (
    ENCODING_SLOTS,
    PROBE_SLOTS,
    SLOTS,
    WHAT_IF_SLOTS,
    ConcurrencyLimit,
    RoundRobinSemaphore,
)
from app.api.rate_limit import WHAT_IF

STOP = "/api/v1/trainings/x/stop"


def scope(role: str, address: str, method: str = "GET", path: str = "/") -> Scope:
    request = {"type": "http", "method": method, "path": path}
    return {**request, "state": {"role": role}, "client": (address, 1)}


async def nothing() -> Message:
    return {"type": "http.request", "body": b"", "more_body": False}


async def ignore(message: Message) -> None:
    del message


def test_semaphore_is_round_robin_by_client() -> None:
    async def scenario() -> list[str]:
        semaphore, order = RoundRobinSemaphore(1), []
        await semaphore.acquire("first")

        async def take(client: str) -> None:
            await semaphore.acquire(client)
            order.append(client)
            semaphore.release()

        tasks = [asyncio.create_task(take(client)) for client in ("a", "a", "a", "b")]
        await asyncio.sleep(0)
        tasks[0].cancel()
        semaphore.release()
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.wait_for(semaphore.acquire("last"), 1)
        return order

    assert asyncio.run(scenario()) == ["a", "b", "a"]


def test_spectators_do_not_delay_operators() -> None:
    async def scenario() -> tuple[int, int]:
        working = {"spectator": 0, "operator": 0}

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            working[scope["state"]["role"]] += 1
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work)
        tasks = [
            asyncio.ensure_future(app(scope(role, "a"), nothing, ignore))
            for role in ["spectator"] * 50 + ["operator"] * 2
        ]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return working["spectator"], working["operator"]

    assert asyncio.run(scenario()) == (SLOTS["spectator"], 2)


def test_what_ifs_of_spectators_do_not_delay_what_spectators_read() -> None:
    async def scenario() -> dict[str, int]:
        working = {"what-if": 0, "read": 0}

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            working["what-if" if scope["method"] == "POST" else "read"] += 1
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work)
        what_ifs = [scope("spectator", str(n), "POST", WHAT_IF) for n in range(20)]
        tasks = [
            asyncio.ensure_future(app(one, nothing, ignore))
            for one in (*what_ifs, scope("spectator", "a"))
        ]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return working

    assert asyncio.run(scenario()) == {"what-if": WHAT_IF_SLOTS, "read": 1}


def test_requests_do_not_delay_probes() -> None:
    """A probe with the address of a client that has many requests in progress is answered."""

    async def scenario() -> int:
        probed = 0

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            nonlocal probed
            probed += scope["path"] == "/readyz"
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work)
        paths = ["/"] * 50 + ["/readyz"] * 50
        tasks = [
            asyncio.ensure_future(app(scope("spectator", "a", path=path), nothing, ignore))
            for path in paths
        ]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return probed

    assert asyncio.run(scenario()) == PROBE_SLOTS


def test_files_that_take_long_delay_nothing_else() -> None:
    async def scenario() -> dict[str, int]:
        working = {"file": 0, "command": 0, "read": 0}

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            kinds = {"/": "read", STOP: "command"}
            working[kinds.get(scope["path"], "file")] += 1
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work)
        paths = ["/api/v1/runs/x/mcap", "/api/v1/runs/x/page", "/api/v1/races/x/recording"]
        roles: list[Role] = ["spectator", "operator"]
        requests: list[Scope] = [
            {**scope(role, str(n), path=path), "query_string": b"format=vise%72"}
            for role in roles
            for n in range(10)
            for path in paths
        ]
        requests += [scope("spectator", "a"), scope("operator", "a", "POST", STOP)]
        tasks = [asyncio.ensure_future(app(one, nothing, ignore)) for one in requests]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return working

    files = sum(ENCODING_SLOTS.values())
    assert asyncio.run(scenario()) == {"file": files, "command": 1, "read": 1}


def test_slow_readers_and_streams_hold_no_slot() -> None:
    async def scenario() -> int:
        answered = 0

        async def answer(scope: Scope, receive: Receive, send: Send) -> None:
            nonlocal answered
            kind = b"text/event-stream" if scope["client"][0] == "stream" else b"text/plain"
            headers = [(b"content-type", kind)]
            await send({"type": "http.response.start", "status": 200, "headers": headers})
            answered += 1
            if scope["client"][0] == "stream":
                await send({"type": "http.response.body", "body": b"x", "more_body": True})
                await asyncio.Event().wait()
            await send({"type": "http.response.body", "body": b"x"})

        async def stall(message: Message) -> None:
            if message["type"] == "http.response.body" and not message.get("more_body"):
                await asyncio.Event().wait()

        async def never() -> Message:
            await asyncio.Event().wait()
            raise AssertionError

        app = ConcurrencyLimit(answer)
        tasks = [
            asyncio.ensure_future(app(scope("spectator", client), never, stall))
            for client in ["stream", "unread"] * 10 * SLOTS["spectator"]
        ]
        await asyncio.sleep(0.05)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return answered

    assert asyncio.run(scenario()) == 20 * SLOTS["spectator"]


def test_two_tasks_of_a_request_acquire_one_slot() -> None:
    """One task sends a response while another waits for the client's disconnect."""

    async def scenario() -> None:
        async def answer(scope: Scope, receive: Receive, send: Send) -> None:
            async def stream() -> None:
                for _ in range(3):
                    await send({"type": "http.response.body", "body": b"x", "more_body": True})

            await asyncio.gather(stream(), receive(), receive())

        async def later() -> Message:
            await asyncio.sleep(0)
            return await nothing()

        async def slowly(message: Message) -> None:
            await asyncio.sleep(0)

        app = ConcurrencyLimit(answer)
        for _ in range(10 * SLOTS["spectator"]):
            await asyncio.wait_for(app(scope("spectator", "a"), later, slowly), 1)

    asyncio.run(scenario())
