"""Contents that are compressed once, and sent with gzip to clients that accept it.

Only for contents that hold no secret: the length of a compressed secret beside a client's text
tells what they have in common (BREACH).
"""

import gzip
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import Scope

_YEAR_S, _SHARED_S = 365 * 24 * 3600, 3600


class CompressedContent:
    """A content, plain and compressed, each with its entity tag; clients revalidate at each use.

    Ranges are not served: a request for one is answered with the whole content.
    """

    def __init__(
        self, content: bytes, media_type: str, headers: Mapping[str, str] | None = None
    ) -> None:
        """Compress a content.

        Args:
            content: the bytes.
            media_type: their type.
            headers: further headers of each response, of 304 as well.
        """
        self._media_type = media_type
        # After revalidation (304) a page and its scripts are of the same version.
        self._headers = {**(headers or {}), "Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
        digest = hashlib.sha256(content).hexdigest()[:16]
        # A strong entity tag identifies the bytes sent, so each encoding needs its own.
        self._plain = (content, {"ETag": f'"{digest}"'})
        packed = gzip.compress(content, mtime=0)
        self._gzipped = (packed, {"ETag": f'"{digest}-gzip"', "Content-Encoding": "gzip"})
        self._is_smaller = len(packed) < len(content)

    def response(self, scope: Scope) -> Response:
        """Return the response to a request, without content if its copy is current."""
        request = Headers(scope=scope)
        is_gzipped = self._is_smaller and accepts_gzip(request.get("accept-encoding", ""))
        body, encoding_headers = self._gzipped if is_gzipped else self._plain
        headers = {**self._headers, **encoding_headers}
        if is_current(request, headers["ETag"]):
            headers.pop("Content-Encoding", None)
            return Response(status_code=304, headers=headers)
        return Response(body, headers=headers, media_type=self._media_type)


@dataclass(frozen=True, kw_only=True)
class Caching:
    """Caching of a content by clients, and by proxies on the way.

    Attributes:
        tag: entity tag of the content; contents with the same tag are the same bytes.
        is_immutable: whether the address of the request never has another content, so that a cache
            need not revalidate it.
        is_public: whether a cache may answer others with it.
    """

    tag: str
    is_immutable: bool
    is_public: bool

    @property
    def control(self) -> str:
        """Value of the header `Cache-Control`."""
        if not self.is_immutable:
            return "no-cache"
        # Shared caches ask again after a while, as the content may have been deleted or hidden.
        sharing = f"public, s-maxage={_SHARED_S}" if self.is_public else "private"
        return f"{sharing}, max-age={_YEAR_S}, immutable"


def gzipped(
    request: Request, content: bytes, media_type: str, caching: Caching | None = None
) -> Response:
    """Return the response of a content that is stored compressed; 304 if the client's is current.

    Args:
        request: the request.
        content: the content, compressed with gzip.
        media_type: its type.
        caching: how it is cached; None to request it anew at each use.
    """
    is_gzipped = accepts_gzip(request.headers.get("accept-encoding", ""))
    headers = {"Cache-Control": "no-cache", "Vary": "Accept-Encoding"}
    if caching is not None:
        # A strong entity tag identifies the bytes sent, so each encoding needs its own.
        tag = f'"{caching.tag}{"-gzip" if is_gzipped else ""}"'
        headers |= {"Cache-Control": caching.control, "ETag": tag}
        if is_current(request.headers, tag):
            return Response(status_code=304, headers=headers)
    if not is_gzipped:
        return Response(gzip.decompress(content), headers=headers, media_type=media_type)
    headers["Content-Encoding"] = "gzip"
    return Response(content, headers=headers, media_type=media_type)


def is_current(request: Headers, tag: str) -> bool:
    """Whether `If-None-Match` of a request has an entity tag, or `*`."""
    tags = request.get("if-none-match", "").split(",")
    return bool({tag, "*"} & {known.strip().removeprefix("W/") for known in tags})


def accepts_gzip(accept_encoding: str) -> bool:
    """Whether an `Accept-Encoding` header names gzip with a quality above zero."""
    for item in accept_encoding.lower().replace(" ", "").split(","):
        coding, _, quality = item.partition(";q=")
        if coding == "gzip":
            return quality.strip("0.") != "" or quality == ""
    return False
