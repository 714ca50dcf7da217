"""Rate limits and metrics."""

from collections.abc import Callable
from typing import Any

from prometheus_client.parser import text_string_to_metric_families

from app.api.auth import WRONG_TOKENS
from tests.api.calls import WALK, Api, refused

TOKEN = "a-token-for-tests"
Serve = Callable[..., Api]


def test_an_address_starts_so_often_a_minute(serve: Serve) -> None:
    api = serve(starts_per_minute=3)
    for _ in range(3):
        refused(api.call("POST", "/trainings", json={}), 422)
    for path in ("/trainings", "/races", "/trainings/import", "/trainings/x/resume", "/import"):
        answer = api.call("POST", path, json={})
        refused(answer, 429, "3 times a minute", "HEXAPODS_STARTS_PER_MINUTE")
        assert 1 <= int(answer.headers["retry-after"]) <= 20
    film = "/races/x/recording?format=viser"
    refused(api.call("GET", film), 429)
    for method, path in (("GET", "/trainings"), ("POST", "/trainings/x/stop"), ("PUT", "/stage")):
        assert api.call(method, path, json={}).status_code != 429


def test_spectators_have_an_allowance_of_their_own(serve: Serve) -> None:
    api = serve(starts_per_minute=1, token=TOKEN)
    film = "/races/x/recording?format=viser"
    refused(api.call("GET", film), 404)
    refused(api.call("GET", film), 429)
    bearer = {"Authorization": f"Bearer {TOKEN}"}
    refused(api.call("POST", "/trainings", json={}, headers=bearer), 422)


def test_guessing_the_token_is_slow(serve: Serve) -> None:
    client = serve(token=TOKEN).client
    wrong = {"Authorization": "Bearer not-this-one"}
    for number in range(WRONG_TOKENS):
        how: Any = {"params": {"token": "no"}} if number % 2 else {"headers": wrong}
        client.cookies.clear()
        assert client.get("/", **how).status_code == (401 if number % 2 else 200)
    right = {"Authorization": f"Bearer {TOKEN}"}
    for answer in (
        client.put("/api/v1/stage", json={}, headers=wrong),
        client.put("/api/v1/stage", json={}, headers=right),
        client.get("/", params={"token": TOKEN}),
    ):
        refused(answer, 429, "wrong tokens")
        assert int(answer.headers["retry-after"]) <= 5
    assert client.get("/api/v1/stage").status_code == 200


def test_who_has_the_cookie_is_not_kept_out_by_others_guesses(serve: Serve) -> None:
    client = serve(token=TOKEN).client
    assert client.get("/", params={"token": TOKEN}).status_code == 303
    for _ in range(2 * WRONG_TOKENS):
        client.get("/healthz", headers={"Authorization": "Bearer not-this-one"})
    assert client.put("/api/v1/stage", json={"playing": True}).status_code == 200


def test_figures_for_prometheus(api: Api, trained: dict[str, Any]) -> None:
    answer = api.client.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain")
    found = {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }
    assert found["hexapods_runs", "finished"] >= 1
    assert found["hexapods_runs", "paused"] == 0
    assert found["hexapods_steps_total",] >= trained["progress"]["done"]
    for name in ("steps_per_second", "queue_depth", "viewers", "frames_sent_total"):
        assert found[f"hexapods_{name}",] >= 0
    assert found["hexapods_frames_merged_total",] >= 0
    assert found["process_start_time_seconds",] > 0


def test_figures_are_for_whoever_may_watch(serve: Serve) -> None:
    assert serve(token=TOKEN).client.get("/metrics").status_code == 200
    refused(serve(token=TOKEN, spectators="token").client.get("/metrics"), 401)


def test_a_key_that_is_none_is_refused(api: Api) -> None:
    for key in ("", "a b", "x" * 201):
        headers = {"Idempotency-Key": key}
        refused(api.call("POST", "/trainings", json=WALK, headers=headers), 422, "idempotency-key")
