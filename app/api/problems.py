"""Exception handlers that map errors to HTTP statuses and RFC 9457 problem documents."""

import json
import logging
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from fastapi.routing import iter_route_contexts
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import compile_path

from app.api.descriptions import as_sentence, field_errors
from app.api.problem_types import FOLDER, TYPES, type_of_error, type_of_status
from app.api.public_path import public_path_of
from app.api.stage_paths import path_of
from app.storage.errors import Busy, Conflict, NotAnswering, StorageFailed
from hexapods.domain.errors import HexapodError, ImpossibleLegs, InvalidInput
from hexapods.domain.records import refusal_in

MEDIA_TYPE = "application/problem+json"
MAX_DETAIL = 1000
_STORAGE_RETRY_S = 10
_logger = logging.getLogger(__name__)

_DETAILS = {
    HTTPStatus.NOT_FOUND: "There is nothing at {path}; {docs} lists what there is.",
    HTTPStatus.METHOD_NOT_ALLOWED: "{method} is not possible at {path}; possible: {allow}.",
    HTTPStatus.REQUEST_ENTITY_TOO_LARGE: "The request's body is larger than the limit here.",
    HTTPStatus.BAD_REQUEST: "The request's body could not be read; send valid JSON.",
}


def problem(
    status: int,
    detail: str,
    errors: Sequence[Mapping[str, Any]] | None = None,
    headers: Mapping[str, str] | None = None,
    kind: str | None = None,
    **more: Any,
) -> Response:
    """Return a response with a problem document.

    Args:
        status: HTTP status of the response.
        detail: one or two sentences for the user, naming what is valid.
        errors: invalid fields, each with `field` and `detail`.
        headers: headers of the response.
        kind: name of its type (`problem_types`); None for that of its status.
        more: further members of the document.
    """
    kind = kind or type_of_status(status)
    body = {
        "type": "about:blank" if kind is None else f"{FOLDER}{kind}",
        "title": HTTPStatus(status).phrase if kind is None else TYPES[kind].title,
        "status": status,
        "detail": detail if len(detail) <= MAX_DETAIL else detail[: MAX_DETAIL - 1] + "…",
        **more,
    }
    if errors is not None:
        body["errors"] = list(errors)
    # Escaped to ASCII, because a message may quote invalid Unicode.
    return Response(json.dumps(body), status, headers, MEDIA_TYPE)


def install(app: FastAPI) -> None:
    """Register the exception handlers of an app."""
    app.add_exception_handler(HexapodError, hexapod_error)
    app.add_exception_handler(RequestValidationError, _validation_error)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(Exception, _unexpected)


async def hexapod_error(request: Request, error: Exception) -> Response:
    """Return the problem that an error of the product is answered with."""
    sentence = as_sentence(str(error))
    kind = type_of_error(error)
    if kind is None:
        return await _unexpected(request, error)
    match error:
        case Conflict(state=state):
            more: dict[str, Any] = {"state": state}
        case Busy(retry_after_s=seconds) | NotAnswering(retry_after_s=seconds):
            more = {"headers": {"Retry-After": str(seconds)}}
        case StorageFailed():
            more = {"headers": {"Retry-After": str(_STORAGE_RETRY_S)}}
        case ImpossibleLegs(legs=legs):
            more = {"legs": list(legs)}
        case InvalidInput(field=field) if field:
            more = {"field": field}
        case _:
            more = {}
    return problem(TYPES[kind].status, sentence, kind=kind, **more)


async def _validation_error(request: Request, error: Exception) -> Response:
    raw = error.errors() if isinstance(error, RequestValidationError) else []
    refusal, errors = refusal_in(raw), field_errors(raw)
    if refusal is not None and len(raw) == 1:
        refusal.field = refusal.field or errors[0]["field"]
        return await hexapod_error(request, refusal)
    details = [entry["detail"] for entry in errors]
    # `errors` is of fields that are wrong by themselves, which none of several refusals says.
    if all(refusal_in([entry]) is not None for entry in raw):
        return problem(422, " ".join(details))
    return problem(422, " ".join(details[:3]), errors)


async def _http_error(request: Request, error: Exception) -> Response:
    if not isinstance(error, HTTPException):
        return await _unexpected(request, error)
    headers = dict(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        headers["Allow"] = _allowed(request)
    template = _DETAILS.get(HTTPStatus(error.status_code), str(error.detail))
    values = {
        "path": request.url.path,
        "docs": f"{public_path_of(request.scope)}/docs",
        "method": request.method,
        "allow": headers.get("Allow", ""),
    }
    return problem(error.status_code, template.format_map(values), headers=headers)


def _allowed(request: Request) -> str:
    """Return the methods of all routes that match the path; a 405 has only those of the first."""
    routes = [route for route in iter_route_contexts(request.app.routes) if route.path]
    path = path_of(request.scope)
    # A literal path takes precedence over paths with a parameter.
    literal = [route for route in routes if route.path == path]
    matching = literal or [r for r in routes if r.path and compile_path(r.path)[0].match(path)]
    methods = {method for route in matching for method in route.methods or ()}
    methods = methods or {"GET"}  # of files
    return ", ".join(sorted(methods | ({"HEAD"} if "GET" in methods else set())))


async def _unexpected(request: Request, error: Exception) -> Response:
    _logger.error("%s %s failed", request.method, request.url.path, exc_info=error)
    detail = "Something broke in the server; its log says what. Other runs go on."
    # This handler runs outside `SecurityHeaders`, which adds these elsewhere.
    headers = {"X-Content-Type-Options": "nosniff", "Content-Security-Policy": "default-src 'none'"}
    return problem(500, detail, headers=headers)
