"""The API's description as a page of its own: no scripts, nothing from elsewhere."""

import json
from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import HTMLResponse, Response

router = APIRouter(include_in_schema=False)

_VERBS = ("get", "post", "put", "patch", "delete")
_STYLE = """
:root { color-scheme: light dark; font: 16px/1.5 system-ui, sans-serif; }
body { max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h2 { margin-top: 2.5rem; text-transform: capitalize; }
summary { cursor: pointer; padding: .3rem 0; }
code, pre { font: .9rem/1.5 ui-monospace, monospace; }
pre { overflow-x: auto; padding: .75rem; border-radius: .5rem; background: #8881; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .25rem 1rem .25rem 0;
  border-bottom: 1px solid #8884; }
.verb { display: inline-block; min-width: 4.5rem; font-weight: 700; }
"""


@router.get("/docs")
def get_docs(request: Request) -> Response:
    """Every route with its fields, drawn from `/openapi.json`."""
    return HTMLResponse(render(request.app.openapi(), str(request.base_url).rstrip("/")))


def render(schema: Mapping[str, Any], base: str) -> str:
    """The page.

    Args:
        schema: the OpenAPI document.
        base: address of the server, for examples.
    """
    info = schema["info"]
    groups: dict[str, list[str]] = {}
    for path, verbs in schema["paths"].items():
        for verb in (v for v in _VERBS if v in verbs):
            operation = verbs[verb]
            tag = (operation.get("tags") or ["other"])[0]
            groups.setdefault(tag, []).append(_operation(verb, path, operation, schema, base))
    sections = "".join(f"<h2>{escape(tag)}</h2>{''.join(ops)}" for tag, ops in groups.items())
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(info['title'])}: REST</title><style>{_STYLE}</style></head><body>"
        f"<h1>{escape(info['title'])} {escape(info['version'])}</h1>"
        f"<p>{escape(info.get('description', ''))}</p>"
        '<p>For programs: <a href="openapi.json">openapi.json</a>. '
        '<a href="./">Back to the dashboard</a></p>'
        f"{sections}</body></html>"
    )


def _operation(
    verb: str, path: str, operation: Mapping[str, Any], schema: Mapping[str, Any], base: str
) -> str:
    rows = [(p["name"], p["in"], p["schema"], p) for p in operation.get("parameters", ())]
    content = operation.get("requestBody", {}).get("content", {})
    body = content.get("application/json", {}).get("schema", {})
    rows += [(name, "body", field, field) for name, field in _fields(body, schema)]
    table = "".join(
        f"<tr><td><code>{escape(name)}</code></td><td>{place}</td>"
        f"<td>{escape(_type(kind, schema))}</td>"
        f"<td>{escape(about.get('description', ''))}</td></tr>"
        for name, place, kind, about in rows
    )
    fields = (
        f"<table><tr><th>name</th><th>in</th><th>type</th><th></th></tr>{table}</table>"
        if table
        else ""
    )
    return (
        f'<details><summary><span class="verb">{verb.upper()}</span> <code>{escape(path)}</code> '
        f"{escape(operation.get('summary', ''))}</summary>"
        f"<p>{escape(operation.get('description', ''))}</p>{fields}"
        f"<pre>{escape(_example(verb, path, bool(body), base))}</pre></details>"
    )


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
    found: Mapping[str, Any] = schema["components"]["schemas"][name]
    return found


def _type(kind: Mapping[str, Any], schema: Mapping[str, Any]) -> str:
    options = kind.get("anyOf") or kind.get("oneOf")
    if options:
        return " or ".join(_type(option, schema) for option in options)
    if "$ref" in kind:
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
