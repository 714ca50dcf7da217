"""The page is viser's own client with a skin, sent once and kept by the browser."""

import gzip
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest
import viser
from starlette.applications import Starlette
from starlette.testclient import TestClient

from app.viewer.client_page import ViewerPage, skin_script, skin_style
from app.viewer.hub import Hub
from app.viewer.service import viewer_routes


@pytest.fixture(scope="module")
def client() -> TestClient:
    routes = viewer_routes(Hub())
    return TestClient(Starlette(routes=routes), follow_redirects=False)


def location(client: TestClient, path: str) -> str:
    answer = client.get(path)
    assert answer.status_code == 307
    return str(answer.headers["location"])


def test_the_page_has_viser_s_loader_after_our_script(client: TestClient) -> None:
    html = client.get("/viewer/").text

    ours, theirs = html.index(f"<script>{skin_script()}</script>"), html.index("<script data-p=")
    assert html.index("<head>") < ours < theirs
    assert f"<style>{skin_style()}</style>" in html
    assert client.get("/viewer/").headers["content-type"] == "text/html; charset=utf-8"


def test_the_skin_has_no_inline_handlers_and_cannot_end_early() -> None:
    assert "</" not in skin_script()
    assert "</" not in skin_style()


@pytest.mark.parametrize("encoding", ["gzip, deflate, br", "identity"])
def test_a_browser_gets_it_once(client: TestClient, encoding: str) -> None:
    first = client.get("/viewer/", headers={"accept-encoding": encoding})
    again = {"accept-encoding": encoding, "if-none-match": f'"other", W/{first.headers["etag"]}'}

    second = client.get("/viewer/?view=2", headers=again)

    assert (second.status_code, second.content) == (304, b"")
    assert second.headers["etag"] == first.headers["etag"]
    assert second.headers["vary"] == first.headers["vary"] == "Accept-Encoding"
    assert first.headers["cache-control"] == "no-cache"


def test_both_encodings_hold_the_same_page_under_their_own_tags() -> None:
    page = ViewerPage()

    plain, packed = page.response({}), page.response({"accept-encoding": "gzip"})

    assert gzip.decompress(packed.body) == plain.body
    assert len(packed.body) < len(plain.body)
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.headers["etag"] != plain.headers["etag"]
    assert ViewerPage().response({}).headers["etag"] == plain.headers["etag"]


def test_the_address_without_its_slash_leads_there(client: TestClient) -> None:
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
def test_what_only_looks_stays(client: TestClient, query: str) -> None:
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
def test_what_could_bring_scripts_is_taken_out(client: TestClient, query: str) -> None:
    target = location(client, f"/viewer/?view=2&{query}&theme=light")

    kept = parse_qs(urlsplit(target).query)
    assert kept.pop("playbackPath", ["/api/v1/races/7/recording"]) == ["/api/v1/races/7/recording"]
    assert kept == {"view": ["2"], "theme": ["light"]}
    assert client.get(f"/viewer/{target}").status_code == 200


@pytest.mark.parametrize("path", ["/viewer/index.html", "/viewer/x", "/viewer/..%2f..%2fx"])
def test_there_is_nothing_else(client: TestClient, path: str) -> None:
    assert client.get(path).status_code == 404


def test_nothing_is_changed_here(client: TestClient) -> None:
    for method in ("POST", "PUT", "PATCH", "DELETE"):
        assert client.request(method, "/viewer/").status_code == 405


def test_another_client_than_the_skin_fits_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    build = tmp_path / "client" / "build"
    build.mkdir(parents=True)
    (build / "index.html").write_text("<html><head><title>Viser 2</title></head></html>")
    monkeypatch.setattr(viser, "__file__", str(tmp_path / "__init__.py"))

    with pytest.raises(RuntimeError, match="another page"):
        ViewerPage()
