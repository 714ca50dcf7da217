"""Completes the OpenAPI document: problem responses, security schemes, links, agent names.

Routes declare their own successful responses. The problem responses of an operation are derived
here from its policy, parameters and body, so that a new route has them without declaring them.
"""

import threading
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from typing import Any

from fastapi import FastAPI
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from app.api.cookies import NAME
from app.api.event_answers import event_bodies
from app.api.identity import IdentityProvider
from app.api.policy import Access, RoutePolicy, policies
from app.api.problem_types import FOLDER, TYPES
from app.api.problems import MEDIA_TYPE
from app.api.shared_schemas import name_body, name_schemas, share, shared_schemas
from app.feature import Feature
from app.settings import Settings

Schema = dict[str, Any]
BINARY: Schema = {"type": "string", "format": "binary"}
TEXT: Schema = {"type": "string"}
_REFERENCE = "#/components/schemas/{model}"
_METHODS = ("get", "put", "post", "patch", "delete")
_UNUSED_SCHEMAS = ("HTTPValidationError", "ValidationError")


class FieldProblem(BaseModel):
    """An invalid field, and its valid values."""

    model_config = ConfigDict(extra="forbid")

    field: str
    detail: str


class ProblemDetails(BaseModel):
    """An error as a problem document of RFC 9457."""

    model_config = ConfigDict(extra="forbid")

    type: str = Field(
        description="what kind of error it is, by which a client can branch: the path of a page, "
        f"one of {', '.join(FOLDER + name for name in TYPES)}"
    )
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
        "The request calls the server by a foreign name, comes from a foreign page, or is not open "
        "to this client; the detail says why.",
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
    # OpenAPI 3.1 has no schema of one event, and few generators read 3.2, which has.
    about = f"events, of which each has the JSON of the property of `{name}` by its name as data"
    content = {"text/event-stream": {"schema": {**TEXT, "description": about}}}
    return {"responses": {"200": {"content": content}}}


_generated: dict[tuple[tuple[str, ...], tuple[type[Feature], ...], int], Schema] = {}
"""Cache of FastAPI's description of the API by agents, features and number of routes."""
_lock = threading.Lock()


def install(
    app: FastAPI,
    agents: tuple[str, ...],
    settings: Settings,
    features: tuple[type[Feature], ...],
    providers: Sequence[IdentityProvider],
) -> None:
    """Make the app complete its OpenAPI document on first use, and cache it.

    Args:
        app: the app, with all its routes.
        agents: names of the registered agents.
        settings: decide which operations need the token.
        features: those of the app.
        providers: know who may use operations without it.
    """
    generate, cache = app.openapi, list[Schema]()

    def openapi() -> Schema:
        with _lock:
            if not cache:
                key = (agents, features, len(app.routes))
                if key not in _generated:
                    _generated[key] = generate()
                schema = _completed(deepcopy(_generated[key]), features, policies(app))
                _add_security(schema, policies(app), settings, providers)
                cache.append(schema)
            return cache[0]

    app.openapi = openapi  # type: ignore[method-assign]


def _completed(
    schema: Schema,
    features: tuple[type[Feature], ...],
    by_operation: Mapping[tuple[str, str], RoutePolicy],
) -> Schema:
    components = schema.setdefault("components", {})
    schemas = components.setdefault("schemas", {})
    # FastAPI finds neither: routes do not declare errors, and events are sent as text.
    for name, model in (("Problem", ProblemDetails), ("EventBodies", event_bodies(features))):
        described = TypeAdapter[Any](model).json_schema(
            ref_template=_REFERENCE, mode="serialization"
        )
        schemas |= described.pop("$defs")
        schemas[name] = described
    for feature in features:
        feature.complete_schema(schemas)
    for name in _UNUSED_SCHEMAS:
        schemas.pop(name, None)
    components["responses"] = {name: _problem(status) for status, (name, _) in _PROBLEMS.items()}
    for method, path, operation in operations(schema):
        successes = {k: v for k, v in operation["responses"].items() if int(k) < 400}
        extra = {s for s in operation["responses"] if int(s) >= 400 and s != "422"}
        of_route = by_operation[method, path]
        statuses = sorted({*problems_of(operation, of_route), *map(int, extra)})
        problems = {str(s): {"$ref": f"#/components/responses/{_PROBLEMS[s][0]}"} for s in statuses}
        operation["responses"] = successes | problems
        name_body(operation)
    _link_runs(schema)
    share(schema, shared_schemas())
    name_schemas(schemas)
    return schema


def operations(schema: Schema) -> Iterator[tuple[str, str, Schema]]:
    """Yield (method in lower case, path, operation) for each operation."""
    for path, methods in schema["paths"].items():
        for method in _METHODS:
            if method in methods:
                yield method, path, methods[method]


def problems_of(operation: Mapping[str, Any], policy: RoutePolicy) -> set[int]:
    """Return the error statuses of an operation, by its policy, parameters and body."""
    # From what is before all routes (wrong hosts, too many wrong tokens, no free slot), from the
    # store, and from defects.
    statuses = {400, 403, 429, 500, 503}
    parameters = operation.get("parameters", ())
    if policy.access.spectators != "always":
        statuses |= {401}
    if parameters:
        statuses |= {422}
    if any(parameter["in"] == "path" for parameter in parameters):
        statuses |= {404, 409} if policy.depends_on_state else {404}
    if not policy.access.is_read:
        statuses |= {409, 422, 507}
    if "requestBody" in operation:
        statuses |= {404, 413, 415}
    if policy.starts and any(parameter["name"] == "idempotency-key" for parameter in parameters):
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


def _add_security(
    schema: Schema,
    by_operation: Mapping[tuple[str, str], RoutePolicy],
    settings: Settings,
    providers: Sequence[IdentityProvider],
) -> None:
    schema["components"]["securitySchemes"] = {
        "bearer": {"type": "http", "scheme": "bearer", "description": "the server's token"},
        "cookie": {
            "type": "apiKey",
            "in": "cookie",
            "name": f"{NAME}_{settings.port}",
            "description": "set by opening the page once with ?token=… in its address; the name "
            "ends with the port and path of that address, and begins with __Host- over HTTPS, or "
            "__Secure- below a path",
        },
        **dict(provider.scheme for provider in providers),
    }
    for method, path, operation in operations(schema):
        access = by_operation[method, path].access
        operation["security"] = _requirements(access, settings, providers)


def _requirements(
    access: Access, settings: Settings, providers: Sequence[IdentityProvider]
) -> list[Schema]:
    """Return by what an operation can be used; an empty requirement means nothing is needed."""
    alternatives = [
        requirement for provider in providers for requirement in provider.requirements(access)
    ]
    if not access.is_for_operators:
        return alternatives
    is_public = settings.spectators == "public"
    is_open = settings.token is None or access.admits_spectators(is_public=is_public)
    return [{"bearer": []}, {"cookie": []}, *([{}] if is_open else alternatives)]
