"""The viewer's page: patched client, policy, caching, allow-listed query parameters, colours."""

import gzip
import re
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
import viser
import zstandard
from starlette.applications import Starlette
from starlette.testclient import TestClient

from app.viewer.viewer_page import STAGE_SCRIPTS, ViewerPage, viewer_routes
from hexapods import assets
from hexapods.drawing.viser_internals.client import OFFLINE_SCRIPTS, batch_colors, content_policy

PATCH = assets.static_dir() / "viewer"
SCRIPTS = [(PATCH / name).read_text("utf-8") for name in STAGE_SCRIPTS]
STYLE = (PATCH / "patch.css").read_text("utf-8")
DIGITS = "!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"


@pytest.fixture(scope="module")
def client() -> TestClient:
    return TestClient(Starlette(routes=viewer_routes()), follow_redirects=False)


def location(client: TestClient, path: str) -> str:
    response = client.get(path)
    assert response.status_code == 307
    return str(response.headers["location"])


def test_patch_precedes_visers_loader(client: TestClient) -> None:
    html = client.get("/viewer/").text

    patch_position, loader_position = (
        html.index("".join(f"<script>{script}</script>" for script in SCRIPTS)),
        html.index("<script data-p="),
    )
    assert html.index("<head>") < patch_position < loader_position
    assert f"<style>{STYLE}</style>" in html
    assert client.get("/viewer/").headers["content-type"] == "text/html; charset=utf-8"


def test_patch_contains_no_closing_tags() -> None:
    for name in {*STAGE_SCRIPTS, *OFFLINE_SCRIPTS}:
        assert "</" not in (PATCH / name).read_text("utf-8")
    assert "</" not in STYLE


@pytest.mark.parametrize("encoding", ["gzip, deflate, br", "identity"])
def test_cached_page_is_answered_with_304(client: TestClient, encoding: str) -> None:
    first = client.get("/viewer/", headers={"accept-encoding": encoding})
    revalidation = {
        "accept-encoding": encoding,
        "if-none-match": f'"other", W/{first.headers["etag"]}',
    }

    second = client.get("/viewer/?theme=dark", headers=revalidation)

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
    assert location(client, "/viewer?theme=dark&showStats=") == "viewer/?theme=dark&showStats="


@pytest.mark.parametrize(
    "query",
    [
        "theme=dark",
        "initialCameraPosition=1,2,3&showStats=",
    ],
)
def test_allowed_query_parameters_are_accepted(client: TestClient, query: str) -> None:
    assert client.get(f"/viewer/?{query}").status_code == 200


@pytest.mark.parametrize(
    "query",
    [
        "websocket=ws://evil.example",
        "playbackPath=https://evil.example/x.viser",
        "playbackPath=/api/v1/races/7/recording",
        "playbackPath=/api/v1/races/7/recording&playbackPath=data:,x",
        "playbackpath=x",
        "unheard=of",
        "view=2",
    ],
)
def test_other_parameters_are_removed(client: TestClient, query: str) -> None:
    target = location(client, f"/viewer/?fixedDpr=2&{query}&theme=light")

    assert parse_qs(urlsplit(target).query) == {"fixedDpr": ["2"], "theme": ["light"]}
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


def in_base_88(data: bytes) -> str:
    text = ""
    for start in range(0, len(data), 4):
        chunk = data[start : start + 4]
        value = int.from_bytes(chunk, "big")
        places = range(len(chunk), -1, -1)
        text += "".join(DIGITS[value // 88**place % 88] for place in places)
    return text


def page_of(code: str, style: str = "", size: int | None = None) -> str:
    """Return a page in viser's format."""
    packed = in_base_88(zstandard.compress((style + code).encode()))
    sizes = len(style.encode()), len(code.encode()) if size is None else size
    attributes = f'data-p="{packed}" data-ss="{sizes[0]}" data-cs="{sizes[1]}"'
    return f"<head><script>patch()</script><script {attributes}>load()</script></head>"


def hashes(policy: str) -> list[str]:
    return re.findall(r"'sha256-([\w+/=]+)'", policy)


@pytest.mark.parametrize("tail", ["", "1", "12", "123", "1234"])
def test_policy_has_a_hash_for_each_script_and_the_packed_one(tail: str) -> None:
    policies = [content_policy(page_of(code)) for code in ("app()" + tail, "app() " + tail)]

    hashes_a, hashes_b = map(hashes, policies)

    assert hashes_a[:2] == hashes_b[:2]
    assert len({*hashes_a, *hashes_b}) == 4


def test_packed_style_is_not_part_of_the_hash() -> None:
    assert content_policy(page_of("α()", "b { --β: 1 }")) == content_policy(page_of("α()"))


def test_installed_client_has_fourteen_scripts_and_all_are_hashed() -> None:
    headers = ViewerPage().response({}).headers
    policy = headers["content-security-policy"]

    assert len(hashes(policy)) == 14
    script_source = policy.partition("script-src")[2].partition(";")[0]
    for word in ("'unsafe-inline'", "'unsafe-eval'", "'self'", "http"):
        assert word not in script_source
    for directive in ("img-src blob: data:;", "connect-src blob: data:;", "frame-ancestors 'self'"):
        assert directive in policy, "it loads nothing from the server"
    not_changed = ViewerPage().response({"if-none-match": headers["etag"]})
    assert not_changed.status_code == 304
    assert not_changed.headers["content-security-policy"] == policy


@pytest.mark.parametrize(
    ("html", "what"),
    [
        ("<script>all of it</script>", "of 1 scripts 0 hold the client"),
        (page_of("app()") + page_of("app()"), "of 4 scripts 2 hold"),
        (page_of("app()", size=4), "does not unpack|unpacks to"),
        (page_of("app()", size=6), "unpacks to 5 bytes, not 6"),
        (page_of("app()", size=10**12), "would unpack to"),
        (page_of("app()").replace('data-p="', 'data-p="€'), "does not unpack"),
        (page_of("app()").replace('data-p="', 'data-p="\\x00'), "does not unpack"),
        (page_of("app()").replace('data-p="', 'data-p="0'), "does not unpack"),
        (page_of("app()").replace(" data-cs", " data-x data-cs"), "0 hold the client"),
    ],
)
def test_client_in_another_packing_raises(html: str, what: str) -> None:
    with pytest.raises(RuntimeError, match=what):
        content_policy(html)


@pytest.mark.parametrize(("dimmed", "expected"), [(1.0, 255), (0.5, 128)])
def test_batch_colors_keeps_white_unless_dimmed(dimmed: float, expected: int) -> None:
    assert batch_colors(np.full((1, 3), 255, np.uint8), dimmed).tolist() == [[expected] * 3]
