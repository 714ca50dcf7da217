"""Set security headers on each answer, and limit how much a request may send."""

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.problems import problem

MAX_BODY_BYTES = 1 << 20
MAX_TABLE_BYTES = 64 << 20
IMPORT_PATH = "/api/v1/trainings/import"
ARCHIVE_PATH = "/api/v1/import"

_CONTENT_POLICY = (
    "default-src 'none'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "base-uri 'none'; form-action 'self'; frame-ancestors 'self'"
)


class TooLarge(Exception):
    """A body went over its limit while it was read."""


class BodyLimit:
    """Refuses a body that is too large from its length, or else as soon as it goes over."""

    def __init__(self, app: ASGIApp) -> None:
        """Limit what an app is sent."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Count what is received."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = MAX_TABLE_BYTES if scope["path"] in (IMPORT_PATH, ARCHIVE_PATH) else MAX_BODY_BYTES
        refusal = problem(413, f"The request's body may have at most {limit:,} bytes here.")
        length = Headers(scope=scope).get("content-length", "")
        if length.isdigit() and int(length[:18]) > limit:
            await refusal(scope, receive, send)
            return
        received, refused = 0, False

        async def counted() -> Message:
            nonlocal received, refused
            message = await receive()
            received += len(message.get("body", b""))
            if received > limit:
                refused = True
                # For the app it is as if the sender had left; the answer is given below.
                return {"type": "http.disconnect"}
            return message

        async def unless_refused(message: Message) -> None:
            if not refused:
                await send(message)

        try:
            await self._app(scope, counted, unless_refused)
        except Exception:
            if not refused:
                raise
        if refused:
            await refusal(scope, receive, send)


class SecurityHeaders:
    """Adds to every answer what browsers should know; a page may have said it more strictly."""

    def __init__(self, app: ASGIApp) -> None:
        """Add headers to what an app answers."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on, and add."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def add(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("X-Content-Type-Options", "nosniff")
                headers.setdefault("X-Frame-Options", "SAMEORIGIN")
                headers.setdefault("Referrer-Policy", "same-origin")
                headers.setdefault("Cross-Origin-Resource-Policy", "same-origin")
                headers.setdefault("Content-Security-Policy", _CONTENT_POLICY)
            await send(message)

        await self._app(scope, receive, add)
