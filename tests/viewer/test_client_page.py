"""The viewer's page: patched client, caching, allow-listed query parameters."""

import gzip
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest
import viser
from starlette.applications import Starlette
from starlette.testclient import TestClient

from app.viewer.client_page import ViewerPage, patch_script, patch_style
from app.viewer.hub import Hub
from app.viewer.service import viewer_routes


@pytest.fixture(scope="module")
def client() -> TestClient:
    routes = viewer_routes(Hub())
    return TestClient(Starlette(routes=routes), follow_redirects=False)


def location(client: TestClient, path: str) -> str:
    response = client.get(path)
    assert response.status_code == 307
    return str(response.headers["location"])


def test_patch_precedes_visers_loader(client: TestClient) -> None:
    html = client.get("/viewer/").text

    patch_position, loader_position = (
        html.index(f"<script>{patch_script()}</script>"),
        html.index("<script data-p="),
    )
    assert html.index("<head>") < patch_position < loader_position
    assert f"<style>{patch_style()}</style>" in html
    assert client.get("/viewer/").headers["content-type"] == "text/html; charset=utf-8"


def test_patch_contains_no_closing_tags() -> None:
    assert "</" not in patch_script()
    assert "</" not in patch_style()


@pytest.mark.parametrize("encoding", ["gzip, deflate, br", "identity"])
def test_cached_page_is_answered_with_304(client: TestClient, encoding: str) -> None:
    first = client.get("/viewer/", headers={"accept-encoding": encoding})
    revalidation = {
        "accept-encoding": encoding,
        "if-none-match": f'"other", W/{first.headers["etag"]}',
    }

    second = client.get("/viewer/?view=2", headers=revalidation)

    assert (second.status_code, second.content) == (304, b"")
    assert second.headers["etag"] == first.headers["etag"]
    assert second.headers["vary"] == first.headers["vary"] == "Accept-Encoding"
    assert first.headers["cache-control"] == "no-cache"


def test_each_encoding_has_its_own_entity_tag() -> None:
    page = ViewerPage()

    plain, compressed = page.response({}), page.response({"accept-encoding": "gzip"})

    assert gzip.decompress(compressed.body) == plain.body
    assert len(compressed.body) < len(plain.body)
    assert compressed.headers["content-encoding"] == "gzip"
    assert compressed.headers["etag"] != plain.headers["etag"]
    assert ViewerPage().response({}).headers["etag"] == plain.headers["etag"]


def test_path_without_slash_redirects(client: TestClient) -> None:
    assert location(client, "/viewer") == "viewer/"
    assert location(client, "/viewer?view=3&theme=dark") == "viewer/?view=3&theme=dark"


@pytest.mark.parametrize(
    "query",
    [
        "view=leader&theme=dark",
        "initialCameraPosition=1,2,3&showStats=",
        "playbackPath=%2Fapi%2Fv1%2Fraces%2F3f-2_b%2Frecording%3Fformat%3Dviser",
        "playbackPath=/api/v1/races/7/recording",
    ],
)
def test_allowed_parameters_are_kept(client: TestClient, query: str) -> None:
    assert client.get(f"/viewer/?{query}").status_code == 200


@pytest.mark.parametrize(
    "query",
    [
        "websocket=ws://evil.example",
        "playbackPath=https://evil.example/x.viser",
        "playbackPath=//evil.example/api/v1/races/7/recording",
        "playbackPath=/api/v1/races/../../x/recording",
        "playbackPath=/api/v1/races/7/recording%23",
        "playbackPath=/api/v1/races/7/recording%0a",
        "playbackPath=/api/v1/races/7/recording&playbackPath=data:,x",
        "playbackpath=x",
        "unheard=of",
    ],
)
def test_other_parameters_are_removed(client: TestClient, query: str) -> None:
    target = location(client, f"/viewer/?view=2&{query}&theme=light")

    remaining = parse_qs(urlsplit(target).query)
    assert remaining.pop("playbackPath", ["/api/v1/races/7/recording"]) == [
        "/api/v1/races/7/recording"
    ]
    assert remaining == {"view": ["2"], "theme": ["light"]}
    assert client.get(f"/viewer/{target}").status_code == 200


@pytest.mark.parametrize("path", ["/viewer/index.html", "/viewer/x", "/viewer/..%2f..%2fx"])
def test_other_paths_are_not_found(client: TestClient, path: str) -> None:
    assert client.get(path).status_code == 404


def test_writing_methods_are_not_allowed(client: TestClient) -> None:
    for method in ("POST", "PUT", "PATCH", "DELETE"):
        assert client.request(method, "/viewer/").status_code == 405


def test_unsupported_client_raises(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    build = tmp_path / "client" / "build"
    build.mkdir(parents=True)
    (build / "index.html").write_text("<html><head><title>Viser 2</title></head></html>")
    monkeypatch.setattr(viser, "__file__", str(tmp_path / "__init__.py"))

    with pytest.raises(RuntimeError, match="another page"):
        ViewerPage()
