"""Memory budget of request and response bodies, by role and by client.

A response is sent in chunks with back-pressure, and counts until its client has read it. A request
that would exceed the budget is refused with 429 or 503 rather than queued, since a queued body is
in memory too. A body over its own limit is refused with 413. Streams that generate their chunks one
by one hold little memory and are not limited.
"""

from typing import Literal

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.policy import policy_of
from app.api.problems import problem
from app.limits.addresses import client_of
from app.limits.memory_budget import MemoryBudget, Refusal
from app.stage.roles import Role
from app.storage.artifact_file import CHUNK_BYTES

MAX_BODY_BYTES = 1 << 20
MAX_FILE_BYTES = 64 << 20
ANSWERS_BYTES, ANSWERS_SHARE_BYTES = 64 << 20, 32 << 20
BODIES_BYTES, BODIES_SHARE_BYTES = 128 << 20, 96 << 20
_SMALL_BYTES = 64 << 10
"""Smaller bodies are not counted: the limit on connections bounds their number."""
_RETRY_AFTER_S = 5
_Refusal = Refusal | Literal["too large"]


class BodyMemoryLimit(HttpMiddleware):
    """Guard that limits and budgets bodies by role; to be installed inside `TokenGuard`."""

    def __init__(self, app: ASGIApp) -> None:
        """Wrap an app."""
        super().__init__(app)
        roles: tuple[Role, ...] = ("operator", "spectator")
        self._answers = {r: MemoryBudget(ANSWERS_BYTES, ANSWERS_SHARE_BYTES) for r in roles}
        self._bodies = {r: MemoryBudget(BODIES_BYTES, BODIES_SHARE_BYTES) for r in roles}

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or refuse with 413, 429 or 503."""
        role: Role = scope["state"]["role"]
        limit = MAX_FILE_BYTES if policy_of(scope).takes_file else MAX_BODY_BYTES
        length = Headers(scope=scope).get("content-length", "")
        if length.isdigit() and int(length[:18]) > limit:
            await _refusal_response("too large", limit)(scope, receive, send)
            return
        body = _RequestBody(receive, limit, self._bodies[role], client_of(scope))
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
            await _refusal_response(refusal, limit)(scope, receive, send)


class _RequestBody:
    """The request body, with its limit and its memory reservation."""

    def __init__(self, receive: Receive, limit: int, budget: MemoryBudget, client: str) -> None:
        self._receive, self._limit = receive, limit
        self._budget, self._client = budget, client
        self._received = self._held = 0
        self.refusal: _Refusal | None = None

    async def receive(self) -> Message:
        message = await self._receive()
        self._received += len(message.get("body", b""))
        if self._received > self._limit:
            self.refusal = "too large"
        elif self._received > _SMALL_BYTES:
            more = self._received - self._held
            self.refusal = self._budget.reserve(self._client, more)
            self._held += 0 if self.refusal else more
        # Simulate a disconnect for the app; `BodyMemoryLimit` sends the refusal.
        return message if self.refusal is None else {"type": "http.disconnect"}

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
        self.refusal: _Refusal | None = None
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


def _refusal_response(refusal: _Refusal, limit: int) -> ASGIApp:
    if refusal == "too large":
        return problem(413, f"The request's body may have at most {limit:,} bytes here.")
    headers = {"Retry-After": str(_RETRY_AFTER_S)}
    if refusal == "share":
        detail = "This address has too much to send or to read here at once; take it in turns."
        return problem(429, detail, headers=headers)
    detail = "The server holds as much for clients as it can; try again in a moment."
    return problem(503, detail, headers=headers)
