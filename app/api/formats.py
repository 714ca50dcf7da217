"""Content negotiation by `?format=` or else the Accept header, and responses with files."""

from collections.abc import Iterable, Mapping, Sequence

from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from app.storage.artifact_file import ArtifactFile, chunks

_TYPES: Mapping[str, str] = {
    "application/json": "json",
    "text/csv": "csv",
    "application/x-npz": "npz",
    "application/octet-stream": "npz",
}


def negotiated(
    request: Request,
    query: str | None,
    formats: Sequence[str],
    types: Mapping[str, str] = _TYPES,
) -> str:
    """Return the negotiated format, by default the first of `formats`.

    Args:
        request: its Accept header is used without a query.
        query: value of `?format=`, if given.
        formats: available formats.
        types: the format of each media type.
    """
    if query is not None:
        return query
    qualities: dict[str, float] = {}
    for entry in request.headers.get("accept", "").split(","):
        media_type, *parameters = (item.strip().lower() for item in entry.split(";"))
        name = types.get(media_type)
        if name in formats:
            qualities.setdefault(str(name), _quality(parameters))
    best = max(qualities, key=qualities.__getitem__, default=formats[0])
    return best if qualities.get(best, 1.0) > 0 else formats[0]


def attachment(
    content: bytes | Iterable[str] | Iterable[bytes] | ArtifactFile, media_type: str, name: str
) -> Response:
    """Return a response that browsers save as a file of this name."""
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    if isinstance(content, bytes):
        return Response(content, headers=headers, media_type=media_type)
    if isinstance(content, Iterable):
        return StreamingResponse(content, headers=headers, media_type=media_type)
    return file_response(content, media_type, headers)


def file_response(
    file: ArtifactFile, media_type: str | None, headers: Mapping[str, str] | None = None
) -> Response:
    """Return a response that streams a file in chunks with back-pressure, then closes it."""
    all_headers = {**(headers or {}), "Content-Length": str(file.size)}
    return StreamingResponse(chunks(file), headers=all_headers, media_type=media_type)


def _quality(parameters: Sequence[str]) -> float:
    for parameter in parameters:
        if parameter.startswith("q="):
            try:
                return float(parameter[2:])
            except ValueError:
                return 0.0
    return 1.0
