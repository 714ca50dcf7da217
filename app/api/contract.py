"""The API's description: what every operation can be sent and can answer.

Routes state their own answers. What any operation can answer beside them follows from its method,
path and parameters, and is added here, so that a new route has it by itself.
"""

import threading
from collections.abc import Iterator, Mapping
from typing import Any

from fastapi import FastAPI
from pydantic import BaseModel, ConfigDict, Field

from app.api.auth import OPEN
from app.api.cookies import NAME
from app.api.problems import MEDIA_TYPE
from app.settings import Settings

Schema = dict[str, Any]
BINARY: Schema = {"type": "string", "format": "binary"}
TEXT: Schema = {"type": "string"}
_VERBS = ("get", "put", "post", "patch", "delete")
_UNUSED_SCHEMAS = ("HTTPValidationError", "ValidationError")
_WRITES = frozenset(_VERBS) - {"get"}


class FieldProblem(BaseModel):
    """A field that is wrong, and what is valid there."""

    model_config = ConfigDict(extra="forbid")

    field: str
    detail: str


class Problem(BaseModel):
    """An error as a problem document of RFC 9457."""

    model_config = ConfigDict(extra="forbid")

    type: str
    title: str
    status: int = Field(ge=400, le=599)
    detail: str = Field(description="one sentence or two, naming what is valid")
    errors: list[FieldProblem] = Field(
        default_factory=list, description="the fields that are wrong, if single fields are"
    )
    state: str = Field(default="", description="the run's state, where that is in the way")


_SECONDS: Schema = {"type": "integer", "minimum": 1}
_RETRY = {"description": "seconds after which it is worth another try", "schema": _SECONDS}
_PROBLEMS: Mapping[int, tuple[str, str]] = {
    400: ("BadRequest", "The request could not be read."),
    401: ("Unauthorized", "It needs the operator, or the token is wrong."),
    403: (
        "Forbidden",
        "The request calls the server by a foreign name, or comes from a foreign page.",
    ),
    404: ("NotFound", "There is no such thing (any more)."),
    405: ("MethodNotAllowed", "The method is not possible here."),
    409: ("Conflict", "It cannot be done in the run's present state."),
    410: ("Gone", "The run that this Idempotency-Key started was deleted."),
    413: ("ContentTooLarge", "The request's body is too large."),
    415: ("UnsupportedMediaType", "The request's body is of a type that is not taken here."),
    422: ("UnprocessableContent", "A value cannot be; the detail says what can."),
    429: (
        "TooManyRequests",
        "It is too much, or there were too many wrong tokens; try again later.",
    ),
    500: ("InternalServerError", "Something broke in the server; its log says what."),
    503: ("ServiceUnavailable", "The server cannot do it at the moment; try again later."),
    507: ("InsufficientStorage", "There is no room for what is to be kept."),
}
"""By status the name of the answer in the description, and what it means."""
_HEADERS: Mapping[int, Schema] = {
    401: {"WWW-Authenticate": {"required": True, "schema": TEXT}},
    405: {"Allow": {"required": True, "schema": TEXT, "description": "methods, by comma"}},
    429: {"Retry-After": {"required": True, **_RETRY}},
    503: {"Retry-After": _RETRY},
}
LOCATION: Schema = {
    "Location": {"required": True, "schema": TEXT, "description": "path of the new run"}
}
ATTACHMENT: Schema = {
    "Content-Disposition": {"required": True, "schema": TEXT, "description": "a name for the file"}
}


def answers(
    status: int, forms: Mapping[str, Schema] | None = None, headers: Schema | None = None
) -> dict[int | str, Schema]:
    """A route's `responses` for what its response model does not say.

    Args:
        status: of the answer.
        forms: schemas by media type: beside JSON, or in place of it without a response model.
        headers: that it has.
    """
    found: Schema = {} if headers is None else {"headers": headers}
    if forms is not None:
        content = {media_type: {"schema": schema} for media_type, schema in forms.items()}
        found["content"] = content
    return {status: found}


def takes_file(*media_types: str) -> Schema:
    """A route's `openapi_extra` for a request whose body is a file."""
    content = {media_type: {"schema": BINARY} for media_type in media_types}
    return {"requestBody": {"content": content, "required": True}}


def install(app: FastAPI, agents: tuple[str, ...], settings: Settings) -> None:
    """Complete the app's description, whenever it is first asked for.

    Args:
        app: with all its routes.
        agents: the names that are registered.
        settings: say who needs the token.
    """
    described, making = app.openapi, threading.Lock()
    finished: list[Schema] = []

    def openapi() -> Schema:
        with making:
            if not finished:
                finished.append(_completed(described(), agents, settings))
            return finished[0]

    app.openapi = openapi  # type: ignore[method-assign]


def _completed(schema: Schema, agents: tuple[str, ...], settings: Settings) -> Schema:
    components = schema.setdefault("components", {})
    schemas = components.setdefault("schemas", {})
    made = Problem.model_json_schema(ref_template="#/components/schemas/{model}")
    schemas |= made.pop("$defs")
    schemas["Problem"] = made
    for name in _UNUSED_SCHEMAS:
        schemas.pop(name, None)
    components["responses"] = {name: _problem(status) for status, (name, _) in _PROBLEMS.items()}
    for method, path, operation in operations(schema):
        given = {k: v for k, v in operation["responses"].items() if int(k) < 400}
        extra = {s for s in operation["responses"] if int(s) >= 400 and s != "422"}
        statuses = sorted({*problems_of(method, path, operation), *map(int, extra)})
        problems = {str(s): {"$ref": f"#/components/responses/{_PROBLEMS[s][0]}"} for s in statuses}
        operation["responses"] = given | problems
    _link_runs(schema)
    _name_agents(schemas, agents)
    _add_security(schema, settings)
    return schema


def operations(schema: Schema) -> Iterator[tuple[str, str, Schema]]:
    """Each operation with its method, in lower case, and its path."""
    for path, methods in schema["paths"].items():
        for method in _VERBS:
            if method in methods:
                yield method, path, methods[method]


def problems_of(method: str, path: str, operation: Mapping[str, Any]) -> set[int]:
    """The statuses of all errors that an operation can answer by what it is."""
    # By the guards before it, by the store behind it, and by defects.
    statuses = {400, 401, 403, 429, 500, 503}
    parameters = [parameter["name"] for parameter in operation.get("parameters", ())]
    if parameters:
        statuses |= {422}
    if "{" in path or "run_id" in parameters:
        statuses |= {404}
    if "}/" in path:
        # What belongs to a run is there in some of its states only.
        statuses |= {409}
    if method in _WRITES:
        statuses |= {409, 422, 507}
    if "requestBody" in operation:
        statuses |= {404, 413, 415}
    if "Idempotency-Key" in map(str.title, parameters):
        statuses |= {410}
    return statuses


def _problem(status: int) -> Schema:
    found: Schema = {
        "description": _PROBLEMS[status][1],
        "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}},
    }
    return found | ({"headers": _HEADERS[status]} if status in _HEADERS else {})


def _link_runs(schema: Schema) -> None:
    """Lead from a run that was started to all that can be done with it."""
    for path, methods in schema["paths"].items():
        started = methods.get("post", {}).get("responses", {}).get("202")
        if started is not None and "{" not in path:
            started["links"] = {
                operation["operationId"]: {
                    "operationId": operation["operationId"],
                    "parameters": {"run_id": "$response.body#/id"},
                }
                for _, of_run, operation in operations(schema)
                if of_run.startswith(f"{path}/{{run_id}}")
            }


def _name_agents(schemas: Schema, agents: tuple[str, ...]) -> None:
    """Which agents there are is known when the server starts."""
    for kind in schemas["ExperimentBody"]["properties"]["agents"]["anyOf"]:
        named = kind.get("items", kind)
        if named.get("type") == "string":
            named["enum"] = list(agents)


def _add_security(schema: Schema, settings: Settings) -> None:
    schema["components"]["securitySchemes"] = {
        "bearer": {"type": "http", "scheme": "bearer", "description": "the server's token"},
        "cookie": {
            "type": "apiKey",
            "in": "cookie",
            "name": f"{NAME}_{settings.port}",
            "description": "set by opening the page once with ?token=… in its address; the name "
            "ends with the port of that address, and begins with __Host- over HTTPS",
        },
    }
    operator: list[Schema] = [{"bearer": []}, {"cookie": []}]
    for method, path, operation in operations(schema):
        needs_token = settings.token is not None and (
            method in _WRITES or (settings.spectators != "public" and path not in OPEN)
        )
        operation["security"] = operator if needs_token else [*operator, {}]
