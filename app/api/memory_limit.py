"""Memory budget of request and response bodies, by role and by client.

A response is sent in chunks with back-pressure, and counts until its client has read it. A request
that would exceed the budget is refused with 429 or 503 rather than queued, since a queued body is
in memory too. A body over its own limit is refused with 413. Streams that generate their chunks one
by one hold little memory and are not limited.
"""

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.problems import problem
from app.api.stage_paths import path_of
from app.limits.addresses import client_of
from app.limits.memory_budget import MemoryBudget, Refusal
from app.stage.roles import Role
from app.storage.artifact_file import CHUNK_BYTES

MAX_BODY_BYTES = 1 << 20
MAX_FILE_BYTES = 64 << 20
_FILE_ROUTES = ("/api/v1/trainings/import", "/api/v1/import", "/api/v1/runs/import")
ANSWERS_BYTES, ANSWERS_SHARE_BYTES = 64 << 20, 32 << 20
BODIES_BYTES, BODIES_SHARE_BYTES = 128 << 20, 96 << 20
_SMALL_BYTES = 64 << 10
"""Smaller bodies are not counted: the limit on connections bounds their number."""
_RETRY_AFTER_S = 5


class BodyLimit(HttpMiddleware):
    """Middleware that refuses a large body by its Content-Length, or once it exceeds the limit."""

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app with a counting `receive`; refuse with 413."""
        limit = MAX_FILE_BYTES if path_of(scope) in _FILE_ROUTES else MAX_BODY_BYTES
        refusal = problem(413, f"The request's body may have at most {limit:,} bytes here.")
        length = Headers(scope=scope).get("content-length", "")
        if length.isdigit() and int(length[:18]) > limit:
            await refusal(scope, receive, send)
            return
        received, refused = 0, False

        async def receive_counted() -> Message:
            nonlocal received, refused
            message = await receive()
            received += len(message.get("body", b""))
            if received > limit:
                refused = True
                # Simulate a disconnect for the app; the refusal is sent below.
                return {"type": "http.disconnect"}
            return message

        async def send_unless_refused(message: Message) -> None:
            if not refused:
                await send(message)

        try:
            await self._app(scope, receive_counted, send_unless_refused)
        except Exception:
            if not refused:
                raise
        if refused:
            await refusal(scope, receive, send)


class HeldBodies(HttpMiddleware):
    """Middleware that budgets large bodies by role; to be installed inside `TokenGuard`."""

    def __init__(self, app: ASGIApp) -> None:
        """Wrap an app."""
        super().__init__(app)
        roles: tuple[Role, ...] = ("operator", "spectator")
        self._answers = {r: MemoryBudget(ANSWERS_BYTES, ANSWERS_SHARE_BYTES) for r in roles}
        self._bodies = {r: MemoryBudget(BODIES_BYTES, BODIES_SHARE_BYTES) for r in roles}

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or refuse with 429 or 503."""
        role: Role = scope["state"]["role"]
        body = _RequestBody(receive, self._bodies[role], client_of(scope))
        answer = _Response(send, self._answers[role], client_of(scope), body)
        try:
            await self._app(scope, body.receive, answer.send)
        except Exception:
            if body.refusal is None:
                raise
        finally:
            body.release()
        refusal = body.refusal or answer.refusal
        if refusal is not None and not answer.is_started:
            await _refusal_response(refusal)(scope, receive, send)


class _RequestBody:
    """The request body, with its memory reservation."""

    def __init__(self, receive: Receive, budget: MemoryBudget, client: str) -> None:
        self._receive, self._budget, self._client = receive, budget, client
        self._received = self._held = 0
        self.refusal: Refusal | None = None

    async def receive(self) -> Message:
        message = await self._receive()
        self._received += len(message.get("body", b""))
        if self._received > _SMALL_BYTES:
            more = self._received - self._held
            self.refusal = self._budget.reserve(self._client, more)
            if self.refusal is not None:
                # Simulate a disconnect for the app; `HeldBodies` sends the refusal.
                return {"type": "http.disconnect"}
            self._held += more
        return message

    def release(self) -> None:
        if self._held:
            self._budget.release(self._client, self._held)


class _Response:
    """The response; its start is held back until its first chunk has a reservation."""

    def __init__(
        self, send: Send, budget: MemoryBudget, client: str, request_body: _RequestBody
    ) -> None:
        self._send, self._request_body = send, request_body
        self._budget, self._client = budget, client
        self._start: Message | None = None
        self.refusal: Refusal | None = None
        self.is_started = False

    async def send(self, message: Message) -> None:
        if (self.refusal or self._request_body.refusal) and not self.is_started:
            return
        if message["type"] == "http.response.start":
            self._start = message
        elif message["type"] != "http.response.body":
            await self._send_start()
            await self._send(message)
        else:
            await self._send_body(message)

    async def _send_start(self) -> None:
        start, self._start = self._start, None
        self.is_started = True
        if start is not None:
            await self._send(start)

    async def _send_body(self, message: Message) -> None:
        body: bytes = message.get("body", b"")
        if len(body) <= _SMALL_BYTES:
            await self._send_start()
            await self._send(message)
            return
        refusal = self._budget.reserve(self._client, len(body))
        if refusal is not None and not self.is_started:
            self.refusal = refusal
            return
        try:
            await self._send_start()
            view = memoryview(body)
            for offset in range(0, len(view), CHUNK_BYTES):
                is_last = offset + CHUNK_BYTES >= len(view)
                more = bool(message.get("more_body", False)) or not is_last
                piece = bytes(view[offset : offset + CHUNK_BYTES])
                await self._send({**message, "body": piece, "more_body": more})
        finally:
            if refusal is None:
                self._budget.release(self._client, len(body))


def _refusal_response(refusal: Refusal) -> ASGIApp:
    headers = {"Retry-After": str(_RETRY_AFTER_S)}
    if refusal == "share":
        detail = "This address has too much to send or to read here at once; take it in turns."
        return problem(429, detail, headers=headers)
    detail = "The server holds as much for clients as it can; try again in a moment."
    return problem(503, detail, headers=headers)
