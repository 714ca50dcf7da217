"""The path at which a proxy offers the server, such as `/hex` of `https://school.example/hex/`.

A proxy may strip the path from requests, or pass them on as they are: the app answers both. Inside
`PublicPath` the path of every request begins with the public path, which is its root path (ASGI):
routes match what follows it, and addresses made from the request begin with it.
"""

import re
from typing import Any

from starlette.responses import RedirectResponse
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from app.api.middleware import HttpMiddleware
from app.setting_checks import PUBLIC_PATH

_HEADER = b"x-forwarded-prefix"
_FORWARDED = "forwarded_path"


class ForwardedPath:
    """Middleware that believes the headers of trusted proxies, `X-Forwarded-Prefix` among them.

    Proxies that strip a path say by it which, such as Traefik and jupyter-server-proxy. A value
    that is no path as `HEXAPODS_PUBLIC_URL` may have is ignored.
    """

    def __init__(self, app: ASGIApp, trusted_hosts: list[str]) -> None:
        """Wrap an app.

        Args:
            app: the wrapped app.
            trusted_hosts: addresses and networks of the proxies.
        """
        untyped: Any = app  # uvicorn has types of its own for the same interface
        self._forwarded: Any = ProxyHeadersMiddleware(untyped, trusted_hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Store the path in the scope's state, and call the app as for the proxy's client."""
        client = scope.get("client")
        if scope["type"] == "http" and client and client[0] in self._forwarded.trusted_hosts:
            values = [value for name, value in scope["headers"] if name == _HEADER]
            path = values[0].decode("latin-1").rstrip("/") if len(values) == 1 else ""
            if re.fullmatch(PUBLIC_PATH, path):
                scope["state"] = {**scope.get("state", {}), _FORWARDED: path}
        await self._forwarded(scope, receive, send)


class PublicPath(HttpMiddleware):
    """Middleware that makes the public path the root path of a request."""

    def __init__(self, app: ASGIApp, path: str) -> None:
        """Wrap an app.

        Args:
            app: the wrapped app, with `StagePaths`.
            path: the public path, without a slash at its end; "" for that which a trusted proxy
                forwards, if any.
        """
        super().__init__(app)
        self._path = path

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or redirect from the public path without a slash at its end."""
        state = scope.setdefault("state", {})
        public_path = self._path or state.get(_FORWARDED, "")
        path: str = scope["path"]
        if public_path and path == public_path:
            query = scope["query_string"].decode("latin-1")
            # Relative, since the proxy's host may be another than that of the request.
            page = f"{path.rpartition('/')[2]}/{'?' if query else ''}{query}"
            await RedirectResponse(page)(scope, receive, send)
            return
        state["public_path"] = public_path
        scope["root_path"] = public_path
        if not path.startswith(f"{public_path}/"):
            scope["path"] = f"{public_path}{path}"
        await self._app(scope, receive, send)


def public_path_of(scope: Scope) -> str:
    """Return the public path of a request, without a slash at its end; "" outside `PublicPath`."""
    path: str = scope.get("state", {}).get("public_path", "")
    return path
