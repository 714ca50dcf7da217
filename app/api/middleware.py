"""The base of middleware that concerns HTTP alone, and the security headers of every response."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_OWN_FRAMES = "frame-ancestors 'self'"
"""Directive of all policies: whose pages may have a page in a frame."""
_CONTENT_POLICY = (
    "default-src 'none'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    f"base-uri 'none'; form-action 'self'; {_OWN_FRAMES}"
)


class HttpMiddleware(ABC):
    """ASGI middleware that lets the lifespan pass, and no other protocol than HTTP.

    Not Starlette's `BaseHTTPMiddleware`, which runs the app in a task of its own, and so hides a
    client's disconnect from it.
    """

    def __init__(self, app: ASGIApp) -> None:
        """Wrap an app."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app; by way of `handle` if this is an HTTP request.

        Raises:
            RuntimeError: if the server speaks a protocol, such as WebSocket, that no guard knows.
        """
        if scope["type"] not in ("http", "lifespan"):
            raise RuntimeError(f"the app answers HTTP alone, not {scope['type']}")
        await (self.handle if scope["type"] == "http" else self._app)(scope, receive, send)

    @abstractmethod
    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, usually by the app's answer."""


class SecurityHeaders(HttpMiddleware):
    """Middleware that adds security headers, unless the response sets its own.

    In every policy it adds the origins that may frame pages to those of the server's own pages.
    """

    def __init__(self, app: ASGIApp, frame_ancestors: Sequence[str] = ()) -> None:
        """Wrap an app.

        Args:
            app: the wrapped app.
            frame_ancestors: origins whose pages may have pages of the app in a frame.
        """
        super().__init__(app)
        self._frames = " ".join([_OWN_FRAMES, *frame_ancestors])

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, and add the headers to its response."""

        async def add(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("X-Content-Type-Options", "nosniff")
                if "Content-Security-Policy" not in headers and self._frames == _OWN_FRAMES:
                    # Browsers ignore it where a policy has `frame-ancestors`.
                    headers.setdefault("X-Frame-Options", "SAMEORIGIN")
                headers.setdefault("Referrer-Policy", "same-origin")
                headers.setdefault("Cross-Origin-Resource-Policy", "same-origin")
                content_policy = headers.setdefault("Content-Security-Policy", _CONTENT_POLICY)
                if self._frames != _OWN_FRAMES:
                    widened = content_policy.replace(_OWN_FRAMES, self._frames)
                    headers["Content-Security-Policy"] = widened
            await send(message)

        await self._app(scope, receive, add)
