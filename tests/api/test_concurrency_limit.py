"""Concurrency limit: slots by role, fair by client, and not held by slow clients."""

import asyncio
import socket
from pathlib import Path

from starlette.types import Message, Receive, Scope, Send

from app.api.concurrency_limit import (
    MAX_WAITING,
    ConcurrencyLimit,
    WorkSlots,
)
from app.api.policy import QUESTION, WATCH, RoutePolicy, policies, work_of
from app.api.work import ENCODING, OTHER, PROBE, Slots, Work
from app.limits.connections import ConnectionTable
from app.server import create_app
from app.settings import Settings
from app.stage.roles import Role
from tests.api.guarding import admitted
from tests.features.needing import needs
from tests.storage.stores import temporary_store

STOP = "/api/v1/trainings/x/stop"
READ, PROBED = RoutePolicy(access=WATCH), RoutePolicy(access=WATCH, work=PROBE)
FILE = RoutePolicy(access=WATCH, work=ENCODING)
SINGLE = Work(name="question", spectators=Slots(1, 1), operators=None)
"""As a feature may define one."""
ASKED = RoutePolicy(access=QUESTION, work=SINGLE)
READING = OTHER.spectators.size


def scope(
    role: str, address: str, method: str = "GET", path: str = "/", policy: RoutePolicy = READ
) -> Scope:
    request = {"type": "http", "method": method, "path": path, "query_string": b""}
    return {**request, "state": admitted(role, policy), "client": (address, 1)}


async def nothing() -> Message:
    return {"type": "http.request", "body": b"", "more_body": False}


async def ignore(message: Message) -> None:
    del message


def test_spectators_do_not_delay_operators() -> None:
    async def scenario() -> tuple[int, int]:
        working = {"spectator": 0, "operator": 0}

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            working[scope["state"]["role"]] += 1
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work, WorkSlots())
        tasks = [
            asyncio.ensure_future(app(scope(role, "a"), nothing, ignore))
            for role in ["spectator"] * 50 + ["operator"] * 2
        ]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return working["spectator"], working["operator"]

    assert asyncio.run(scenario()) == (READING, 2)


def test_questions_of_spectators_do_not_delay_what_spectators_read() -> None:
    async def scenario() -> dict[str, int]:
        working = {"question": 0, "read": 0}

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            working["question" if scope["method"] == "POST" else "read"] += 1
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work, WorkSlots())
        questions = [scope("spectator", str(n), "POST", policy=ASKED) for n in range(20)]
        tasks = [
            asyncio.ensure_future(app(request_scope, nothing, ignore))
            for request_scope in (*questions, scope("spectator", "a"))
        ]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return working

    assert asyncio.run(scenario()) == {"question": SINGLE.spectators.size, "read": 1}


def test_requests_do_not_delay_probes() -> None:
    """A probe with the address of a client that has many requests in progress is answered."""

    async def scenario() -> int:
        probed = 0

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            nonlocal probed
            probed += scope["path"] == "/readyz"
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work, WorkSlots())
        requests = [scope("spectator", "a") for _ in range(50)]
        requests += [scope("spectator", "a", path="/readyz", policy=PROBED) for _ in range(50)]
        tasks = [
            asyncio.ensure_future(app(request_scope, nothing, ignore)) for request_scope in requests
        ]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return probed

    assert asyncio.run(scenario()) == PROBE.spectators.size


def test_files_that_take_long_delay_nothing_else() -> None:
    async def scenario() -> dict[str, int]:
        working = {"file": 0, "command": 0, "read": 0}

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            kinds = {"/": "read", STOP: "command"}
            working[kinds.get(scope["path"], "file")] += 1
            await asyncio.Event().wait()

        app = ConcurrencyLimit(work, WorkSlots())
        paths = ["/api/v1/runs/x/mcap", "/api/v1/runs/x/page", "/api/v1/races/x/recording"]
        roles: list[Role] = ["spectator", "operator"]
        requests: list[Scope] = [
            scope(role, str(n), path=path, policy=FILE)
            for role in roles
            for n in range(10)
            for path in paths
        ]
        requests += [scope("spectator", "a"), scope("operator", "a", "POST", STOP)]
        tasks = [
            asyncio.ensure_future(app(request_scope, nothing, ignore)) for request_scope in requests
        ]
        await asyncio.sleep(0.01)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return working

    files = ENCODING.spectators.size + (ENCODING.operators or ENCODING.spectators).size
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

        app = ConcurrencyLimit(answer, WorkSlots())
        tasks = [
            asyncio.ensure_future(app(scope("spectator", client), never, stall))
            for client in ["stream", "unread"] * 10 * READING
        ]
        await asyncio.sleep(0.05)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return answered

    assert asyncio.run(scenario()) == 20 * READING


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

        app = ConcurrencyLimit(answer, WorkSlots())
        for _ in range(10 * READING):
            await asyncio.wait_for(app(scope("spectator", "a"), later, slowly), 1)

    asyncio.run(scenario())


@needs("experiments")
def test_each_kind_of_work_has_slots_of_its_own() -> None:
    kinds = {
        "/readyz": "probe",
        "/": "other",
        "/api/v1/runs": "other",
        "/api/v1/runs/{run_id}": "other",
        "/api/v1/races/{run_id}/recording": "download",
        "/api/v1/experiments/{run_id}/files/{name}": "download",
        "/api/v1/races/{run_id}/timeline": "analysis",
        "/api/v1/runs/{run_id}/replay/segments/{level}/{number}": "analysis",
        "/api/v1/robots": "other",
        "/api/v1/robots/{robot_id}": "analysis",
        "/api/v1/robots/{robot_id}/file": "analysis",
    }
    with temporary_store() as store:
        of_routes = policies(create_app(Settings(data=Path("unused")), store))

    def kind(role: str, method: str, path: str) -> str:
        return work_of(scope(role, "a", policy=of_routes[method, path])).name

    assert {path: kind("spectator", "get", path) for path in kinds} == kinds
    assert kind("operator", "post", "/api/v1/trainings/{run_id}/stop") == "other"
    assert kind("spectator", "post", "/api/v1/robots/preview") == "analysis"


def test_where_operators_have_no_slots_of_a_kind_theirs_is_other_work() -> None:
    assert work_of(scope("spectator", "a", policy=ASKED)) is SINGLE
    assert work_of(scope("operator", "a", policy=ASKED)) is OTHER


def test_nothing_is_begun_for_a_client_that_has_left() -> None:
    """Those that leave before their turn, also where the event loop has not noticed."""

    async def scenario() -> tuple[list[str], int]:
        begun: list[str] = []
        may_end = asyncio.Event()

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            begun.append(scope["client"][0])
            await may_end.wait()

        app, table = ConcurrencyLimit(work, WorkSlots()), ConnectionTable(100, 100)
        tasks, clients = [], []
        for address in ["first"] * READING + ["leaves"] * 5 + ["stays"]:
            client, server = socket.socketpair()
            connection = table.admit(address, server.fileno())
            request_scope = scope("spectator", address)
            request_scope["state"]["connection"] = connection
            tasks.append(asyncio.ensure_future(app(request_scope, nothing, ignore)))
            clients.append((client, server))
        await asyncio.sleep(0)
        for client, _ in clients[READING:-1]:
            client.close()
        may_end.set()
        await asyncio.wait_for(asyncio.gather(*tasks), 5)
        for pair in clients:
            for end in pair:
                end.close()
        return begun, len(tasks)

    begun, count = asyncio.run(scenario())
    assert begun == ["first"] * READING + ["stays"]
    assert count == READING + 6


def test_a_refused_request_gets_the_reason() -> None:
    async def scenario() -> list[Message]:
        answers: list[Message] = []

        async def work(scope: Scope, receive: Receive, send: Send) -> None:
            await asyncio.Event().wait()

        async def keep(message: Message) -> None:
            answers.append(message)

        slots = WorkSlots()
        app, request_scope = ConcurrencyLimit(work, slots), scope("spectator", "a")
        tasks = [
            asyncio.ensure_future(app(request_scope, nothing, ignore))
            for _ in range(READING + MAX_WAITING)
        ]
        await asyncio.sleep(0)
        await app(request_scope, nothing, keep)
        last = asyncio.ensure_future(app(scope("spectator", "b"), nothing, keep))
        await asyncio.sleep(0)
        slots.close()
        await asyncio.wait_for(last, 1)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        return answers

    full, why_full, stops, why_stops = asyncio.run(scenario())
    assert (full["status"], stops["status"]) == (429, 503)
    assert (b"retry-after", b"5") in full["headers"]
    assert b"try again in 5 s" in why_full["body"]
    assert b"The server is stopping" in why_stops["body"]
