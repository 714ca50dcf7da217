"""Records how the guards treat each operation: every route × role × stage, on the real app.

`recorded` sends each request through the app's whole stack up to its route, which does not run: a
request that reaches it has passed the guards. `policy_table.json` has what came of it. Write it
anew after a change that is meant, and read the difference:

    python -m tests.api.policy_table
"""

import asyncio
import json
import re
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple
from unittest.mock import patch

from fastapi import FastAPI
from fastapi.routing import APIRoute, iter_route_contexts
from starlette.responses import JSONResponse
from starlette.routing import Mount, Route
from starlette.types import Message, Receive, Scope, Send

from app.api import memory_limit
from app.api.concurrency_limit import WorkSlots
from app.api.cookies import NAME
from app.api.deps import Services
from app.api.policy import work_of
from app.api.work import PROBE
from app.features.classroom.access import ROOM_NAME
from app.features.classroom.lesson import read_lesson
from app.features.classroom.room_rows import RoomRows, RoomRun
from app.features.classroom.room_stages import RoomStages
from app.features.classroom.rooms import Rooms
from app.features.demo.access import VISITOR_NAME
from app.features.demo.rows import VisitorRows, VisitorRun
from app.features.demo.settings import DemoSettings
from app.features.demo.visitors import _sha256
from app.features.tournaments.tournaments import Tournaments
from app.features.what_if.settings import WhatIfSettings
from app.limits.fair_semaphore import FairSemaphore
from app.limits.token_bucket import RateLimiter
from app.server import create_app
from app.settings import Settings
from hexapods.tournaments.rules import TournamentRules
from tests.storage.stores import temporary_store, training

TABLE = Path(__file__).with_name("policy_table.json")
TOKEN = "a-token-for-tests"
CARDS: dict[str, dict[str, Any]] = {
    "predict": {"text": "a", "ask": {"kind": "number", "text": "How far?"}},
    "run": {"text": "b", "state": {"form": {"steps": 20}}, "go": "training"},
    "what-if": {"text": "c", "state": {"form": {"steps": 20}}, "go": "what-if"},
    "nothing": {"text": "d"},
}
"""By what a card allows, the card."""
SERVERS: dict[str, dict[str, Any]] = {
    "no token": {},
    "public": {"token": TOKEN},
    "token-only": {"token": TOKEN, "spectators": "token"},
    "demo": {"token": TOKEN},
}
WITH_PREFIX = {"token-only", "demo"}
"""Servers of which the routes of a room's stage are tried, too."""
STARTS, WHAT_IFS = 1_000_003, 1_000_033
"""Sizes of the limiters, by which they are told apart."""
FURTHER: list[tuple[str, str]] = [
    ("GET", "/nothing"),
    ("POST", "/nothing"),
    ("PUT", "/nothing"),
    ("MKCOL", "/nothing"),
    ("GET", "/api/v1/trainings/"),
    ("POST", "/api/v1/what-if/"),
    ("PUT", "/api/v1/what-if"),
    ("OPTIONS", "/api/v1/trainings"),
    ("GET", "/api/v1/trainings/{run_id}/stop"),
    ("GET", "/api/v1/runs/{run_id}/nothing"),
    ("PUT", "/api/v1/runs/{run_id}"),
    ("GET", "/api/v1/rooms/{code}/predictions"),
    ("GET", "/api/v1/rooms/{code}/nothing"),
    ("POST", "/static/favicon.svg"),
    ("GET", "/static"),
    ("DELETE", "/healthz"),
    ("POST", "/"),
    ("GET", "/?token=wrong"),
    ("GET", f"/?token={TOKEN}"),
    ("GET", "/docs?token=wrong"),
]
"""Requests besides those of the routes: paths and methods without a route, and queries."""


class Role(NamedTuple):
    """Sender of a request: its headers, the run that it names, and the card that the room shows.

    Attributes:
        headers: that are sent.
        run: id of the run in the path, or else in the query.
        card: that the first room shows.
    """

    headers: dict[str, str]
    run: str
    card: str = "nothing"


class Outcome(NamedTuple):
    """Outcome of the guards for a request; `said` is the sentence of a refusal."""

    status: str
    said: str


def recorded() -> dict[str, Any]:
    """Return the table: by operation, its outcomes, each with the cases in which it is.

    Cases are grouped: a group has a line for each server, of the roles; `*` of one means on the
    first stage as on that of a room, and `@room` on the latter alone.
    """
    cases: dict[str, dict[Outcome, list[str]]] = defaultdict(lambda: defaultdict(list))
    for server, settings in SERVERS.items():
        with TemporaryDirectory() as folder, temporary_store() as store, _recorder():
            rooms = Rooms(store)
            lesson = read_lesson({"title": "x", "cards": list(CARDS.values())})
            room, other = (rooms.create(lesson).code for _ in range(2))
            keys = [rooms.join(room).key, rooms.join(room).key, rooms.join(other).key]
            for run_id in ("own", "hidden", "mine", "strange", "operators"):
                store.create(training(run_id, state="finished"))
            now = datetime.now(UTC)
            for run_id, seed in (("own", 0), ("hidden", 1)):
                run = RoomRun(run_id, room, seed, 1, {}, True, False, now)
                RoomRows(store.database).add_runs([run])
            VisitorRows(store.database).add(
                [
                    VisitorRun("mine", _sha256("visitor"), 1, True, now),
                    VisitorRun("strange", _sha256("another"), 1, True, now),
                ]
            )
            app = create_app(
                Settings(
                    data=Path(folder),
                    starts_per_minute=STARTS,
                    features=(
                        WhatIfSettings(what_ifs_per_minute=WHAT_IFS),
                        DemoSettings(demo=server == "demo"),
                    ),
                    **settings,
                ),
                store,
            )
            services: Services = app.state.services
            session = services.stages[0].roles.open_session()
            rules = TournamentRules(gait="left-right-origin", simulator="kinematic", draws=5)
            tournament = services.of(Tournaments).create(rules, "", room, 6).id
            fill = {"code": room, "tournament_id": tournament}
            asyncio.run(
                _record_server(app, server, _roles(server, session, room, other, keys), fill, cases)
            )
    return _as_table(cases)


def _roles(server: str, session: str, room: str, other: str, keys: list[str]) -> dict[str, Role]:
    participant = {"cookie": f"{ROOM_NAME}_8000_{room}={keys[0]}"}
    elsewhere = {"cookie": f"{ROOM_NAME}_8000_{other}={keys[2]}"}
    roles = {
        "stranger": Role({}, "operators"),
        "stranger, hidden run": Role({}, "hidden"),
        "participant": Role(participant, "own", "what-if"),
    }
    if server == "token-only":
        roles |= {
            "participant of another room": Role(elsewhere, "operators"),
            "participant, another's run": Role(participant, "hidden"),
            "participant, operator's run": Role(participant, "operators"),
            **{f"participant, card {card}": Role(participant, "own", card) for card in CARDS},
        }
    if server != "no token":
        bearer = {"authorization": f"Bearer {TOKEN}"}
        roles |= {
            "operator": Role(bearer, "hidden"),
            "operator by cookie": Role({"cookie": f"{NAME}_8000={session}"}, "operators"),
            "operator with a seat": Role({**bearer, **participant}, "hidden"),
            "wrong token": Role({"authorization": "Bearer wrong"}, "operators"),
            "wrong cookie": Role({"cookie": f"{NAME}_8000=wrong"}, "operators"),
        }
    if server == "demo":
        visitor = {"cookie": f"{VISITOR_NAME}_8000=visitor"}
        roles |= {
            "visitor, own run": Role(visitor, "mine"),
            "visitor, another's run": Role(visitor, "strange"),
            "visitor, own run, forged cookie": Role({"cookie": f"{VISITOR_NAME}_8000=x"}, "mine"),
        }
    return roles


async def _record_server(
    app: FastAPI,
    server: str,
    roles: dict[str, Role],
    fill: dict[str, str],
    cases: dict[str, dict[Outcome, list[str]]],
) -> None:
    services: Services = app.state.services
    await services.of(RoomStages).open(services.of(Rooms).get(fill["code"]))
    if services.stages[0].roles.needs_token:
        session = services.stages[-1].roles.open_session()
        cookie = {"cookie": f"{NAME}_8000_r_{fill['code']}={session}"}
        roles = {**roles, "operator by the room's cookie": Role(cookie, "operators")}
    try:
        for name, role in roles.items():
            services.of(Rooms).show_card(fill["code"], list(CARDS).index(role.card))
            for prefix in ("", f"/r/{fill['code']}") if server in WITH_PREFIX else ("",):
                for operation in operations(app):
                    outcome = await _send(app, operation, prefix, role, fill)
                    where = "room" if prefix else ""
                    cases[" ".join(operation)][outcome].append(f"{server}: {name} @{where}")
    finally:
        await services.of(RoomStages).close_all()


def operations(app: FastAPI) -> list[tuple[str, str]]:
    """Return method and path of every route, and of `FURTHER`."""
    routes: list[tuple[str, str]] = []
    for context in iter_route_contexts(app.routes):
        path = re.sub(":(path|robot)", "", context.path or "/")
        if path == "/static":
            routes.append(("GET", "/static/favicon.svg"))
        else:
            routes += [(method, path) for method in sorted(set(context.methods or ()) - {"HEAD"})]
    return routes + FURTHER


async def _send(
    app: FastAPI, operation: tuple[str, str], prefix: str, role: Role, fill: dict[str, str]
) -> Outcome:
    """Send a request, and return what came of it."""
    method, address = operation
    path, _, query = address.partition("?")
    if "{run_id}" not in path and not query:
        query = f"id={role.run}"
    values = {"lesson_id": "one-run-proves-nothing", "seed": "0", "level": "0", "number": "1"}
    values |= {
        "robot_id": "0123456789abcdef",
        "step": "1",
        "name": "page",
        "run_id": role.run,
        **fill,
    }
    filled = prefix + re.sub(r"\{(\w+)\}", lambda match: values.get(match[1], "x"), path)
    headers = {"host": "127.0.0.1:8000", "x-requested-with": "x", **role.headers}
    scope: Scope = {
        "type": "http",
        "path": filled,
        "raw_path": filled.encode(),
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
        "client": ("127.0.0.1", 1),
        "server": ("127.0.0.1", 8000),
        "scheme": "http",
        "http_version": "1.1",
        "state": {},
        "method": method,
    }
    sent: list[Message] = []
    _notes.clear()

    async def receive() -> Message:
        return {"type": "http.request", "body": b""}

    async def send(message: Message) -> None:
        sent.append(message)

    await app(scope, receive, send)
    status, said = _answer(sent)
    # In the order of their names: a guard that comes before another one decides the same.
    notes = " ".join(sorted(dict.fromkeys(_notes)))
    for secret, name in ((fill["tournament_id"], "TOURNAMENT"), (fill["code"], "CODE")):
        said = said.replace(secret, name)
    said = re.sub(r"\b(room |rooms/)(?!CODE)[A-Z0-9]{4,}", r"\1OTHER", said)
    return Outcome(f"{status} {notes}".strip(), re.sub(r"(nothing at /)[^;]*", r"\1…", said))


def _answer(sent: list[Message]) -> tuple[str, str]:
    start = sent[0]
    headers = {name.decode(): value.decode() for name, value in start["headers"]}
    cookie = " expires a cookie" if "Max-Age=0" in headers.get("set-cookie", "") else ""
    body = b"".join(message.get("body", b"") for message in sent[1:])
    if start["status"] == PASSED:
        return f"passed{cookie}", json.loads(body)
    if headers.get("content-type") == "application/problem+json":
        return f"{start['status']}{cookie}", json.loads(body)["detail"]
    return f"{start['status']}{cookie}", headers.get("location", "")


PASSED = 299
_notes: list[str] = []
"""What limiters, slots and bodies have noted of the request that is sent."""


@contextmanager
def _recorder() -> Iterator[None]:
    """Replace routes by ones that answer at once, and limits by recorders that refuse nothing."""
    take, acquire = RateLimiter.take, FairSemaphore.acquire
    request_body = memory_limit._RequestBody.__init__  # noqa: SLF001

    def noting_take(limiter: RateLimiter, client: str) -> float:
        names = {STARTS: "start", WHAT_IFS: "what-if-token", 20: "guess"}
        _notes.append(names[limiter._size])  # noqa: SLF001
        take(limiter, client)
        return 0.0

    async def noting_acquire(semaphore: FairSemaphore, *args: Any, **more: Any) -> None:
        _notes.append(f"slot:{_slot_names.get(id(semaphore), '?')}")
        await acquire(semaphore, *args, **more)

    def noting_body(body: Any, receive: Receive, limit: int, budget: Any, client: str) -> None:
        _notes.append(f"body:{limit >> 20}MiB")
        request_body(body, receive, limit, budget, client)

    with ExitStack() as stack:
        for changed, name, replacement in (
            (RateLimiter, "take", noting_take),
            (FairSemaphore, "acquire", noting_acquire),
            (memory_limit._RequestBody, "__init__", noting_body),  # noqa: SLF001
            (APIRoute, "handle", _handle),
            (Route, "handle", _handle),
            (Mount, "handle", _handle),
        ):
            stack.enter_context(patch.object(changed, name, replacement))
        stack.enter_context(patch("app.server.WorkSlots", _NamedSlots))
        yield


_slot_names: dict[int, str] = {}


class _NamedSlots(WorkSlots):
    """Slots whose names are known."""

    def of(self, scope: Scope) -> FairSemaphore:
        semaphore = super().of(scope)
        work = work_of(scope)
        name = "probe" if work is PROBE else f"{scope['state']['role']}/{work.name}"
        _slot_names[id(semaphore)] = name
        return semaphore


async def _handle(route: Any, scope: Scope, receive: Receive, send: Send) -> None:
    methods = getattr(route, "methods", None)
    status = 405 if methods and scope["method"] not in methods else PASSED
    await JSONResponse("", status)(scope, receive, send)


def _as_table(cases: dict[str, dict[Outcome, list[str]]]) -> dict[str, Any]:
    """Return the table as JSON: sentences are numbered, since many refusals say the same."""
    sentences = sorted({outcome.said for outcomes in cases.values() for outcome in outcomes} - {""})
    numbers = {sentence: number for number, sentence in enumerate(sentences)}
    table = {
        operation: {
            f"{outcome.status} [{numbers[outcome.said]}]" if outcome.said else outcome.status: who
            for outcome, who in outcomes.items()
        }
        for operation, outcomes in cases.items()
    }
    joined = _joined(table)
    groups = sorted({who for outcomes in joined.values() for who in outcomes.values()})
    group_names = {group: f"group {number}" for number, group in enumerate(groups)}
    return {
        "sentences": sentences,
        "groups": {name: group.split("; ") for group, name in group_names.items()},
        "operations": {
            operation: {outcome: group_names[who] for outcome, who in outcomes.items()}
            for operation, outcomes in joined.items()
        },
    }


def _joined(table: dict[str, dict[str, list[str]]]) -> dict[str, dict[str, str]]:
    """Return the cases of each outcome in one line: by server, the roles; `*` in rooms alike."""
    joined: dict[str, dict[str, str]] = {}
    for operation, outcomes in table.items():
        joined[operation] = {}
        for outcome, who in outcomes.items():
            by_server: dict[str, list[str]] = defaultdict(list)
            for case in who:
                server, _, role = case.partition(": ")
                name, _, where = role.partition(" @")
                if not where and (f"{case}room" in who or server not in WITH_PREFIX):
                    by_server[server].append(f"{name}*")
                elif not (where and case.removesuffix("room") in who):
                    by_server[server].append(f"{name} @room" if where else name)
            joined[operation][outcome] = "; ".join(
                f"{server}: {' | '.join(names)}" for server, names in by_server.items()
            )
    return joined


def main() -> None:
    """Write the table."""
    TABLE.write_text(json.dumps(recorded(), indent=1, ensure_ascii=False) + "\n", "utf-8")


if __name__ == "__main__":
    main()
