"""The cookie that holds the id of an operator's session."""

from starlette.datastructures import Headers
from starlette.requests import cookie_parser

from app.storage.sessions import SESSION_S

NAME = "hexapods_operator"


class SessionCookie:
    """The cookie of a request, by the name that it has there.

    Browsers send cookies to all ports of a host, so that the name has the port in it: two servers
    on one machine do not take each other's away. A secure one cannot be set by another host or
    over plain HTTP, since its name begins with `__Host-`.

    Attributes:
        name: of the cookie.
        value: that was sent; "" if there is none.
    """

    def __init__(self, headers: Headers, is_secure: bool) -> None:
        """Find it in the headers of a request.

        Args:
            headers: of the request.
            is_secure: whether browsers use HTTPS.
        """
        port = headers.get("host", "").rpartition("]")[2].rpartition(":")[2]
        if not (port.isascii() and port.isdigit()):
            port = "443" if is_secure else "80"
        self._is_secure = is_secure
        self.name = f"{'__Host-' if is_secure else ''}{NAME}_{port}"
        self.value = cookie_parser("; ".join(headers.getlist("cookie"))).get(self.name, "")

    def holding(self, session_id: str) -> str:
        """The header that sets it."""
        return self._header(session_id, SESSION_S)

    def gone(self) -> str:
        """The header that lets the browser forget it."""
        return self._header("", 0)

    def _header(self, value: str, age_s: int) -> str:
        secure = "; Secure" if self._is_secure else ""
        return f"{self.name}={value}; Max-Age={age_s}; Path=/; HttpOnly; SameSite=Strict{secure}"
