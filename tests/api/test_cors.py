"""Scripts of other origins may call the API where these are configured, and then by a token."""

from collections.abc import Callable

import pytest

from app.settings import read_settings
from hexapods.domain.errors import InvalidInput
from tests.api.calls import WALK, Api

ORIGIN = "https://school.example"
TOKEN = "a-token-for-the-other-page"
FETCH = {"Origin": ORIGIN, "Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "cors"}
PREFLIGHT = {
    **FETCH,
    "Access-Control-Request-Method": "POST",
    "Access-Control-Request-Headers": "authorization,content-type",
}
Serve = Callable[..., Api]


def test_no_other_origin_may_call_by_default(serve: Serve) -> None:
    client = serve().client
    for answer in (
        client.get("/api/v1/runs", headers=FETCH),
        client.options("/api/v1/races", headers=PREFLIGHT),
    ):
        assert answer.status_code == 403
        assert answer.json()["type"] == "/problems/foreign-request"
        assert "access-control-allow-origin" not in answer.headers


def test_a_configured_origin_reads_and_starts_by_the_token(serve: Serve) -> None:
    client = serve(cors_origins=(ORIGIN,), token=TOKEN).client
    preflight = client.options("/api/v1/trainings", headers=PREFLIGHT)
    assert preflight.status_code == 200
    assert preflight.headers["access-control-allow-origin"] == ORIGIN
    assert "access-control-allow-credentials" not in preflight.headers
    runs = client.get("/api/v1/runs", headers=FETCH)
    assert (runs.status_code, runs.headers["access-control-allow-origin"]) == (200, ORIGIN)
    assert "origin" in runs.headers["vary"].lower()
    refused = client.post("/api/v1/trainings", json=WALK, headers=FETCH)
    assert refused.status_code == 401
    assert refused.headers["access-control-allow-origin"] == ORIGIN  # so that the script reads why
    bearer = {**FETCH, "Authorization": f"Bearer {TOKEN}"}
    started = client.post("/api/v1/trainings", json=WALK, headers=bearer)
    assert started.status_code == 202
    assert "location" in started.headers["access-control-expose-headers"].lower()


def test_a_configured_origin_does_not_act_by_the_cookie_of_a_person(serve: Serve) -> None:
    client = serve(cors_origins=(ORIGIN,), token=TOKEN).client
    opened = client.get(f"/?token={TOKEN}", follow_redirects=False)
    cookie = opened.headers["set-cookie"].partition(";")[0]
    own = {"Cookie": cookie, "X-Requested-With": "fetch"}
    assert client.post("/api/v1/trainings", json=WALK, headers=own).status_code == 202
    foreign = {**FETCH, **own}
    assert client.post("/api/v1/trainings", json=WALK, headers=foreign).status_code == 401


def test_the_server_s_own_page_keeps_its_session_if_its_origin_is_named_too(serve: Serve) -> None:
    client = serve(cors_origins=("http://127.0.0.1:8000",), token=TOKEN).client
    client.get(f"/?token={TOKEN}", follow_redirects=False)
    own = {"Origin": "http://127.0.0.1:8000", "Sec-Fetch-Site": "same-origin"}
    assert client.post("/api/v1/trainings", json=WALK, headers=own).status_code == 202


@pytest.mark.parametrize(
    "origin", ["https://other.example", "http://school.example", f"{ORIGIN}:8443", "null", ""]
)
def test_every_other_origin_stays_refused(serve: Serve, origin: str) -> None:
    client = serve(cors_origins=(ORIGIN,)).client
    answer = client.get("/api/v1/runs", headers={**FETCH, "Origin": origin})
    assert answer.status_code == 403
    assert "access-control-allow-origin" not in answer.headers


def test_a_form_of_a_configured_origin_is_refused(serve: Serve) -> None:
    client = serve(cors_origins=(ORIGIN,)).client
    form = {**FETCH, "Content-Type": "text/plain"}
    assert client.post("/api/v1/trainings", content="{}", headers=form).status_code == 403
    foreign_host = {**FETCH, "Host": "evil.example"}
    assert client.get("/api/v1/runs", headers=foreign_host).status_code == 403


@pytest.mark.parametrize(
    "text",
    [
        "*",
        "school.example",
        "https://",
        f"{ORIGIN}/",
        f"{ORIGIN}/page",
        "null",
        "ftp://a",
        "https://*.school.example",
    ],
)
def test_what_is_no_origin_is_refused_at_the_start(text: str) -> None:
    with pytest.raises(InvalidInput, match="must be origins separated by commas"):
        read_settings({"HEXAPODS_CORS_ORIGINS": text})
    settings = read_settings({"HEXAPODS_CORS_ORIGINS": f"{ORIGIN}, http://localhost:3000"})
    assert settings.cors_origins == (ORIGIN, "http://localhost:3000")
