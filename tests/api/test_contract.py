"""OpenAPI document: it describes every route and response, and real responses match it."""

import re
from collections.abc import Callable, Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from pydantic import TypeAdapter

from app.api.answers import TrainingPage
from app.api.contract import operations, problems_of
from app.api.deps import Services
from app.api.event_answers import event_bodies
from app.api.options import options_view
from app.api.policy import OPERATOR, PUBLIC, WATCH_RUN, MissingPolicy, RoutePolicy, policies, policy
from app.api.problem_types import TYPES
from app.api.recorded_answers import CurveView, QTableView, RecordingView
from app.api.run_views import RunPage
from app.events.run_view import RaceView, TrainingView
from app.feature import stage_members
from app.installed_features import load
from app.server import create_app
from app.settings import Settings
from app.stage.stage_view import stage_view
from app.stage.timeline import TimelineView
from tests.api.calls import WALK, Api
from tests.features.needing import needs
from tests.storage.stores import temporary_store

PAGES = {
    *("/", "/compare", "/docs", "/experiments", "/favicon.ico", "/guide", "/guide/{name}"),
    *(
        "/l/{lesson_id}",
        "/l/{lesson_id}/sheet",
        "/lessons",
        "/openapi.json",
        "/r/{code}",
        "/problems",
        "/problems/{name}",
    ),
    *("/r/{code}/", "/robots.txt", "/runs", "/static", "/t/{tournament_id}", "/viewer", "/viewer/"),
}
"""Pages for browsers, which are no part of the API."""
Serve = Callable[..., Api]


@pytest.fixture(scope="module")
def app() -> Iterator[FastAPI]:
    with temporary_store() as store:
        yield create_app(Settings(data=Path("unused")), store)


@pytest.fixture(scope="module")
def described(app: FastAPI) -> dict[str, Any]:
    return app.openapi()


def resolved(described: dict[str, Any], answer: dict[str, Any]) -> dict[str, Any]:
    """Resolve a reference to a response component."""
    if "$ref" not in answer:
        return answer
    component: dict[str, Any] = described["components"]["responses"][
        answer["$ref"].rpartition("/")[2]
    ]
    return component


def test_every_route_is_described(app: FastAPI, described: dict[str, Any]) -> None:
    routes = {
        (method.lower(), re.sub(":(path|robot)", "", context.path))
        for context in iter_route_contexts(app.routes)
        if context.path and context.path not in PAGES
        for method in set(context.methods or ()) - {"HEAD"}
    }
    assert len(routes) > 40
    assert {(method, path) for method, path, _ in operations(described)} == routes


def test_every_operation_describes_all_its_responses(
    app: FastAPI, described: dict[str, Any]
) -> None:
    by_operation = policies(app)
    for method, path, operation in operations(described):
        said = {int(status) for status in operation["responses"]}
        assert problems_of(operation, by_operation[method, path]) <= said, path
        assert [status for status in said if 200 <= status < 300], path
        for status, answer in operation["responses"].items():
            content = resolved(described, answer).get("content", {})
            if status == "204":
                assert content == {}
                continue
            assert content, (path, status)
            is_problem = int(status) >= 400
            assert is_problem == (list(content) == ["application/problem+json"]), (path, status)
            for media_type, form in content.items():
                assert form["schema"], (path, status, media_type)


def test_the_policy_says_with_which_statuses_a_route_can_refuse() -> None:
    of_run = {"parameters": [{"name": "run_id", "in": "path"}]}
    always = {400, 403, 429, 500, 503}
    assert problems_of({}, RoutePolicy(access=PUBLIC)) == always
    assert problems_of(of_run, RoutePolicy(access=WATCH_RUN)) == always | {401, 404, 409, 422}
    itself = RoutePolicy(access=WATCH_RUN, depends_on_state=False)
    assert problems_of(of_run, itself) == always | {401, 404, 422}
    changed = always | {401, 409, 422, 507}
    assert problems_of({}, RoutePolicy(access=OPERATOR)) == changed
    with_body = {"requestBody": {}, "parameters": [{"name": "idempotency-key", "in": "header"}]}
    assert problems_of(with_body, RoutePolicy(access=OPERATOR)) == changed | {404, 413, 415}
    starts = RoutePolicy(access=OPERATOR, starts=True)
    assert problems_of(with_body, starts) == changed | {404, 410, 413, 415}


def test_every_error_status_is_described(described: dict[str, Any]) -> None:
    statuses = {
        problem["content"]["application/problem+json"]["schema"]["$ref"]
        for problem in described["components"]["responses"].values()
    }
    assert statuses == {"#/components/schemas/Problem"}
    everywhere = {
        status for _, _, operation in operations(described) for status in operation["responses"]
    }
    described_errors = {int(status) for status in everywhere if status >= "400"}
    # These are refused before there is an operation: another method, a long address, a large head.
    assert {kind.status for kind in TYPES.values()} - described_errors == {405, 414, 431}
    assert described_errors <= {kind.status for kind in TYPES.values()}


def test_new_route_gets_its_problem_responses(serve: Serve) -> None:
    app = serve().client.app
    assert isinstance(app, FastAPI)

    @app.put("/api/v1/new/{thing}/part")
    @policy(access=OPERATOR)
    def put_part(thing: str, body: dict[str, int]) -> None:
        """A route without declared errors."""

    operation = app.openapi()["paths"]["/api/v1/new/{thing}/part"]["put"]
    errors = {int(status) for status in operation["responses"] if int(status) >= 400}
    assert errors == {400, 401, 403, 404, 409, 413, 415, 422, 429, 500, 503, 507}
    assert operation["responses"]["422"]["$ref"].endswith("/UnprocessableContent")


def test_a_route_without_a_policy_cannot_be_defined(serve: Serve) -> None:
    app = serve().client.app
    assert isinstance(app, FastAPI)
    with pytest.raises(MissingPolicy, match="/api/v1/new has no policy"):

        @app.get("/api/v1/new")
        def get_new() -> None:
            """A route whose author has not said who may use it."""


def test_only_what_may_refuse_strangers_describes_that(described: dict[str, Any]) -> None:
    probe = described["paths"]["/healthz"]["get"]["responses"]
    assert "401" not in probe
    assert {"403", "429"} <= set(probe), "a wrong host, too many wrong tokens"
    assert "401" in described["paths"]["/metrics"]["get"]["responses"]


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"token": "a-token-for-tests"},
        {"token": "a-token-for-tests", "spectators": "token"},
    ],
)
@needs("classroom", "demo", "tournaments")
def test_security_requirements_are_described(serve: Serve, settings: dict[str, Any]) -> None:
    api = serve(**settings)
    bearer = {"Authorization": "Bearer a-token-for-tests"} if settings else {}
    described = api.client.get("/openapi.json", headers=bearer).json()
    assert set(described["components"]["securitySchemes"]) == {"bearer", "cookie", "participant"}
    assert isinstance(api.client.app, FastAPI)
    by_operation = policies(api.client.app)
    is_public = settings.get("spectators") != "token"
    for method, path, operation in operations(described):
        is_free = {} in operation["security"]
        access = by_operation[method, path].access
        if not access.is_for_operators:
            assert operation["security"] == [{"participant": []}]
        else:
            may_watch = access.admits_spectators(is_public=is_public)
            assert is_free == (may_watch or not settings), path
            if path.endswith("/entries") and settings:
                assert {"participant": []} in operation["security"]
            if path != "/api/v1/events":  # it has no end
                answer = api.client.request(method, path.replace("{run_id}", "none"))
                assert (answer.status_code != 401) == is_free, path


@needs("experiments")
def test_starts_have_location_and_links(
    described: dict[str, Any],
) -> None:
    for kind in ("training", "race", "experiment"):
        started = described["paths"][f"/api/v1/{kind}s"]["post"]["responses"]["202"]
        assert started["headers"]["Location"]["required"]
        assert len(started["links"]) >= 6
    too_many = described["components"]["responses"]["TooManyRequests"]
    assert too_many["headers"]["Retry-After"]["required"]


def test_metrics_are_described_in_their_media_types(api: Api, described: dict[str, Any]) -> None:
    forms = described["paths"]["/metrics"]["get"]["responses"]["200"]["content"]
    for accept in ("", "application/openmetrics-text; version=1.0.0", "text/html", "a/b;version=x"):
        answer = api.client.get("/metrics", headers={"Accept": accept})
        assert answer.status_code == 200
        assert answer.headers["content-type"].partition(";")[0] in {
            form.partition(";")[0] for form in forms
        }


def real_responses(api: Api, training: dict[str, Any]) -> Iterator[tuple[Any, Any]]:
    """Yield (response model, response) for responses of all kinds."""
    race = api.race(
        lanes=[{"agent": "greedy"}, {"agent": "q-learning", "training_id": training["id"]}], steps=3
    )
    yield RaceView, race
    yield RaceView, api.finished(race)
    yield TrainingView, api.train(gait={"right_leg": 1, "left_leg": 2, "symmetry": "vertical"})
    changed = api.slow_training(
        robot={"preset": "stiff", "n_legs": 8, "friction": 0.5}, divisions=2
    )
    yield TrainingView, api.call("PATCH", f"/trainings/{changed['id']}", json={"pace": 30}).json()
    yield TrainingView, api.tell(changed, "pause").json()
    yield TrainingView, api.tell(changed, "stop").json()
    yield TrainingView, training
    yield TrainingPage, api.get("/trainings")
    yield RunPage, api.get("/runs")
    yield CurveView, api.get(f"/trainings/{training['id']}/curve")
    yield QTableView, api.get(f"/trainings/{training['id']}/q-table")
    yield RecordingView, api.get(f"/races/{race['id']}/recording")
    for clock in ("paper", "wall", "free"):
        yield TimelineView, api.get(f"/races/{race['id']}/timeline?clock={clock}")
    yield stage_view(tuple(stage_members(load().classes).items())), api.get("/stage")
    yield options_view(load().classes), api.get("/options")


def test_real_responses_match_their_models(api: Api, trained: dict[str, Any]) -> None:
    count = 0
    for model, answer in real_responses(api, trained):
        TypeAdapter(model).validate_python(answer)
        count += 1
    assert count > 16


@needs("classroom", "experiments", "tournaments")
def test_real_events_match_their_models(api: Api, trained: dict[str, Any]) -> None:
    assert isinstance(api.client.app, FastAPI)
    services: Services = api.client.app.state.services
    subscription = services.bus.subscribe(has_picture=True)
    services.stages[0].count_viewer(1)
    run = api.slow_training()
    api.call("PATCH", f"/trainings/{run['id']}", json={"pace": 30, "settings": {"alpha": 0.5}})
    limp = {"kind": "limp", "legs": [1]}
    api.call("POST", f"/trainings/{run['id']}/disturbances", json=limp)
    api.tell(run, "stop")
    api.finished(api.train(steps=100, evaluate_every=50))
    api.finished(api.race(lanes=[{"agent": "q-learning", "training_id": trained["id"]}], steps=3))
    body = {"experiment": "sweep", "seeds": 2, "steps": 20, "gaits": "left-right-origin"}
    api.finished(api.start("/experiments", {**body, "simulator": "kinematic", "workers": 1}))
    api.ended(run)
    api.call("DELETE", f"/trainings/{run['id']}")
    services.publish_robots()
    opened = api.call("POST", "/tournaments", json={"rules": {**WALK, "draws": 5}}).json()
    api.call("DELETE", f"/tournaments/{opened['id']}")

    snapshot = api.call("GET", "/events/snapshot").text
    bodies = event_bodies(load().classes)
    members: list[Any] = [*fields(bodies)]
    models = {bodies.json_names.get(member.name, member.name): member.type for member in members}
    events = subscription.drain()
    subscription.close()
    received = {event.event for event in events}
    # Each stream has a clock of its own, and a room a stage, on which a class teaches.
    assert received | {"snapshot", "clock", "room", "teaching"} == set(models)
    for name, data in [
        ("snapshot", snapshot),
        *((event.event, event.data) for event in events),
    ]:
        TypeAdapter(models[name]).validate_json(data)
