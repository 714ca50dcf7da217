"""The OpenAPI document, and pages without scripts: one rendered from it, and types of problems."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

from fastapi import Request
from starlette.responses import HTMLResponse, Response

from app.api.compression import CompressedContent
from app.api.policy import PUBLIC, WATCH, api_router, policy
from app.api.problem_types import FOLDER, TYPES
from app.api.public_path import public_path_of
from app.api.templates import render as render_template
from app.storage.errors import NotFound

router = api_router(include_in_schema=False)

_MAX_DOCUMENTS = 4
"""Documents that are kept, each for a public path."""
_METHODS = ("get", "post", "put", "patch", "delete")


@router.get("/openapi.json")
@policy(access=WATCH)
def get_openapi(request: Request) -> Response:
    """Return the OpenAPI document."""
    state, path = request.app.state, public_path_of(request.scope)
    if not hasattr(state, "openapi_documents"):
        state.openapi_documents = {}
    documents: dict[str, CompressedContent] = state.openapi_documents
    if path not in documents:
        if len(documents) >= _MAX_DOCUMENTS:
            documents.clear()
        # Paths of operations are below the address of the server, here relative to the document's.
        servers = {"servers": [{"url": path}]} if path else {}
        document = json.dumps(
            request.app.openapi() | servers, ensure_ascii=False, separators=(",", ":")
        )
        documents[path] = CompressedContent(document.encode(), "application/json")
    return documents[path].response(request.scope)


@router.get("/docs")
@policy(access=WATCH)
def get_docs(request: Request) -> Response:
    """Return every route with its fields, rendered from `/openapi.json`."""
    return HTMLResponse(render(request.app.openapi(), str(request.base_url).rstrip("/")))


@router.get("/problems")
@policy(access=PUBLIC)
def list_problems() -> HTMLResponse:
    """Return a page with all types of problems."""
    return HTMLResponse(
        render_template("problem_types.html", prefix=FOLDER, types=TYPES, home="./")
    )


@router.get("/problems/{name}")
@policy(access=PUBLIC)
def get_problem(name: str) -> HTMLResponse:
    """Return the page of a type of problem.

    Raises:
        NotFound: if there is no such type.
    """
    if name not in TYPES:
        raise NotFound(f"there is no type of problem {name!r}; there are {', '.join(TYPES)}")
    shown = {name: TYPES[name]}
    return HTMLResponse(
        render_template("problem_types.html", prefix=FOLDER, types=shown, home="../")
    )


def render(schema: Mapping[str, Any], base: str) -> str:
    """Render the page.

    Args:
        schema: the OpenAPI document.
        base: address of the server, for examples.
    """
    groups: dict[str, list[Mapping[str, Any]]] = {}
    for path, verbs in schema["paths"].items():
        for verb in (v for v in _METHODS if v in verbs):
            tag = (verbs[verb].get("tags") or ["other"])[0]
            groups.setdefault(tag, []).append(_operation(verb, path, verbs[verb], schema, base))
    return render_template("docs.html", info=schema["info"], groups=groups)


def _operation(
    verb: str, path: str, operation: Mapping[str, Any], schema: Mapping[str, Any], base: str
) -> Mapping[str, Any]:
    """Return the template's values for one operation."""
    rows = [(p["name"], p["in"], p["schema"], p) for p in operation.get("parameters", ())]
    content = operation.get("requestBody", {}).get("content", {})
    body = content.get("application/json", {}).get("schema", {})
    rows += [(name, "body", field, field) for name, field in _fields(body, schema)]
    return {
        "verb": verb.upper(),
        "path": path,
        "summary": operation.get("summary", ""),
        "description": operation.get("description", ""),
        "fields": [
            (
                name,
                place,
                _type(kind, schema),
                {**_resolved(kind, schema), **about}.get("description", ""),
            )
            for name, place, kind, about in rows
        ],
        "example": _example(verb, path, bool(body), base),
    }


def _example(verb: str, path: str, has_body: bool, base: str) -> str:
    command = f"curl {base}{path}" if verb == "get" else f"curl -X {verb.upper()} {base}{path}"
    if not has_body:
        return command
    example = {"gait": "left-right-origin"} if verb == "post" else {}
    sent = json.dumps(example) if example else "{…}"
    return f"{command} -H 'Content-Type: application/json' -d '{sent}'"


def _fields(body: Mapping[str, Any], schema: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    yield from _resolved(body, schema).get("properties", {}).items()


def _resolved(kind: Mapping[str, Any], schema: Mapping[str, Any]) -> Mapping[str, Any]:
    if "$ref" not in kind:
        return kind
    name = kind["$ref"].rpartition("/")[2]
    component: Mapping[str, Any] = schema["components"]["schemas"][name]
    return component


def _type(kind: Mapping[str, Any], schema: Mapping[str, Any]) -> str:
    kind = {**_resolved(kind, schema), **kind}
    options = kind.get("anyOf") or kind.get("oneOf")
    if options:
        return " or ".join(_type(option, schema) for option in options)
    if kind.get("type") == "object" and "properties" in kind:
        return "{" + ", ".join(name for name, _ in _fields(kind, schema)) + "}"
    if "const" in kind or "enum" in kind:
        return " or ".join(map(str, kind.get("enum", [kind.get("const")])))
    if kind.get("type") == "array":
        return f"list of {_type(kind.get('items', {}), schema)}"
    low = kind.get("minimum", kind.get("exclusiveMinimum"))
    high = kind.get("maximum", kind.get("exclusiveMaximum"))
    limits = "" if low is None else f" from {low:,.10g}"
    limits += "" if high is None else f" to {high:,.10g}"
    default = f", default {json.dumps(kind['default'])}" if "default" in kind else ""
    return f"{kind.get('type', 'any')}{limits}{default}"
