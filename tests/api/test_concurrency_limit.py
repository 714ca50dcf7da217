"""Requests are worked on in turns, fairly by address, and not while their clients are slow."""

import asyncio

from starlette.types import Message, Receive, Scope, Send

from app.api.concurrency_limit import TURNS, ConcurrencyLimit, RoundRobinSemaphore


def scope(role: str, address: str) -> Scope:
    return {"type": "http", "state": {"role": role}, "client": (address, 1)}


async def nothing() -> Message:
    return {"type": "http.request", "body": b"", "more_body": False}


async def ignore(message: Message) -> None:
    del message


def test_the_semaphore_is_fair_by_who_waits() -> None:
    async def play() -> list[str]:
        semaphore, order = RoundRobinSemaphore(1), []
        await semaphore.acquire("first")

        async def take(who: str) -> None:
            await semaphore.acquire(who)
            order.append(who)
            semaphore.release()

        tasks = [asyncio.create_task(take(who)) for who in ("a", "a", "a", "b")]
        await asyncio.sleep(0)
        tasks[0].cancel()
        semaphore.release()
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.wait_for(semaphore.acquire("last"), 1)
        return order

    assert asyncio.run(play()) == ["a", "b", "a"]


def test_strangers_keep_no_operator_waiting() -> None:
    async def play() -> tuple[int, int]:
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

    assert asyncio.run(play()) == (TURNS["spectator"], 2)


def test_who_does_not_read_and_who_streams_has_no_turn() -> None:
    async def play() -> int:
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
            asyncio.ensure_future(app(scope("spectator", who), never, stall))
            for who in ["stream", "unread"] * 10 * TURNS["spectator"]
        ]
        await asyncio.sleep(0.05)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return answered

    assert asyncio.run(play()) == 20 * TURNS["spectator"]


def test_a_turn_is_taken_once_though_two_tasks_of_a_request_wait() -> None:
    """As where an answer is sent while another task waits for the client to go."""

    async def play() -> None:
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
        for _ in range(10 * TURNS["spectator"]):
            await asyncio.wait_for(app(scope("spectator", "a"), later, slowly), 1)

    asyncio.run(play())
