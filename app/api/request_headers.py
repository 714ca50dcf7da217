"""The headers of requests that the app reads, and how long each may be; no other reaches it.

What reads headers, before any limit of an address, may take time by their length: so a header that
is no longer than `MAX_BYTES` costs little, whatever it holds, and a longer one is read by nothing.
"""

from starlette.types import Receive, Scope, Send

from app.api.cookies import kept_cookies
from app.api.middleware import HttpMiddleware
from app.api.problems import problem

READ = frozenset(
    {
        "accept",
        "accept-encoding",
        "access-control-request-headers",
        "access-control-request-method",
        "authorization",
        "content-length",
        "content-type",
        "cookie",
        "host",
        "idempotency-key",
        "if-none-match",
        "last-event-id",
        "origin",
        "page-language",
        "referer",
        "sec-fetch-dest",
        "sec-fetch-mode",
        "sec-fetch-site",
        "transfer-encoding",
        "x-requested-with",
    }
)
"""Names, in lower case."""
READ_BEFORE = frozenset(
    {
        "connection",
        "expect",
        "upgrade",
        "x-forwarded-for",
        "x-forwarded-prefix",
        "x-forwarded-proto",
    }
)
"""Names of those that uvicorn, `ForwardedPath` and h11 read before the app is called."""
MAX_BYTES = 8 << 10
"""Longest header that is read, over all lines of the same name."""


class DeclaredHeaders(HttpMiddleware):
    """Middleware that leaves of a request's headers those in `READ`, and refuses long ones.

    So no code of the app reads a header that is not declared here, which promise 28 tests. The
    cookies are parsed here, once a request. To be installed outside all middleware that reads
    headers.
    """

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or refuse with 431."""
        sizes: dict[str, int] = {}
        headers: list[tuple[bytes, bytes]] = []
        for raw_name, value in scope["headers"]:
            name = raw_name.decode("latin-1").lower()
            if name in READ:
                headers.append((raw_name, value))
                sizes[name] = sizes.get(name, 0) + len(value)
        too_long = sorted(name for name, size in sizes.items() if size > MAX_BYTES)
        if not too_long:
            lines = [
                value.decode("latin-1") for name, value in headers if name.lower() == b"cookie"
            ]
            # That there are cookies is all that the header tells from here on: FastAPI would parse
            # it for each request, in quadratic time before Python 3.11.10.
            headers = [(n, b"" if n.lower() == b"cookie" else value) for n, value in headers]
            state = {**scope.get("state", {}), "cookies": kept_cookies(lines)}
            await self._app({**scope, "headers": headers, "state": state}, receive, send)
        else:
            detail = f"The header {too_long[0].title()} may have at most {MAX_BYTES:,} bytes."
            await problem(431, detail)(scope, receive, send)
