"""The routes of /viewer/: viser's client, patched, and the parameters that its address may have."""

import gzip
import hashlib
from collections.abc import Mapping
from functools import cache
from urllib.parse import urlencode

from starlette.datastructures import QueryParams
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from hexapods.drawing.viser_internals.client import content_policy, patched_page

STAGE_SCRIPTS = (
    "context.js",
    "client.js",
    "patch.js",
    "robots.js",
    "shots.js",
    "clicks.js",
    "legs.js",
    "camera.js",
    "inspection.js",
    "light.js",
    "shadows.js",
    "labels.js",
)
ALLOWED_QUERY = frozenset(
    {
        "theme",
        "initialCameraPosition",
        "initialCameraLookAt",
        "initialCameraUp",
        "initialCameraFov",
        "darkMode",
        "showStats",
        "fixedDpr",
    }
)


def sanitized_query(query: QueryParams) -> str | None:
    """Return the query without parameters that are not allow-listed; None if all are.

    viser's client would play any `playbackPath`, and run scripts from there, so that a link to our
    own page could inject them. Allowed are parameters that only change the appearance.
    """
    items = query.multi_items()
    allowed = [(name, value) for name, value in items if name in ALLOWED_QUERY]
    return None if len(allowed) == len(items) else urlencode(allowed)


class ViewerPage:
    """The patched page, plain and compressed."""

    def __init__(self) -> None:
        """Read viser's client and inject the patch.

        Raises:
            RuntimeError: The installed viser's page does not have the expected form.
        """
        page = patched_page("Racing Hexapods: the stage", STAGE_SCRIPTS)
        self._policy = content_policy(page)
        html = page.encode("utf-8")
        digest = hashlib.sha256(html).hexdigest()[:16]
        # A strong entity tag identifies the bytes sent, so each encoding needs its own.
        self._plain = (html, f'"{digest}"')
        self._gzipped = (gzip.compress(html, mtime=0), f'"{digest}-gzip"')

    def response(self, headers: Mapping[str, str]) -> Response:
        """Return the page for a request with these headers, or 304 if its copy is current."""
        accepts_gzip = "gzip" in headers.get("accept-encoding", "")
        body, tag = self._gzipped if accepts_gzip else self._plain
        response_headers = {
            "ETag": tag,
            "Cache-Control": "no-cache",
            "Vary": "Accept-Encoding",
            # With 304 too, which updates the headers of the cached copy.
            "Content-Security-Policy": self._policy,
        }
        if tag in headers.get("if-none-match", ""):
            return Response(status_code=304, headers=response_headers)
        if accepts_gzip:
            response_headers["Content-Encoding"] = "gzip"
        return Response(body, media_type="text/html", headers=response_headers)


@cache
def viewer_page() -> ViewerPage:
    """Return the page of this process: building it takes a tenth of a second.

    Raises:
        RuntimeError: as `ViewerPage`.
    """
    return ViewerPage()


def viewer_routes() -> list[Route]:
    """Return the routes of `/viewer/`, which spectators may use.

    Raises:
        RuntimeError: The patch does not fit the client of the installed viser.
    """
    page = viewer_page()

    async def show(request: Request) -> Response:
        cleaned = sanitized_query(request.query_params)
        if cleaned is not None:
            return RedirectResponse(f"?{cleaned}")
        return page.response(request.headers)

    async def add_slash(request: Request) -> Response:
        # Relative, so that it also works behind a proxy that serves the app under a prefix.
        return RedirectResponse(f"viewer/?{request.url.query}".removesuffix("?"))

    return [
        Route("/viewer", add_slash, name="viewer-slash"),
        Route("/viewer/", show, name="viewer"),
    ]
