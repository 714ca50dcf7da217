"""Fair semaphore: turns by client, a share for each, a bounded queue, and nothing for who left."""

import asyncio
from functools import partial

import pytest

from app.limits.fair_semaphore import FairSemaphore, NotAdmitted


def test_semaphore_is_round_robin_by_client() -> None:
    async def scenario() -> list[str]:
        semaphore, order = FairSemaphore(1), []
        await semaphore.acquire("first")

        async def take(client: str) -> None:
            await semaphore.acquire(client)
            order.append(client)
            semaphore.release(client)

        tasks = [asyncio.create_task(take(client)) for client in ("a", "a", "a", "b")]
        await asyncio.sleep(0)
        tasks[0].cancel()
        semaphore.release("first")
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.wait_for(semaphore.acquire("last"), 1)
        return order

    assert asyncio.run(scenario()) == ["a", "b", "a"]


def test_one_client_holds_no_more_than_its_share() -> None:
    async def scenario() -> None:
        semaphore = FairSemaphore(2, per_client=1)
        await semaphore.acquire("a")
        second = asyncio.create_task(semaphore.acquire("a"))
        await asyncio.sleep(0)
        await asyncio.wait_for(semaphore.acquire("b"), 1)
        semaphore.release("b")
        await asyncio.sleep(0)
        assert not second.done()
        semaphore.release("a")
        await asyncio.wait_for(second, 1)

    asyncio.run(scenario())


def test_a_client_that_has_left_gets_no_slot_and_does_not_fill_the_queue() -> None:
    async def scenario() -> None:
        semaphore, departed = FairSemaphore(1, max_waiting=2), set[int]()
        await semaphore.acquire("a")
        waiting = [
            asyncio.create_task(semaphore.acquire("b", partial(departed.__contains__, number)))
            for number in (0, 1)
        ]
        await asyncio.sleep(0)
        with pytest.raises(NotAdmitted) as full:
            await semaphore.acquire("b")
        assert full.value.reason == "full"
        departed |= {0}
        third = asyncio.create_task(semaphore.acquire("b", lambda: True))
        last = asyncio.create_task(semaphore.acquire("b", is_new=False))
        await asyncio.sleep(0)
        semaphore.release("a")
        await asyncio.wait_for(waiting[1], 1)
        semaphore.release("b")
        await asyncio.wait_for(last, 1)
        for left in (waiting[0], third):
            with pytest.raises(NotAdmitted) as refused:
                await left
            assert refused.value.reason == "left"
        semaphore.release("b")
        with pytest.raises(NotAdmitted):
            await semaphore.acquire("a", lambda: True)
        await asyncio.wait_for(semaphore.acquire("a"), 1)

    asyncio.run(scenario())


def test_closing_sends_all_away() -> None:
    async def scenario() -> None:
        semaphore = FairSemaphore(1)
        await semaphore.acquire("a")
        waiting = asyncio.create_task(semaphore.acquire("b"))
        await asyncio.sleep(0)
        semaphore.close()
        for refused in (waiting, semaphore.acquire("c")):
            with pytest.raises(NotAdmitted) as raised:
                await refused
            assert raised.value.reason == "closed"
        semaphore.release("a")

    asyncio.run(scenario())
