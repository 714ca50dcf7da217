"""The dashboard's page and files: compression, entity tags, preloads."""

import gzip
import re
from collections.abc import Callable
from pathlib import Path

import httpx2
import pytest
from starlette.applications import Starlette
from starlette.testclient import TestClient

from app.api.compression import CompressedContent, accepts_gzip
from app.api.deps import PageFiles
from app.api.pages import (
    VIEWS,
    content_policy,
    imported_modules,
    page_features,
    page_routes,
    view_titles,
    with_preloads,
)
from hexapods import assets
from tests.api.calls import Api
from tests.api.guarding import let_all_pass
from tests.features.needing import needs

SCRIPT = "/static/js/main.js"
PAGE = (
    '<script type="importmap">{"imports": {"a": "./static/vendor/a.js"}}</script>\n'
    '<script type="module" src="static/js/main.js"></script>\n'
)


def fetch(
    api: Api, path: str, method: str = "GET", **headers: str
) -> tuple[int, dict[str, str], bytes]:
    """Return status, headers and the body as it was sent."""
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    with api.client.stream(
        method, path, headers={"Accept-Encoding": "identity", **named}
    ) as response:
        body = b"".join(response.iter_raw())
        return response.status_code, dict(response.headers), body


@pytest.mark.parametrize("path", ["/", SCRIPT, "/favicon.ico", "/openapi.json"])
def test_text_is_compressed_for_clients_that_accept_it(api: Api, path: str) -> None:
    _, plain_headers, plain = fetch(api, path)
    _, headers, packed = fetch(api, path, Accept_Encoding="br, gzip;q=0.5")

    assert headers["content-encoding"] == "gzip"
    assert gzip.decompress(packed) == plain
    assert len(packed) < len(plain)
    assert "content-encoding" not in plain_headers
    assert headers["content-type"] == plain_headers["content-type"]
    assert headers["etag"] != plain_headers["etag"]
    assert headers["vary"] == plain_headers["vary"] == "Accept-Encoding"
    assert headers["cache-control"] == plain_headers["cache-control"] == "no-cache"


@pytest.mark.parametrize("path", ["/", SCRIPT])
@pytest.mark.parametrize("encoding", ["identity", "gzip"])
def test_current_copy_is_not_sent_again(api: Api, path: str, encoding: str) -> None:
    _, sent, _ = fetch(api, path, Accept_Encoding=encoding)
    tags = f'"other", W/{sent["etag"]}'
    status, headers, body = fetch(api, path, Accept_Encoding=encoding, If_None_Match=tags)

    assert (status, body) == (304, b"")
    for name in ("etag", "vary", "cache-control", "content-security-policy"):
        assert headers[name] == sent[name]
    assert fetch(api, path, Accept_Encoding=encoding, If_None_Match='"other"')[0] == 200


def test_copy_of_another_encoding_is_not_current(api: Api) -> None:
    _, plain, _ = fetch(api, SCRIPT)
    status, _, _ = fetch(api, SCRIPT, Accept_Encoding="gzip", If_None_Match=plain["etag"])

    assert status == 200


@pytest.mark.parametrize("encoding", ["identity", "gzip"])
def test_head_has_the_headers_of_get(api: Api, encoding: str) -> None:
    _, got, body = fetch(api, SCRIPT, Accept_Encoding=encoding)
    status, headers, nothing = fetch(api, SCRIPT, "HEAD", Accept_Encoding=encoding)

    assert (status, headers, nothing) == (200, got, b"")
    assert int(headers["content-length"]) == len(body)


@pytest.mark.parametrize("encoding", ["identity", "gzip"])
def test_range_is_answered_with_the_whole(api: Api, encoding: str) -> None:
    whole = fetch(api, SCRIPT, Accept_Encoding=encoding)

    assert fetch(api, SCRIPT, Accept_Encoding=encoding, Range="bytes=1-9") == whole


def test_runs_and_events_are_not_compressed(api: Api) -> None:
    for path in ("/api/v1/runs", "/api/v1/trainings", "/docs"):
        _, headers, _ = fetch(api, path, Accept_Encoding="gzip")
        assert "content-encoding" not in headers


def test_changed_file_is_sent_anew(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(PAGE)
    (tmp_path / "js").mkdir()
    (tmp_path / "js" / "main.js").write_text("first")
    (tmp_path / "favicon.svg").write_text("<svg/>")
    app = Starlette(routes=page_routes(PageFiles(tmp_path)))
    app.state.guards = let_all_pass
    with TestClient(app) as client:
        first = client.get(SCRIPT)
        (tmp_path / "js" / "main.js").write_text("another")
        second = client.get(SCRIPT)

    assert (first.text, second.text) == ("first", "another")
    assert first.headers["etag"] != second.headers["etag"]


def test_content_that_does_not_get_smaller_stays_plain() -> None:
    content = CompressedContent(b"ab", "text/plain")
    scope = {"type": "http", "method": "GET", "headers": [(b"accept-encoding", b"gzip")]}

    assert content.response(scope).body == b"ab"


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ("gzip", True),
        ("br, GZIP ; q=0.5", True),
        ("gzip;q=1.0", True),
        ("gzip;q=0", False),
        ("gzip; q=0.000, br", False),
        ("x-gzip", False),
        ("", False),
    ],
)
def test_accepted_encodings(header: str, *, expected: bool) -> None:
    assert accepts_gzip(header) is expected


def imported_later(script: Path, folder: Path) -> list[str]:
    """Return the modules that a script imports when they are first needed."""
    # In comments stand types of modules.
    imports = re.findall(r'import\("(\.[^"]+)"\)+\s*(?:\.\w+\(|[;,])', script.read_text("utf-8"))
    modules = [(script.parent / path).resolve() for path in imports]
    return [module.relative_to(folder.resolve().parent).as_posix() for module in modules]


def opened_by_features(folder: Path) -> list[str]:
    """Return the modules that features name, for when they are first needed."""
    files = [*folder.glob("features/*/feature.json"), *folder.glob("features/*/feature.js")]
    named = [
        (file.parent / path).resolve()
        for file in files
        for path in re.findall(r'"([\w./-]+\.js)#\w+"', file.read_text("utf-8"))
    ]
    return [module.relative_to(folder.resolve().parent).as_posix() for module in named]


def test_page_preloads_every_module_once_but_those_that_are_loaded_later(api: Api) -> None:
    page = api.client.get("/").text
    folder = assets.static_dir()
    coded = {f["name"]: f for f in page_features(PageFiles(folder)) if f["hasCode"]}
    starts = [f"static/features/{n}/feature.js" for n in coded if "codeFor" not in coded[n]]
    entries = ["static/js/main.js", *starts]
    modules = {path for entry in entries for path in imported_modules(entry, folder)}
    scripts = [*(folder / "js").rglob("*.js"), *(folder / "features").rglob("*.js")]
    opened = {path for script in scripts for path in imported_later(script, folder)}
    opened |= {*opened_by_features(folder)}
    opened |= {f"static/features/{n}/feature.js" for n in coded if "codeFor" in coded[n]}
    # Of files that are opened without a server: a replay, and the report of an experiment.
    opened |= {"static/js/offline/player.js", "static/features/experiments/offline-report.js"}
    # Of pages of features.
    pages = ("features/classroom/room/main.js", "features/tournaments/main.js")
    opened |= {f"static/{path}" for path in pages if (folder / path).exists()}
    later = {path for module in opened for path in imported_modules(module, folder)} - modules

    assert {folder.parent / path for path in (*modules, *later)} == {*scripts}
    assert opened <= later
    assert not [module for module in later if module in page]
    for module in [*modules, *(f"static/vendor/{p.name}" for p in folder.glob("vendor/*.js"))]:
        assert page.count(f'<link rel="modulepreload" href="{module}">') == 1
        assert api.client.get(f"/{module}").status_code == 200
    assert page.index("importmap") < page.index("modulepreload")


def test_each_view_has_an_address_at_which_the_page_opens_it(api: Api) -> None:
    index = api.client.get("/").text
    titles = view_titles(page_features(PageFiles(assets.static_dir())))
    assert {"runs", "compare"} <= titles.keys()
    for name, title in titles.items():
        page = api.client.get(f"/{name}")
        assert page.status_code == 200
        assert f'<html lang="en" data-view="{name}">' in page.text
        assert f"<title>{title} · Racing Hexapods</title>" in page.text
        # It stands beside the page, so that all its relative links lead where those of that do.
        assert re.findall('(?:src|href)="([^"]+)"', page.text) == re.findall(
            '(?:src|href)="([^"]+)"', index
        )
        assert page.headers["content-security-policy"] == content_policy(page.text)


@pytest.mark.parametrize("path", ["/run", "/runs/x", "/race", "/Runs", "/nothing"])
def test_no_other_address_has_the_page(api: Api, path: str) -> None:
    assert api.client.get(path, follow_redirects=False).status_code == 404


@needs("experiments")
def test_a_view_of_a_feature_that_is_left_out_has_no_address(shared: Callable[..., Api]) -> None:
    client = shared(without=("experiments",)).client
    assert (client.get("/runs").status_code, client.get("/experiments").status_code) == (200, 404)


def test_the_views_of_the_core_have_the_titles_of_the_page() -> None:
    folder = assets.static_dir() / "js"
    names = re.search(r'VIEWS = \["race", (.+?)\];', (folder / "page-state.js").read_text("utf-8"))
    titles = re.search("VIEW_TITLES = {(.+?)};", (folder / "on-stage.js").read_text("utf-8"))
    assert names is not None
    assert titles is not None
    assert re.findall(r"\w+", names[1]) == [*VIEWS]
    assert dict(re.findall(r'(\w+): t\("([^"]+)"\)', titles[1])) == VIEWS


@needs("classroom")
def test_page_of_rooms_is_a_folder_deeper_and_preloads_its_own_modules(api: Api) -> None:
    page = api.client.get("/r/NOROOM", headers={"Accept": "text/html"})
    folder = assets.static_dir()
    modules = imported_modules("static/features/classroom/room/main.js", folder)

    assert page.status_code == 404
    assert page.headers["content-type"].startswith("text/html")
    assert "static/js/components/app.js" not in modules
    for module in modules:
        assert page.text.count(f'<link rel="modulepreload" href="../{module}">') == 1
    assert page.headers["content-security-policy"] == content_policy(page.text)


def test_policy_allows_the_inline_scripts_of_the_page_as_sent(api: Api) -> None:
    response = api.client.get("/")

    assert response.headers["content-security-policy"] == content_policy(response.text)
    assert response.headers["content-security-policy"].count("'sha256-") == 2


def test_page_without_an_entry_point_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="entry point"):
        with_preloads("<p></p>", tmp_path)


@pytest.mark.parametrize(
    "path",
    [
        "/static/features/guide/feature.json",
        "/static//features/guide/feature.json",
        "/static/./features/guide/feature.json",
        "/static/%2e/features/guide/feature.json",
        "/static/features//guide/feature.json",
        "/static/features/demo/../guide/feature.json",
        "/static/features/x/%2e%2e/guide/feature.json",
        "/static/features%2Fguide%2Ffeature.json",
    ],
)
@needs("guide")
def test_no_spelling_serves_a_file_of_a_feature_that_is_left_out(
    path: str, shared: Callable[..., Api]
) -> None:
    # As a whole URL, of which the client shortens nothing.
    client = shared(without=("guide",)).client
    assert client.get(httpx2.URL(f"http://127.0.0.1:8000{path}")).status_code == 404


def test_a_missing_file_is_a_page_with_a_link_home(api: Api) -> None:
    answer = api.client.get("/static/nothing.js", headers={"accept": "text/html"})
    assert (answer.status_code, 'href="../"' in answer.text) == (404, True)


def test_a_file_cannot_be_changed(api: Api) -> None:
    answer = api.client.put("/static/favicon.svg")
    assert (answer.status_code, answer.headers["allow"]) == (405, "GET, HEAD")
    assert "possible: GET, HEAD." in answer.text
