"""Who may call: by which names the server goes, and pages of which origins may use it.

A browser lets any page send requests to any address, with cookies for those of its own site, and
a name in a foreign DNS may point at this machine. So a request must call the server by a name
that is its own, and if it comes from a page, that page must be the server's own.
"""

import ipaddress
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.problems import problem
from app.settings import Settings, is_loopback


class HostGuard:
    """Refuses requests and websockets that call by a foreign name, or come from a foreign page."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        """Guard an app by what the settings let in.

        Always let in are loopback and IP literals, which no foreign DNS can give away.
        """
        self._app = app
        self._names = {*settings.allowed_hosts, settings.public_host} - {None}
        self._origins = {settings.public_origin} - {None}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is let in."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        trouble = self._trouble(headers.getlist("host"), headers.getlist("origin"))
        if trouble is None:
            await self._app(_without_origin(scope), receive, send)
        elif scope["type"] == "websocket":
            # Before it was accepted: the server answers 403.
            await send({"type": "websocket.close", "code": 1008, "reason": "foreign"})
        else:
            await problem(403, trouble)(scope, receive, send)

    def _trouble(self, hosts: list[str], origins: list[str]) -> str | None:
        host = _split(f"//{hosts[0]}") if len(hosts) == 1 else None
        if host is None or not self._is_ours(host[0]):
            return (
                "This server is not called by that Host; call it by localhost, by its IP address, "
                "or by a name in HEXAPODS_ALLOWED_HOSTS or HEXAPODS_PUBLIC_URL."
            )
        if not origins:
            return None
        if len(origins) == 1 and self._is_own_page(origins[0], host):
            return None
        return (
            "This request comes from a page of another origin; use this server's own page, or "
            "name the page's address in HEXAPODS_PUBLIC_URL or HEXAPODS_ALLOWED_HOSTS."
        )

    def _is_ours(self, name: str) -> bool:
        return name in self._names or _is_local_name(name) or _is_address(name)

    def _is_own_page(self, origin: str, host: tuple[str, int | None]) -> bool:
        if origin.lower() in self._origins:
            return True
        page = _split(origin) if origin.startswith(("http://", "https://")) else None
        if page is None:
            return False
        name, port = page
        standard = 443 if origin.startswith("https:") else 80
        if name == host[0] and (port or standard) == (host[1] or standard):
            return True
        if name in self._names:
            return True
        # Through a tunnel the same page has another port, or the other name of this machine.
        return _is_local(name) and _is_local(host[0])


def _without_origin(scope: Scope) -> Scope:
    """For websockets, whose endpoints would ask again and know less of what is let in."""
    if scope["type"] != "websocket":
        return scope
    return {**scope, "headers": [h for h in scope["headers"] if h[0].lower() != b"origin"]}


def _split(address: str) -> tuple[str, int | None] | None:
    """The name in lower case, and the port, of what has nothing but these; else None."""
    try:
        parts = urlsplit(address)
        name, port = parts.hostname, parts.port
    except ValueError:
        return None
    if not name or parts.username is not None or parts.path or parts.query or parts.fragment:
        return None
    return name.removesuffix("."), port


def _is_local_name(name: str) -> bool:
    return name == "localhost" or name.endswith(".localhost")


def _is_local(name: str) -> bool:
    return _is_local_name(name) or is_loopback(name)


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
