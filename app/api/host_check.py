"""Checks Host, Origin and Fetch metadata, against DNS rebinding and cross-site request forgery.

A browser lets any page send requests to any address, with cookies for those of its own site, and
a foreign DNS name may resolve to this machine (DNS rebinding). So the Host must be a name of this
server; the Origin, if any, must be the server's own, port included; and a request that changes
something must be one that a form of another page could not send without a CORS preflight.
"""

import ipaddress
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.problems import problem
from app.settings import Settings

_STANDARD_PORTS = {"http": 80, "https": 443}
_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})
_OWN_SITES = frozenset({"same-origin", "none"})
_BROWSER_HEADERS = ("origin", "cookie", "referer", "sec-fetch-site")
_FORM_TYPES = frozenset(
    {"", "application/x-www-form-urlencoded", "multipart/form-data", "text/plain"}
)
_FOREIGN_HOST = (
    "This server is not called by that Host; call it by localhost, by its IP address, or by a name "
    "in HEXAPODS_ALLOWED_HOSTS or HEXAPODS_PUBLIC_URL."
)
_FOREIGN_PAGE = (
    "This request comes from a page of another origin, which another port is too; use this "
    "server's own page, or name the page's address in HEXAPODS_PUBLIC_URL, or in "
    "HEXAPODS_CORS_ORIGINS."
)
_FORM_REQUEST = (
    "A form of another page could send this; add the header X-Requested-With, or send a body as "
    "application/json."
)


class HostGuard(HttpMiddleware):
    """Middleware that refuses requests with a foreign Host or Origin."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        """Wrap an app; the settings list allowed hosts, the public URL, and who frames pages.

        Loopback names and IP literals are always allowed: DNS rebinding cannot use them.
        """
        super().__init__(app)
        self._is_framed = bool(settings.frame_ancestors)
        self._names = {*settings.allowed_hosts, settings.public_host} - {None}
        allowed_origins = [
            f"{scheme}://{name}" for name in settings.allowed_hosts for scheme in _STANDARD_PORTS
        ]
        # For proxies that change the Host which browsers send.
        self._origins = {
            _origin(origin) for origin in (*allowed_origins, settings.public_origin or "")
        } - {None}
        self._cors_origins = frozenset(settings.cors_origins)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or refuse with 403."""
        headers = Headers(scope=scope)
        if is_cors := self._is_of_cors(headers):
            # A script of another page acts by the token that it has, never by the cookie of a
            # person whose browser runs it.
            scope = {**scope, "state": {**scope["state"], "cookies": {}}}
        refusal = self._refusal(scope["method"], headers, is_cors=is_cors)
        answer = self._app if refusal is None else problem(403, refusal, kind="foreign-request")
        await answer(scope, receive, send)

    def _is_of_cors(self, headers: Headers) -> bool:
        """Whether a request comes from a script of a page of the origins in `cors_origins`."""
        origins, host = headers.getlist("origin"), _host(headers)
        if len(origins) != 1 or origins[0].lower() not in self._cors_origins:
            return False
        return host is not None and not self._is_own_page(origins[0], host)

    def _refusal(self, method: str, headers: Headers, *, is_cors: bool) -> str | None:
        origins, host = headers.getlist("origin"), _host(headers)
        if host is None or not self._is_own_host(host[0]):
            return _FOREIGN_HOST
        if not is_cors and (why := self._refusal_of_page(method, headers, origins, host)):
            return why
        if method not in _SAFE_METHODS and _is_form_request(headers):
            return _FORM_REQUEST
        return None

    def _refusal_of_page(
        self, method: str, headers: Headers, origins: list[str], host: tuple[str, int | None]
    ) -> str | None:
        if origins and not (len(origins) == 1 and self._is_own_page(origins[0], host)):
            return _FOREIGN_PAGE
        if not _OWN_SITES.issuperset(headers.getlist("sec-fetch-site")) and not (
            method in _SAFE_METHODS and self._is_navigation(headers)
        ):
            return _FOREIGN_PAGE
        return None

    def _is_navigation(self, headers: Headers) -> bool:
        """Whether the request opens a page, such as by a followed link, and is no fetch.

        A page in a frame is one only where other origins may frame pages; which, its policy says.
        """
        destinations = headers.getlist("sec-fetch-dest")
        return (
            headers.getlist("sec-fetch-mode") == ["navigate"]
            and (destinations == ["document"] or (self._is_framed and destinations == ["iframe"]))
            and "origin" not in headers
        )

    def _is_own_host(self, name: str) -> bool:
        return name in self._names or _is_local_name(name) or _is_ip_address(name)

    def _is_own_page(self, origin: str, host: tuple[str, int | None]) -> bool:
        page = _origin(origin)
        if page is None:
            return False
        return page in self._origins or page[1:] == (host[0], host[1] or _STANDARD_PORTS[page[0]])


def _is_form_request(headers: Headers) -> bool:
    """Whether a browser would send this for a foreign page without a CORS preflight.

    False for other programs than browsers, which foreign pages cannot control.
    """
    if not any(name in headers for name in _BROWSER_HEADERS):
        return False
    if "x-requested-with" in headers or "authorization" in headers:
        return False
    types = headers.getlist("content-type") or [""]
    return any(media_type.partition(";")[0].strip().lower() in _FORM_TYPES for media_type in types)


def _host(headers: Headers) -> tuple[str, int | None] | None:
    """Return the name and the port of the server by a request's Host; None for any but one."""
    hosts = headers.getlist("host")
    return _split(f"//{hosts[0]}") if len(hosts) == 1 else None


def _split(address: str) -> tuple[str, int | None] | None:
    """Return the lower-case host name and the port of a bare authority; None for anything else."""
    try:
        parts = urlsplit(address)
        name, port = parts.hostname, parts.port
    except ValueError:
        return None
    if not name or parts.username is not None or parts.path or parts.query or parts.fragment:
        return None
    return name.removesuffix("."), port


def _origin(text: str) -> tuple[str, str, int] | None:
    """Parse an HTTP origin as (scheme, host name, port); None for any other."""
    scheme, _, rest = text.lower().partition("://")
    address = _split(f"//{rest}") if scheme in _STANDARD_PORTS else None
    return None if address is None else (scheme, address[0], address[1] or _STANDARD_PORTS[scheme])


def _is_local_name(name: str) -> bool:
    return name == "localhost" or name.endswith(".localhost")


def _is_ip_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
