"""Session cookies of operators, and of clients whom features identify."""

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from starlette.datastructures import Headers
from starlette.types import Scope

from app.api.public_path import public_path_of
from app.settings import Settings
from app.storage.sessions import SESSION_S

NAME = "hexapods_operator"
_NOT_IN_NAME = re.compile(r"[^A-Za-z0-9]")


class CookieRules(NamedTuple):
    """When browsers store and send a cookie.

    Attributes:
        is_secure: whether browsers reach the server over HTTPS.
        is_framed: whether pages of other sites may have the server's in a frame, where its cookies
            are a third party's.
    """

    is_secure: bool
    is_framed: bool = False

    @property
    def attributes(self) -> str:
        """The attributes of a `Set-Cookie` header: in frames, a cookie for each site around it."""
        if not self.is_secure:
            return "SameSite=Strict"  # without `Secure`, browsers refuse `SameSite=None`
        return "SameSite=None; Secure; Partitioned" if self.is_framed else "SameSite=Strict; Secure"


def cookie_rules(scope: Scope, settings: Settings) -> CookieRules:
    """Return the rules of the cookies for a client, who calls the server itself or by its proxy."""
    is_secure = scope["scheme"] == "https" or settings.has_https
    return CookieRules(is_secure, is_framed=bool(settings.frame_ancestors))


_BEGINNINGS = ("hexapods_", "__Host-hexapods_", "__Secure-hexapods_")
"""Prefixes of the names of all cookies that are read."""


def kept_cookies(lines: Iterable[str]) -> Mapping[str, str]:
    """Parse the `Cookie` headers of a request; return the cookies with our prefixes, by name.

    In linear time: values are taken as they are, without the quotes and escapes of Python's
    `http.cookies`, which no cookie of ours has.
    """
    cookies: dict[str, str] = {}
    for line in lines:
        for pair in line.split(";"):
            name, _, value = pair.strip().partition("=")
            if name.startswith(_BEGINNINGS):
                cookies[name] = value
    return cookies


def cookies_of(scope: Scope) -> Mapping[str, str]:
    """Return the cookies of a request with our prefixes, by name; inside `DeclaredHeaders`."""
    cookies: Mapping[str, str] = scope["state"]["cookies"]
    return cookies


class SessionCookie:
    """The session cookie of a request.

    Browsers send cookies to all ports of a host, so the name contains the port, the public path and
    the path of the stage: two servers on one machine do not overwrite each other's cookie, nor do
    two stages. A secure cookie has the prefix `__Host-`, which prevents other hosts and plain HTTP
    from setting it, and is for all paths; below a public path it is for that path, so that its
    prefix is `__Secure-`, which prevents plain HTTP alone.

    Attributes:
        name: name of the cookie.
        value: session id that the client sent; "" without a cookie.
    """

    def __init__(self, scope: Scope, rules: CookieRules, path: str, name: str = NAME) -> None:
        """Read the session cookie of a request.

        Args:
            scope: ASGI scope of the request.
            rules: when browsers store and send it.
            path: path of the stage, or of another page with a cookie of its own.
            name: beginning of the name of the cookie.
        """
        self._attributes = rules.attributes
        self._path = f"{public_path_of(scope)}/"
        self.name = f"{name_of_server(scope, rules, name)}{path.replace('/', '_')}"
        self.value = cookies_of(scope).get(self.name, "")

    def set_header(self, session_id: str, age_s: int = SESSION_S) -> str:
        """Return the `Set-Cookie` value that stores a session id for a time [s]."""
        return self._header(session_id, age_s)

    def expire_header(self) -> str:
        """Return the `Set-Cookie` value that deletes the cookie."""
        return self._header("", 0)

    def _header(self, value: str, age_s: int) -> str:
        return (
            f"{self.name}={value}; Max-Age={age_s}; Path={self._path}; HttpOnly; {self._attributes}"
        )


def name_of_server(scope: Scope, rules: CookieRules, name: str) -> str:
    """Return the beginning of the names of a server's cookies, with the port that was called."""
    port = Headers(scope=scope).get("host", "").rpartition("]")[2].rpartition(":")[2]
    if not (port.isascii() and port.isdigit()):
        port = "443" if rules.is_secure else "80"
    path = public_path_of(scope)
    prefix = "" if not rules.is_secure else "__Secure-" if path else "__Host-"
    return f"{prefix}{name}_{port}{_NOT_IN_NAME.sub('_', path)}"
