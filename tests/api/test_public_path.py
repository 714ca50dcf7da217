"""A server below a path of a site, which its proxy strips from requests or leaves there."""

import asyncio
from collections.abc import Callable
from typing import Any

import pytest
from starlette.types import Receive, Scope, Send

from app.api.public_path import ForwardedPath
from hexapods.domain.errors import InvalidInput
from tests.api.calls import Api

TOKEN = "a-token-for-tests"
SITE = {"public_url": "https://school.example/hex/", "token": TOKEN}
HOST = {"Host": "school.example"}
Shared = Callable[..., Api]


@pytest.mark.parametrize("path", ["/", "/runs", "/docs", "/guide/page", "/static/favicon.svg"])
def test_a_request_is_answered_with_and_without_the_path(shared: Shared, path: str) -> None:
    client = shared(**SITE).client
    stripped, whole = client.get(path, headers=HOST), client.get(f"/hex{path}", headers=HOST)
    assert (stripped.status_code, whole.status_code) == (200, 200)
    assert stripped.content == whole.content


@pytest.mark.parametrize("path", ["/hexapods/", "/other/hex/", "/hex/hex/"])
def test_another_path_is_none_of_the_server(shared: Shared, path: str) -> None:
    assert shared(**SITE).client.get(path, headers=HOST).status_code == 404


def test_the_path_without_its_slash_leads_to_the_page(shared: Shared) -> None:
    answer = shared(**SITE).client.get("/hex?token=x&a=b", headers=HOST)
    assert (answer.status_code, answer.headers["location"]) == (307, "hex/?token=x&a=b")


@pytest.mark.parametrize(
    ("path", "location"),
    [("/api/v1/trainings/?a=b", "../trainings?a=b"), ("/api/v1/trainings//", "../../trainings")],
)
def test_a_slash_too_many_is_taken_away_by_a_relative_redirect(
    shared: Shared, path: str, location: str
) -> None:
    # Valid also behind a proxy with a path that the server does not know.
    answer = shared().client.get(path)
    assert (answer.status_code, answer.headers["location"]) == (307, location)


def test_a_session_is_of_the_path_alone(shared: Shared) -> None:
    answer = shared(**SITE).client.get(f"/?token={TOKEN}", headers=HOST)
    name, attributes = answer.headers["set-cookie"].split("=", 1)
    # The prefix `__Host-` would need the path `/`.
    assert name == "__Secure-hexapods_operator_443_hex"
    assert "; Path=/hex/; HttpOnly; SameSite=Strict; Secure" in attributes
    session = {**HOST, "Cookie": f"{name}={attributes.partition(';')[0]}"}
    events = {**session, "X-Requested-With": "tests"}
    assert shared(**SITE).call("PUT", "/stage", headers=events, json={}).status_code != 401
    assert shared(**SITE).call("PUT", "/stage", headers=HOST, json={}).status_code == 401


def test_addresses_and_documents_have_the_path(shared: Shared) -> None:
    site = shared(**SITE)
    # A client on this machine, too, which sends no path.
    assert site.get("/spectators")["address"] == SITE["public_url"]
    document = site.client.get("/openapi.json", headers=HOST).json()
    assert document["servers"] == [{"url": "/hex"}]
    assert "servers" not in shared().client.get("/openapi.json").json()
    # The proxy of this test speaks HTTP.
    docs = site.client.get("/docs", headers=HOST).text
    assert "curl http://school.example/hex/api/v1/runs" in docs
    missing = site.client.get("/nothing", headers=HOST).json()
    assert missing["detail"] == "There is nothing at /hex/nothing; /hex/docs lists what there is."
    refused = site.client.put(
        "/api/v1/runs", headers={**HOST, "Authorization": f"Bearer {TOKEN}"}, json={}
    )
    assert refused.headers["allow"] == "DELETE, GET, HEAD"


def test_a_new_resource_is_below_the_path(serve: Shared) -> None:
    site = serve(**SITE)
    operator = {"Authorization": f"Bearer {TOKEN}"}
    lesson = {"title": "L", "cards": [{"text": "Look."}]}
    answer = site.call("POST", "/lessons", headers=operator, json=lesson)
    assert answer.headers["location"] == f"/hex/api/v1/lessons/{answer.json()['id']}"
    assert answer.json()["link"] == f"https://school.example/hex/l/{answer.json()['id']}"
    assert site.client.get(answer.headers["location"], headers=operator).status_code == 200


@pytest.mark.parametrize("path", ["/static/", "/runs/", "/api/hex/", "/r/"])
def test_a_path_that_the_server_uses_itself_is_refused(serve: Shared, path: str) -> None:
    with pytest.raises(InvalidInput, match="choose another, such as /hex/"):
        serve(public_url=f"https://school.example{path}")


@pytest.mark.parametrize(
    ("client", "values", "expected"),
    [
        ("10.0.0.1", ["/hex"], "/hex"),
        ("10.0.0.1", ["/user/ada@school/proxy/8000/"], "/user/ada@school/proxy/8000"),
        ("10.0.0.2", ["/hex"], None),
        ("10.0.0.1", [], None),
        ("10.0.0.1", ["/hex", "/other"], None),
        ("10.0.0.1", ["/"], None),
        ("10.0.0.1", ["hex"], None),
        ("10.0.0.1", ["/../x"], None),
        ("10.0.0.1", ["/a;b"], None),
        ("10.0.0.1", ["//evil.example"], None),
        ("10.0.0.1", ["/" + "x" * 200], None),
    ],
)
def test_a_trusted_proxy_alone_forwards_a_path(
    client: str, values: list[str], expected: str | None
) -> None:
    scopes: list[Scope] = []

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        scopes.append(scope)

    scope: dict[str, Any] = {
        "type": "http",
        "client": (client, 1),
        "headers": [(b"x-forwarded-prefix", value.encode()) for value in values],
        "state": {},
    }
    unused: Any = None
    asyncio.run(ForwardedPath(app, ["10.0.0.1"])(scope, unused, unused))
    assert scopes[0]["state"].get("forwarded_path") == expected
