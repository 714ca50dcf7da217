"""Static files of the dashboard, with cache and content security headers."""

import base64
import hashlib
import re
from pathlib import Path

from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

_INLINE_SCRIPT = re.compile(r"<script(?![^>]*\ssrc=)[^>]*>(.*?)</script>", re.DOTALL)
# Revalidate at each use (304): a page and its scripts are then of the same version.
_REVALIDATE = {"Cache-Control": "no-cache"}


def page_routes(folder: Path) -> list[BaseRoute]:
    """Return the routes of the page at `/` and its files under `/static/`.

    Args:
        folder: folder of the dashboard, with its `index.html`.
    """
    index = folder / "index.html"

    async def show(request: Request) -> Response:
        del request
        policy = content_policy(index.read_text("utf-8"))
        return FileResponse(index, headers={**_REVALIDATE, "Content-Security-Policy": policy})

    async def favicon(request: Request) -> Response:
        del request
        return FileResponse(folder / "favicon.svg", headers=_REVALIDATE)

    return [
        Route("/", show, name="dashboard"),
        Route("/favicon.ico", favicon, name="favicon"),
        Mount("/static", _Files(directory=folder), name="static"),
    ]


def content_policy(page: str) -> str:
    """Build a page's content security policy: its own files, its inline scripts by hash."""
    digests = (hashlib.sha256(body.encode()).digest() for body in _INLINE_SCRIPT.findall(page))
    inline = "".join(f" 'sha256-{base64.b64encode(digest).decode()}'" for digest in digests)
    return (
        f"default-src 'self'; script-src 'self'{inline}; style-src 'self' 'unsafe-inline'; "
        "img-src 'self' data: blob:; connect-src 'self'; frame-src 'self'; object-src 'none'; "
        "base-uri 'none'; form-action 'self'; frame-ancestors 'self'"
    )


class _Files(StaticFiles):
    async def get_response(self, path: str, scope: Scope) -> Response:
        response = await super().get_response(path, scope)
        response.headers.update(_REVALIDATE)
        return response
