"""The page at /viewer/: viser's single-file client with a script and a style sheet injected."""

import gzip
import hashlib
import re
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import urlencode

import viser
from starlette.datastructures import QueryParams
from starlette.responses import Response

from app import assets
from app.viewer.client_policy import content_policy

_HEAD = "<head>"
_TITLE = "<title>Viser</title>"

_ALLOWED_QUERY = frozenset(
    {
        "view",
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
_RECORDING = re.compile(r"/api/v1/races/[\w-]+/recording(\?[\w=&.-]*)?", re.ASCII)


def patch_script() -> str:
    """Return the injected script exactly as in the page, as the CSP's hash requires."""
    return (assets.static_dir() / "viewer" / "skin.js").read_text("utf-8")


def patch_style() -> str:
    """Return the injected style sheet exactly as in the page."""
    return (assets.static_dir() / "viewer" / "skin.css").read_text("utf-8")


def sanitized_query(query: QueryParams) -> str | None:
    """Return the query without parameters that are not allow-listed; None if all are.

    viser's client would connect to any `websocket` and play any `playbackPath`, and run scripts
    from there, so that a link to our own page could inject them. Allowed are parameters that only
    change the appearance, and recordings of this server.
    """
    items = query.multi_items()
    allowed = [(name, value) for name, value in items if _is_allowed(name, value)]
    return None if len(allowed) == len(items) else urlencode(allowed)


class ViewerPage:
    """The patched page, plain and compressed; built once, because it is large."""

    def __init__(self) -> None:
        """Read viser's client and inject the patch.

        Raises:
            RuntimeError: The installed viser's page does not have the expected form.
        """
        page = _patched_page(Path(viser.__file__).with_name("client") / "build" / "index.html")
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


def _patched_page(client: Path) -> str:
    html = client.read_text("utf-8")
    if html.count(_HEAD) != 1 or html.count(_TITLE) != 1:
        raise RuntimeError(f"viser {viser.__version__} has another page than the skin was made for")
    patch = f"<script>{patch_script()}</script><style>{patch_style()}</style>"
    html = html.replace(_TITLE, "<title>Racing Hexapods: the stage</title>")
    # At the start of the head, since viser's loader runs while the page is still parsed.
    return html.replace(_HEAD, _HEAD + patch)


def _is_allowed(name: str, value: str) -> bool:
    if name == "playbackPath":
        return _RECORDING.fullmatch(value) is not None
    return name in _ALLOWED_QUERY
