"""Problem documents as web pages, for people whose browser opened an address that is refused."""

import json

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import HTMLResponse
from starlette.types import Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.problems import MEDIA_TYPE
from app.api.stage_paths import path_of
from app.api.templates import render


class ProblemPages(HttpMiddleware):
    """Middleware that sends a problem document as a page where the request prefers HTML.

    Browsers ask for `text/html` first when a person opens an address, and never in a script's
    request. Status and headers stay. An unexpected error (500) stays a document: its handler runs
    outside all middleware.
    """

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app, and rewrite its answer if it is a problem document."""
        is_page = prefers_html(Headers(scope=scope))
        # Relative, so that it is valid behind a proxy that serves the app under a prefix; and of
        # the path as it is now, since a folder of files makes it shorter.
        home = "../" * max(path_of(scope).count("/") - 1, 0) or "./"
        start: Message | None = None
        body = b""

        async def send_page(message: Message) -> None:
            nonlocal start, body
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                if headers.get("content-type") == MEDIA_TYPE:
                    headers.add_vary_header("Accept")
                    start = message if is_page else None
                if start is None:
                    await send(message)
            elif start is None:
                await send(message)
            else:
                body += message.get("body", b"")
                if not message.get("more_body", False):
                    await _page(start, body, home)(scope, receive, send)

        await self._app(scope, receive, send_page)


def prefers_html(headers: Headers) -> bool:
    """Whether a person asks for a page, by the headers of the request."""
    return headers.get("accept", "").lstrip().startswith("text/html")


def _page(start: Message, body: bytes, home: str) -> HTMLResponse:
    problem = json.loads(body)
    page = render("problem.html", title=problem["title"], detail=problem["detail"], home=home)
    response = HTMLResponse(page, start["status"])
    for name, value in MutableHeaders(scope=start).items():
        if name not in ("content-type", "content-length"):
            response.headers.append(name, value)
    return response
