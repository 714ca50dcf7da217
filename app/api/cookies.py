"""Session cookies: of operators, of participants of rooms, and of visitors of a demo."""

from starlette.datastructures import Headers
from starlette.requests import cookie_parser
from starlette.types import Scope

from app.settings import Settings
from app.storage.sessions import SESSION_S

NAME = "hexapods_operator"
ROOM_NAME = "hexapods_room"
VISITOR_NAME = "hexapods_visitor"


def is_secure(scope: Scope, settings: Settings) -> bool:
    """Whether browsers reach the server over HTTPS, by itself or by the proxy that offers it."""
    return scope["scheme"] in ("https", "wss") or (settings.public_url or "").startswith("https:")


class SessionCookie:
    """The session cookie of a request.

    Browsers send cookies to all ports of a host, so the name contains the port and the path of the
    stage: two servers on one machine do not overwrite each other's cookie, nor do two stages. A
    secure cookie has the prefix `__Host-`, which prevents other hosts and plain HTTP from setting
    it, and is for all paths.

    Attributes:
        name: of the cookie.
        value: session id that the client sent; "" without a cookie.
        others: all cookies of the request, by name.
    """

    def __init__(self, headers: Headers, is_secure: bool, path: str, name: str = NAME) -> None:
        """Parse it from the headers of a request.

        Args:
            headers: of the request.
            is_secure: whether browsers use HTTPS.
            path: of the stage, or the code of a room.
            name: beginning of its name.
        """
        port = headers.get("host", "").rpartition("]")[2].rpartition(":")[2]
        if not (port.isascii() and port.isdigit()):
            port = "443" if is_secure else "80"
        self._is_secure = is_secure
        self.name = f"{'__Host-' if is_secure else ''}{name}_{port}{path.replace('/', '_')}"
        self.others = cookie_parser("; ".join(headers.getlist("cookie")))
        self.value = self.others.get(self.name, "")

    def set_header(self, session_id: str, age_s: int = SESSION_S) -> str:
        """Return the `Set-Cookie` value that stores a session id for a time [s]."""
        return self._header(session_id, age_s)

    def expire_header(self) -> str:
        """Return the `Set-Cookie` value that deletes the cookie."""
        return self._header("", 0)

    def _header(self, value: str, age_s: int) -> str:
        secure = "; Secure" if self._is_secure else ""
        return f"{self.name}={value}; Max-Age={age_s}; Path=/; HttpOnly; SameSite=Strict{secure}"
