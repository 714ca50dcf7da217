"""Print the JSON schemas of all that the page reads, as the OpenAPI document describes it.

`make page-types` writes `static/js/api-types.d.ts` from them. Request bodies are left out: the page
builds them by the options that the server declares.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from app.api.contract import operations
from app.server import create_app
from app.settings import Settings
from tests.storage.stores import temporary_store

_EVENTS = "EventBodies"


def answer_schemas(document: dict[str, Any]) -> dict[str, Any]:
    """Return the schemas of successful responses and of events, and those that they refer to."""
    schemas = document["components"]["schemas"]
    successes = [
        response
        for _, _, operation in operations(document)
        for status, response in operation["responses"].items()
        if int(status) < 400
    ]
    waiting, names = [_EVENTS, *_references(successes)], set[str]()
    while waiting:
        name = waiting.pop()
        if name not in names:
            names.add(name)
            waiting += _references(schemas[name])
    return {name: schemas[name] for name in sorted(names)}


def _references(document: Any) -> Iterator[str]:
    if isinstance(document, dict):
        if isinstance(reference := document.get("$ref"), str):
            yield reference.rpartition("/")[2]
        document = list(document.values())
    if isinstance(document, list):
        for member in document:
            yield from _references(member)


if __name__ == "__main__":
    with temporary_store() as store:
        app = create_app(Settings(data=Path("unused")), store)
        json.dump(answer_schemas(app.openapi()), sys.stdout)
