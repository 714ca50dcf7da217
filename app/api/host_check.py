"""Checks Host, Origin and Fetch metadata: names of this server, and pages that may use it.

A browser lets any page send requests to any address, with cookies for those of its own site, and
a name in a foreign DNS may point at this machine. So a request must call the server by a name
that is its own; if it comes from a page, that page must be the server's own, port included; and if
it changes something, it must be one that no form of another page could send.
"""

import ipaddress
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.problems import problem
from app.settings import Settings

_STANDARD_PORTS = {"http": 80, "https": 443}
_SAFE = frozenset({"GET", "HEAD", "OPTIONS"})
_OWN_SITES = frozenset({"same-origin", "none"})
_BROWSERS_SEND = ("origin", "cookie", "referer", "sec-fetch-site")
_FORMS_SEND = frozenset(
    {"", "application/x-www-form-urlencoded", "multipart/form-data", "text/plain"}
)
_FOREIGN_HOST = (
    "This server is not called by that Host; call it by localhost, by its IP address, or by a name "
    "in HEXAPODS_ALLOWED_HOSTS or HEXAPODS_PUBLIC_URL."
)
_FOREIGN_PAGE = (
    "This request comes from a page of another origin, which another port is too; use this "
    "server's own page, or name the page's address in HEXAPODS_PUBLIC_URL."
)
_LIKE_A_FORM = (
    "A form of another page could send this; add the header X-Requested-With, or send a body as "
    "application/json."
)


class HostGuard:
    """Refuses requests and websockets that call by a foreign name, or come from a foreign page."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        """Guard an app by what the settings let in.

        Always let in are loopback and IP literals, which no foreign DNS can give away.
        """
        self._app = app
        self._names = {*settings.allowed_hosts, settings.public_host} - {None}
        further = [
            f"{scheme}://{name}" for name in settings.allowed_hosts for scheme in _STANDARD_PORTS
        ]
        # For proxies that call by another Host than browsers do.
        self._origins = {_origin(one) for one in (*further, settings.public_origin or "")} - {None}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what is let in."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        trouble = self._trouble(scope.get("method", "GET"), Headers(scope=scope))
        if trouble is None:
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            # Before it was accepted: the server answers 403.
            await send({"type": "websocket.close", "code": 1008, "reason": "foreign"})
        else:
            await problem(403, trouble)(scope, receive, send)

    def _trouble(self, method: str, headers: Headers) -> str | None:
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        host = _split(f"//{hosts[0]}") if len(hosts) == 1 else None
        if host is None or not self._is_ours(host[0]):
            return _FOREIGN_HOST
        if origins and not (len(origins) == 1 and self._is_own_page(origins[0], host)):
            return _FOREIGN_PAGE
        if not _OWN_SITES.issuperset(headers.getlist("sec-fetch-site")) and not (
            method in _SAFE and _is_followed_link(headers)
        ):
            return _FOREIGN_PAGE
        if method not in _SAFE and _could_be_a_form(headers):
            return _LIKE_A_FORM
        return None

    def _is_ours(self, name: str) -> bool:
        return name in self._names or _is_local_name(name) or _is_address(name)

    def _is_own_page(self, origin: str, host: tuple[str, int | None]) -> bool:
        page = _origin(origin)
        if page is None:
            return False
        return page in self._origins or page[1:] == (host[0], host[1] or _STANDARD_PORTS[page[0]])


def _is_followed_link(headers: Headers) -> bool:
    """Whether someone went to the page by a link, rather than another page having fetched it."""
    return (
        headers.getlist("sec-fetch-mode") == ["navigate"]
        and headers.getlist("sec-fetch-dest") == ["document"]
        and "origin" not in headers
    )


def _could_be_a_form(headers: Headers) -> bool:
    """Whether a browser would send this for a foreign page without asking the server first.

    Other programs than browsers, which act for nobody but their user, are let alone.
    """
    if not any(name in headers for name in _BROWSERS_SEND):
        return False
    if "x-requested-with" in headers or "authorization" in headers:
        return False
    types = headers.getlist("content-type") or [""]
    return any(one.partition(";")[0].strip().lower() in _FORMS_SEND for one in types)


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


def _origin(text: str) -> tuple[str, str, int] | None:
    """Scheme, name and port of an origin of HTTP; None for any other."""
    scheme, _, rest = text.lower().partition("://")
    address = _split(f"//{rest}") if scheme in _STANDARD_PORTS else None
    return None if address is None else (scheme, address[0], address[1] or _STANDARD_PORTS[scheme])


def _is_local_name(name: str) -> bool:
    return name == "localhost" or name.endswith(".localhost")


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
