"""In which form an answer is wanted: `?format=` decides, else the Accept header."""

from collections.abc import Iterable, Mapping, Sequence

from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from app.storage.artifact_file import ArtifactFile, chunks

_TYPES = {
    "application/json": "json",
    "text/csv": "csv",
    "application/x-npz": "npz",
    "application/octet-stream": "npz",
}


def chosen(request: Request, query: str | None, formats: Sequence[str]) -> str:
    """One of `formats`; the first where nobody says.

    Args:
        request: whose Accept header counts.
        query: what `?format=` says.
        formats: that there are.
    """
    if query is not None:
        return query
    wanted: dict[str, float] = {}
    for entry in request.headers.get("accept", "").split(","):
        media_type, *parameters = (part.strip().lower() for part in entry.split(";"))
        name = _TYPES.get(media_type)
        if name in formats:
            wanted.setdefault(str(name), _quality(parameters))
    best = max(wanted, key=wanted.__getitem__, default=formats[0])
    return best if wanted.get(best, 1.0) > 0 else formats[0]


def attachment(
    content: bytes | Iterable[str] | Iterable[bytes] | ArtifactFile, media_type: str, name: str
) -> Response:
    """A file to be saved under this name."""
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    if isinstance(content, bytes):
        return Response(content, headers=headers, media_type=media_type)
    if isinstance(content, Iterable):
        return StreamingResponse(content, headers=headers, media_type=media_type)
    return file_response(content, media_type, headers)


def file_response(
    file: ArtifactFile, media_type: str | None, headers: Mapping[str, str] | None = None
) -> Response:
    """A file that is sent piece by piece, as fast as the client takes it, and closed then."""
    told = {**(headers or {}), "Content-Length": str(file.size)}
    return StreamingResponse(chunks(file), headers=told, media_type=media_type)


def _quality(parameters: Sequence[str]) -> float:
    for parameter in parameters:
        if parameter.startswith("q="):
            try:
                return float(parameter[2:])
            except ValueError:
                return 0.0
    return 1.0
