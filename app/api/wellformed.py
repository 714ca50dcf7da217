"""Refuses malformed requests before parsers can disagree on them (request smuggling)."""

from starlette.datastructures import Headers
from starlette.types import Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.problems import problem

MAX_TARGET_BYTES = 8 << 10


class MalformedRequestGuard(HttpMiddleware):
    """Middleware: refuse ambiguous framing and malformed targets; serve HEAD by GET."""

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, or refuse with 400 or 414 and close the connection."""
        status, detail = _fault(scope)
        if status:
            # The bytes that follow on the connection may belong to this request.
            refusal = problem(status, detail, headers={"Connection": "close"})
            await refusal(scope, receive, send)
        elif scope["method"] == "HEAD":
            await self._app({**scope, "method": "GET"}, receive, _head_only(send))
        else:
            await self._app(scope, receive, send)


def _fault(scope: Scope) -> tuple[int, str]:
    """Return status and detail of a refusal; status 0 for a well-formed request."""
    headers = Headers(scope=scope)
    if "transfer-encoding" in headers and "content-length" in headers:
        return 400, "A request has either a Content-Length or a Transfer-Encoding, not both."
    if len(headers.getlist("content-length")) > 1:
        return 400, "A request has one Content-Length."
    target: bytes = scope.get("raw_path") or scope["path"].encode("utf-8", "surrogateescape")
    if len(target) + len(scope["query_string"]) > MAX_TARGET_BYTES:
        return 414, f"The request's target may have at most {MAX_TARGET_BYTES:,} bytes."
    if not target.startswith(b"/"):
        return 400, "The request's target must be a path, which begins with a slash."
    target += scope["query_string"]
    if b"#" in target or not all(0x21 <= byte <= 0x7E for byte in target):
        return 400, "The request's target has a character that must be percent-encoded."
    return 0, ""


def _head_only(send: Send) -> Send:
    """Wrap `send` to end the response after its head, as an event stream would not end."""
    is_sent = False

    async def head(message: Message) -> None:
        nonlocal is_sent
        if message["type"] == "http.response.start" and not is_sent:
            is_sent = True
            await send(message)
            await send({"type": "http.response.body", "body": b"", "more_body": False})

    return head
