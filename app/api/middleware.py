"""The base of middleware that concerns HTTP alone."""

from abc import ABC, abstractmethod

from starlette.types import ASGIApp, Receive, Scope, Send


class HttpMiddleware(ABC):
    """ASGI middleware that lets websockets and the lifespan pass.

    Not Starlette's `BaseHTTPMiddleware`, which runs the app in a task of its own, and so hides a
    client's disconnect from it.
    """

    def __init__(self, app: ASGIApp) -> None:
        """Wrap an app."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app; by way of `handle` if this is an HTTP request."""
        await (self.handle if scope["type"] == "http" else self._app)(scope, receive, send)

    @abstractmethod
    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, usually by the app's answer."""
