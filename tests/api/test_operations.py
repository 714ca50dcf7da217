"""Rate limits, metrics and idempotency keys."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from prometheus_client.parser import text_string_to_metric_families
from starlette.testclient import TestClient

from app.api.auth import WRONG_TOKENS
from app.api.deps import Services
from app.server import create_app
from app.settings import Settings
from app.storage.errors import Busy
from hexapods.domain.robot_documents import ID_DIGITS
from tests.api.calls import ADDRESS, WALK, Api, refused
from tests.features.needing import needs
from tests.storage.stores import temporary_store

TOKEN = "a-token-for-tests"
Serve = Callable[..., Api]


@needs("exports")
def test_starts_per_minute_are_limited_by_address(serve: Serve) -> None:
    api = serve(starts_per_minute=3)
    for _ in range(3):
        refused(api.call("POST", "/trainings", json={"steps": 0}), 422)
    for path in ("/trainings", "/races", "/trainings/import", "/trainings/x/resume"):
        answer = api.call("POST", path, json={})
        refused(answer, 429, "3 times a minute", "HEXAPODS_STARTS_PER_MINUTE")
        assert 1 <= int(answer.headers["retry-after"]) <= 20
    refused(api.call("GET", "/runs/x/page"), 429)
    for method, path in (("GET", "/trainings"), ("POST", "/trainings/x/stop"), ("PUT", "/stage")):
        assert api.call(method, path, json={}).status_code != 429


_START = (
    *("/resume", "/video", "/robots", "/rooms", "/rooms/{code}/runs", "/rooms/{code}/teaching"),
    "/tournaments",
)
"""Ends of paths that start something without an idempotency key."""


def test_every_route_that_starts_something_is_limited(serve: Serve) -> None:
    api = serve(starts_per_minute=1)
    refused(api.call("POST", "/trainings", json={"steps": 0}), 422)
    starts, limited = set(), set()
    for path, methods in api.client.get("/openapi.json").json()["paths"].items():
        if "post" not in methods:
            continue
        headers = {parameter["name"] for parameter in methods["post"].get("parameters", ())}
        # Joins of rooms have a limit of their own.
        if ("idempotency-key" in headers and "/rooms/" not in path) or path.endswith(_START):
            starts.add(path)
        address = path.replace("{run_id}", "x").replace("{robot_id}", "0" * ID_DIGITS)
        if api.client.post(address, json={}).status_code == 429:
            limited.add(path)
    assert "/api/v1/runs/{run_id}/again" in starts
    assert limited == starts


@needs("exports")
def test_spectators_have_a_token_bucket_of_their_own(serve: Serve) -> None:
    api = serve(starts_per_minute=1, token=TOKEN)
    refused(api.call("GET", "/runs/x/page"), 404)
    refused(api.call("GET", "/runs/x/page"), 429)
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    refused(api.call("POST", "/trainings", json={"steps": 0}, headers=bearer), 422)


def test_wrong_tokens_are_rate_limited(serve: Serve) -> None:
    client = serve(token=TOKEN).client
    wrong = {"Authorization": "Bearer not-this-one"}
    for number in range(WRONG_TOKENS):
        how: Any = {"params": {"token": "no"}} if number % 2 else {"headers": wrong}
        client.cookies.clear()
        assert client.get("/", **how).status_code == (401 if number % 2 else 200)
    right = {"Authorization": f"Bearer {TOKEN}"}
    for answer in (
        client.put("/api/v1/stage", json={}, headers=wrong),
        client.get("/", params={"token": "no"}),
    ):
        refused(answer, 429, "wrong tokens")
        assert int(answer.headers["retry-after"]) <= 5
    assert client.get("/api/v1/stage").status_code == 200
    # Others at the operator's address must not be able to lock the operator out.
    assert client.put("/api/v1/stage", json={}, headers=right).status_code == 200
    assert client.get("/", params={"token": TOKEN}).status_code == 303


def test_session_works_in_spite_of_wrong_guesses_from_its_address(serve: Serve) -> None:
    client = serve(token=TOKEN).client
    assert client.get("/", params={"token": TOKEN}).status_code == 303
    for _ in range(2 * WRONG_TOKENS):
        client.get("/healthz", headers={"Authorization": "Bearer not-this-one"})
    assert client.put("/api/v1/stage", json={"playing": True}).status_code == 200


def test_metrics_have_the_prometheus_format(api: Api, trained: dict[str, Any]) -> None:
    answer = api.client.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain")
    samples = {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }
    assert samples["hexapods_runs", "finished"] >= 1
    assert samples["hexapods_runs", "paused"] == 0
    assert samples["hexapods_steps_total",] >= trained["progress"]["done"]
    for name in ("steps_per_second", "queue_depth", "viewers", "pieces_total"):
        assert samples[f"hexapods_{name}",] >= 0
    assert samples["process_start_time_seconds",] > 0


def test_metrics_are_readable_by_spectators(serve: Serve) -> None:
    assert serve(token=TOKEN).client.get("/metrics").status_code == 200
    refused(serve(token=TOKEN, spectators="token").client.get("/metrics"), 401)


def test_invalid_idempotency_key_is_refused(api: Api) -> None:
    for key in ("", "a b", "x" * 201):
        headers = {"Idempotency-Key": key}
        refused(api.call("POST", "/trainings", json=WALK, headers=headers), 422, "idempotency-key")


def test_long_requests_end_with_the_server(tmp_path: Path) -> None:
    with temporary_store() as store:
        app = create_app(Settings(data=tmp_path), store)
        with TestClient(app, base_url=ADDRESS):
            services: Services = app.state.services
        with pytest.raises(Busy, match="the server is stopping"):
            services.stopping.check()
