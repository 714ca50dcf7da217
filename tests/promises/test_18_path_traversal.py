"""Promise 18: no path leaves the data folder: `..`, `%2e`, `%2f`, `\\`, raw paths: 0 escapes.

Path traversal is tried with every encoding of "..", in every route that takes a path or serves a
folder, over a raw socket, since clients normalise paths: each third such path in the gate, all of
them by `make soak`.
"""

from itertools import product
from pathlib import Path

import pytest

from tests.browser.serving import Serving, serving
from tests.promises.length import at_length
from tests.promises.raw import every_route, send, status_of

pytestmark = pytest.mark.test

SECRET = "this-must-never-be-seen"
UP = ["..", "%2e%2e", "%2E.", ".%2e", "%252e%252e", "..%00", "..;", "....//..", "%c0%ae%c0%ae"]
SLASH = ["/", "%2f", "%2F", "\\", "%5c", "%252f", "//", "/./", "%c0%af"]
FOLDERS = ["/static/", "/static/js/", "/viewer/", "/", "/api/v1/", "/docs/", "/static//"]
AIMS = ["secret.txt", "etc/passwd", "data/hexapods.db", "pyproject.toml", "app/settings.py"]
OTHERS = [
    "/static",
    "//etc/passwd",
    "/static//etc/passwd",
    "http://127.0.0.1/etc/passwd",
    "/static/%00",
    "/static/favicon.svg%00.txt",
    "/static/js/main.js/../../../secret.txt",
    "/static/file:///etc/passwd",
    "/static/~root/.bashrc",
    "/viewer/?playbackPath=../../../etc/passwd",
    "/viewer/%2e%2e/%2e%2e/etc/passwd",
    "*",
    "../../etc/passwd",
]
LEAKS = (SECRET.encode(), b"root:x:0:0", b"SQLite format 3", b"[build-system]", b'"""Settings')


def paths(templates: list[str]) -> list[str]:
    hostile_paths = [*OTHERS]
    for up, slash in product(UP, SLASH):
        for depth in (1, 8):
            climb = (up + slash) * depth
            hostile_paths += [folder + climb + aim for folder, aim in product(FOLDERS, AIMS)]
        climbing_id = f"{up}{slash}{up}{slash}secret.txt"
        hostile_paths += [template.replace("{run_id}", climbing_id) for template in templates]
    return hostile_paths


@pytest.mark.timeout(300)
def test_no_path_reads_or_writes_outside_the_data_folder(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text(SECRET)
    data = tmp_path / "data"
    templates = sorted({route.path for route in every_route() if "{" in route.path})
    attempts = paths(templates)[:: at_length(9, 1)]
    assert len(attempts) > at_length(500, 4_500)
    with serving(data) as server:
        for number, path in enumerate(attempts):
            # Every tenth request uses a writing method.
            method = ("DELETE", "PUT", "POST", "PATCH")[number % 4] if number % 10 == 0 else "GET"
            lines = [f"{method} {path} HTTP/1.1", "Host: 127.0.0.1", "Content-Length: 0"]
            answer = send(server.port, *lines)
            assert not any(word in answer for word in LEAKS), path
            assert status_of(answer) < 500, (path, answer)
        assert _is_healthy(server)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["data", "secret.txt"]
    assert (tmp_path / "secret.txt").read_text() == SECRET


def _is_healthy(server: Serving) -> bool:
    return status_of(send(server.port, "GET /healthz HTTP/1.1", "Host: 127.0.0.1")) == 200
