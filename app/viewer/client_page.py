"""The page at /viewer/: viser's own client, which is one file, with a skin over it."""

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

_FREE_QUERY = frozenset(
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


def skin_script() -> str:
    """The script that the page gets, exactly as it stands there: what a CSP's hash is taken of."""
    return (assets.static_dir() / "viewer" / "skin.js").read_text("utf-8")


def skin_style() -> str:
    """The style sheet that the page gets, exactly as it stands there."""
    return (assets.static_dir() / "viewer" / "skin.css").read_text("utf-8")


def clean_query(query: QueryParams) -> str | None:
    """The query without what viser's client must not be told; None if it has nothing of that.

    It would connect to any `websocket` and play any `playbackPath`, and run scripts from there: a
    link to our own page could bring them. Kept is what only looks, and recordings of our own.
    """
    items = query.multi_items()
    kept = [(name, value) for name, value in items if _is_harmless(name, value)]
    return None if len(kept) == len(items) else urlencode(kept)


class ViewerPage:
    """The page, ready to send: made once, because it is large."""

    def __init__(self) -> None:
        """Read viser's client and put the skin on.

        Raises:
            RuntimeError: The client is not of the form that the skin fits.
        """
        page = _skinned(Path(viser.__file__).with_name("client") / "build" / "index.html")
        self._policy = content_policy(page)
        html = page.encode("utf-8")
        digest = hashlib.sha256(html).hexdigest()[:16]
        # An entity tag is of the bytes sent, so each encoding has its own.
        self._plain = (html, f'"{digest}"')
        self._gzipped = (gzip.compress(html, mtime=0), f'"{digest}-gzip"')

    def response(self, headers: Mapping[str, str]) -> Response:
        """Answer a request with these headers: the page, or 304 for who has it."""
        accepts_gzip = "gzip" in headers.get("accept-encoding", "")
        body, tag = self._gzipped if accepts_gzip else self._plain
        answer = {
            "ETag": tag,
            "Cache-Control": "no-cache",
            "Vary": "Accept-Encoding",
            # With 304 too, which brings what is kept up to date.
            "Content-Security-Policy": self._policy,
        }
        if tag in headers.get("if-none-match", ""):
            return Response(status_code=304, headers=answer)
        if accepts_gzip:
            answer["Content-Encoding"] = "gzip"
        return Response(body, media_type="text/html", headers=answer)


def _skinned(client: Path) -> str:
    html = client.read_text("utf-8")
    if html.count(_HEAD) != 1 or html.count(_TITLE) != 1:
        raise RuntimeError(f"viser {viser.__version__} has another page than the skin was made for")
    skin = f"<script>{skin_script()}</script><style>{skin_style()}</style>"
    html = html.replace(_TITLE, "<title>Racing Hexapods: the stage</title>")
    # First of all, since viser's loader starts while the page is still read.
    return html.replace(_HEAD, _HEAD + skin)


def _is_harmless(name: str, value: str) -> bool:
    if name == "playbackPath":
        return _RECORDING.fullmatch(value) is not None
    return name in _FREE_QUERY
