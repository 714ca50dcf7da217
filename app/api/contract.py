"""Completes the OpenAPI document: problem responses, security schemes, links, agent names.

Routes declare their own successful responses. The problem responses of an operation are derived
here from its method, path and parameters, so that a new route has them without declaring them.
"""

import threading
from collections.abc import Iterator, Mapping
from copy import deepcopy
from typing import Any

from fastapi import FastAPI
from pydantic import BaseModel, ConfigDict, Field

from app.api.auth import PUBLIC_PATHS
from app.api.cookies import NAME, ROOM_NAME, VISITOR_NAME
from app.api.event_answers import EventBodies
from app.api.problems import MEDIA_TYPE
from app.api.rate_limit import QUESTIONS
from app.api.room_access import OF_BOTH, OF_PARTICIPANTS, OPEN_TO_ALL
from app.api.visitor_access import OF_OWN_RUNS, STARTS
from app.classroom import lesson
from app.settings import Settings

Schema = dict[str, Any]
BINARY: Schema = {"type": "string", "format": "binary"}
TEXT: Schema = {"type": "string"}
_REFERENCE = "#/components/schemas/{model}"
_METHODS = ("get", "put", "post", "patch", "delete")
_GIVEN_REFERENCE = "#/components/schemas/Given{model}"
"""Of a lesson's parts as they are sent, in which more may be left out than in answers."""
GIVEN_LESSON: Schema = {"$ref": _GIVEN_REFERENCE.format(model="Lesson")}
_UNUSED_SCHEMAS = ("HTTPValidationError", "ValidationError")
_WRITE_METHODS = frozenset(_METHODS) - {"get"}


class FieldProblem(BaseModel):
    """An invalid field, and its valid values."""

    model_config = ConfigDict(extra="forbid")

    field: str
    detail: str


class ProblemDetails(BaseModel):
    """An error as a problem document of RFC 9457."""

    model_config = ConfigDict(extra="forbid")

    type: str
    title: str
    status: int = Field(ge=400, le=599)
    detail: str = Field(description="one sentence or two, naming what is valid")
    errors: list[FieldProblem] = Field(
        default_factory=list, description="the fields whose values are wrong by themselves"
    )
    field: str = Field(
        default="", description="the field that is in the way, where that depends on others"
    )
    state: str = Field(default="", description="the run's state, where that is in the way")
    legs: list[int] = Field(
        default_factory=list, description="numbers of the legs that cannot be so, if legs are"
    )


_SECONDS: Schema = {"type": "integer", "minimum": 1}
_RETRY = {"description": "seconds after which it is worth another try", "schema": _SECONDS}
_PROBLEMS: Mapping[int, tuple[str, str]] = {
    400: ("BadRequest", "The request could not be read."),
    401: ("Unauthorized", "It needs the operator, or the token is wrong."),
    403: (
        "Forbidden",
        "The request calls the server by a foreign name, comes from a foreign page, or is none "
        "that a participant's card, or the demo to its visitors, allows.",
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
"""By status: the name of the response component, and its description."""
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
    """Return a route's `responses` argument: media types and headers beside its response model.

    Args:
        status: of the response.
        forms: schemas by media type, besides JSON; instead of JSON without a response model.
        headers: schemas of the response headers.
    """
    response: Schema = {} if headers is None else {"headers": headers}
    if forms is not None:
        content = {media_type: {"schema": schema} for media_type, schema in forms.items()}
        response["content"] = content
    return {status: response}


def takes_file(*media_types: str) -> Schema:
    """Return a route's `openapi_extra` argument for a request whose body is a file."""
    content = {media_type: {"schema": BINARY} for media_type in media_types}
    return {"requestBody": {"content": content, "required": True}}


def sends_events(name: str) -> Schema:
    """Return a route's `openapi_extra` argument for a stream of events.

    Args:
        name: of the schema that has the JSON of each event's data, by the event's name.
    """
    data = {"contentMediaType": "application/json", "description": f"a property of `{name}`"}
    content = {"text/event-stream": {"itemSchema": {"properties": {"data": data}}}}
    return {"responses": {"200": {"content": content}}}


_generated: dict[tuple[tuple[str, ...], int], Schema] = {}
"""Cache of FastAPI's OpenAPI description by agents and number of routes; equal for all apps."""
_lock = threading.Lock()


def install(app: FastAPI, agents: tuple[str, ...], settings: Settings) -> None:
    """Make the app complete its OpenAPI document on first use, and cache it.

    Args:
        app: the app, with all its routes.
        agents: names of the registered agents.
        settings: decide which operations need the token.
    """
    generate, cache = app.openapi, list[Schema]()

    def openapi() -> Schema:
        with _lock:
            if not cache:
                key = (agents, len(app.routes))
                if key not in _generated:
                    _generated[key] = generate()
                cache.append(_completed(deepcopy(_generated[key]), agents, settings))
            return cache[0]

    app.openapi = openapi  # type: ignore[method-assign]


def _completed(schema: Schema, agents: tuple[str, ...], settings: Settings) -> Schema:
    components = schema.setdefault("components", {})
    schemas = components.setdefault("schemas", {})
    # FastAPI finds neither: routes do not declare errors, and events are sent as text.
    for name, model in (("Problem", ProblemDetails), ("EventBodies", EventBodies)):
        described = model.model_json_schema(ref_template=_REFERENCE, mode="serialization")
        schemas |= described.pop("$defs")
        schemas[name] = described
    given = lesson.adapter().json_schema(ref_template=_GIVEN_REFERENCE)
    parts = given.pop("$defs") | {"Lesson": given}
    schemas |= {f"Given{name}": one for name, one in parts.items()}
    for name in _UNUSED_SCHEMAS:
        schemas.pop(name, None)
    components["responses"] = {name: _problem(status) for status, (name, _) in _PROBLEMS.items()}
    for method, path, operation in operations(schema):
        successes = {k: v for k, v in operation["responses"].items() if int(k) < 400}
        extra = {s for s in operation["responses"] if int(s) >= 400 and s != "422"}
        statuses = sorted({*problems_of(method, path, operation), *map(int, extra)})
        problems = {str(s): {"$ref": f"#/components/responses/{_PROBLEMS[s][0]}"} for s in statuses}
        operation["responses"] = successes | problems
    _link_runs(schema)
    _name_agents(schemas, agents)
    _add_security(schema, settings)
    return schema


def operations(schema: Schema) -> Iterator[tuple[str, str, Schema]]:
    """Yield (method in lower case, path, operation) for each operation."""
    for path, methods in schema["paths"].items():
        for method in _METHODS:
            if method in methods:
                yield method, path, methods[method]


def problems_of(method: str, path: str, operation: Mapping[str, Any]) -> set[int]:
    """Return the error statuses of an operation, derived from method, path and parameters."""
    # From middleware, from the store, and from defects.
    statuses = {400, 401, 403, 429, 500, 503}
    parameters = [parameter["name"] for parameter in operation.get("parameters", ())]
    if parameters:
        statuses |= {422}
    if "{" in path or "run_id" in parameters:
        statuses |= {404}
    if "}/" in path:
        # Subresources of a run exist only in some of its states.
        statuses |= {409}
    if method in _WRITE_METHODS:
        statuses |= {409, 422, 507}
    if "requestBody" in operation:
        statuses |= {404, 413, 415}
    if "idempotency-key" in parameters and "/rooms/" not in path:
        statuses |= {410}  # the run was deleted
    return statuses


def _problem(status: int) -> Schema:
    response: Schema = {
        "description": _PROBLEMS[status][1],
        "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}},
    }
    return response | ({"headers": _HEADERS[status]} if status in _HEADERS else {})


def _link_runs(schema: Schema) -> None:
    """Add OpenAPI links from each start response to the operations on the new run."""
    for path, methods in schema["paths"].items():
        response = methods.get("post", {}).get("responses", {}).get("202")
        if response is not None and "{" not in path:
            response["links"] = {
                operation["operationId"]: {
                    "operationId": operation["operationId"],
                    "parameters": {"run_id": "$response.body#/id"},
                }
                for _, of_run, operation in operations(schema)
                if of_run.startswith(f"{path}/{{run_id}}")
            }


def _name_agents(schemas: Schema, agents: tuple[str, ...]) -> None:
    """Enumerate the registered agents, which are known only when the server starts."""
    for alternative in schemas["ExperimentBody"]["properties"]["agents"]["anyOf"]:
        item = alternative.get("items", alternative)
        if item.get("type") == "string":
            item["enum"] = list(agents)


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
        "participant": {
            "type": "apiKey",
            "in": "cookie",
            "name": f"{ROOM_NAME}_{settings.port}_CODE",
            "description": "set by joining a room; its name ends with the code of the room",
        },
        **({"visitor": _of_visitors(settings)} if settings.demo else {}),
    }
    operator: list[Schema] = [{"bearer": []}, {"cookie": []}]
    for method, path, operation in operations(schema):
        needs_token = settings.token is not None and (
            (method in _WRITE_METHODS and path not in QUESTIONS)
            or (settings.spectators != "public" and path not in PUBLIC_PATHS)
        )
        if (method, path) in OF_PARTICIPANTS:
            operation["security"] = [{"participant": []}]
        elif needs_token and (method, path) in OF_BOTH:
            operation["security"] = [*operator, {"participant": []}]
        elif needs_token and (method, path) not in OPEN_TO_ALL:
            operation["security"] = operator
            if settings.demo and (method, path) in STARTS:
                # Without the cookie the start sets one.
                operation["security"] = [*operator, {"visitor": []}, {}]
            elif settings.demo and (method, path) in OF_OWN_RUNS:
                operation["security"] = [*operator, {"visitor": []}]
        else:
            operation["security"] = [*operator, {}]


def _of_visitors(settings: Settings) -> Schema:
    return {
        "type": "apiKey",
        "in": "cookie",
        "name": f"{VISITOR_NAME}_{settings.port}",
        "description": "set by the first start of a visitor; it opens their own runs to them",
    }
