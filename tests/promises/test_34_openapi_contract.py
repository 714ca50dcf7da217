"""Promise 34: the contract is the truth: schemathesis with all checks finds no failure.

In full by `make soak`: 5,000 cases of all of schemathesis's phases against a real server whose
jobs run and are stopped meanwhile. The gate has the same phases with fewer cases per operation,
leaves out the systematic cases (the phase "coverage") of bodies that others have: a what-if has a
training's fields, the preview of a robot some of them, and a race has those and its lanes; and
tests once what the same functions build: the bodies of a few agents and disturbances, the parts of
a gait in a training, those of a lesson as JSON. Of several wrong types of a field, or of its names,
it tries some.

Every check is enabled, with these exceptions:

- `object_level_authorization` needs users who own objects. Here is one operator role, and all
  readers see the same.
- `ignored_auth` runs against a server of its own, since only one with a token refuses requests.
  It sends wrong tokens, and after 20 guesses an address is rate limited (429): so each kind of
  run is tested separately.
- `/api/v1/events` and that of a room are endless streams, which schemathesis would read to their
  end: the answers are checked against the contract by a separate test.

`positive_data_acceptance` accepts a 422 to valid data only where our custom check,
`refused_for_its_meaning_only`, does; and a documented 503 is not a server error.
"""

import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
import pytest

from tests.promises.contract_checks import CHECK
from tests.promises.length import at_length
from tests.promises.short_contract import shortened
from tests.served import Served, serving_from

CASES = at_length(2000, 5000)
MAX_PER_OPERATION = at_length(1, 100)
TOKEN = "a-token-for-the-contract"
ENDLESS = "/api/v1/events"
ENDLESS_OF_ROOM = r"/api/v1/rooms/\{code\}/events"
ROOT = Path(__file__).parents[2]
CONFIG = """
[checks.positive_data_acceptance]
expected-statuses = ["2xx", "401", "403", "404", "409", "410", "422", "429", "503"]

[checks.not_a_server_error]
expected-statuses = ["2xx", "3xx", "4xx", "503"]
"""
FEWER = """
[phases.coverage]
unexpected-methods = ["PATCH", "TRACE"]

[[operations]]
include-name = [
  "POST /api/v1/what-if", "POST /api/v1/races", "POST /api/v1/experiments",
  "POST /api/v1/trainings/estimate", "POST /api/v1/races/estimate",
  "POST /api/v1/experiments/estimate", "POST /api/v1/robots/preview",
]
phases.coverage.enabled = false
"""


@contextmanager
def serving(folder: Path, **variables: str) -> Iterator[Served]:
    """Run a server without a rate limit for starts."""
    with serving_from(folder) as start:
        yield start(HEXAPODS_STARTS_PER_MINUTE="1000000", **variables)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with serving(tmp_path_factory.mktemp("data")) as shared:
        yield shared


def without_tuples(document: Any) -> Any:
    """Return a part of an OpenAPI document with `items` for `prefixItems`.

    Of an answer schemathesis turns these into a list of items, which its own validator refuses.
    """
    if isinstance(document, list):
        return [without_tuples(item) for item in document]
    if not isinstance(document, dict):
        return document
    other = {name: without_tuples(item) for name, item in document.items()}
    if isinstance(items := other.pop("prefixItems", None), list):
        first = items[0]
        other["items"] = first if all(item == first for item in items) else {"anyOf": items}
    return other


def schemathesis(server: Served, folder: Path, *options: str) -> int:
    """Run schemathesis, check that all cases pass, and return their number."""
    contract = server.client.get("/openapi.json").json()
    document = folder / "openapi.json"
    document.write_text(json.dumps(without_tuples(at_length(shortened(contract), contract))))
    config = folder / "schemathesis.toml"
    config.write_text(CONFIG + at_length(FEWER, ""))
    command = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run"]
    common = ["--seed", "1", "--continue-on-failure", "--no-color"]
    common += ["--exclude-path-regex", f"{ENDLESS}$|{ENDLESS_OF_ROOM}$"]
    # A what-if can take long on a busy machine.
    common += ["--request-timeout", "120", "--max-response-time", "120"]
    began_s = time.monotonic()
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [*command, str(document), "--url", server.address, *common, *options],
        cwd=folder,
        env={
            **os.environ,
            "SCHEMATHESIS_HOOKS": "tests.promises.contract_checks",
            "PYTHONPATH": paths,
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-20_000:] + done.stderr[-5_000:]
    passed = re.search(r"^ *(\d+) generated, \1 passed", done.stdout, re.MULTILINE)
    assert passed is not None, done.stdout[-5_000:]
    sys.stdout.write(f"{passed[0]} in {time.monotonic() - began_s:.0f} s\n")
    return int(passed[1])


@contextmanager
def stopping_runs(server: Served) -> Iterator[None]:
    """Stop all runs twice a second, so that the queue does not fill up."""
    finished = threading.Event()

    def stop_all() -> None:
        with httpx2.Client(base_url=server.address, timeout=120, trust_env=False) as client:
            while not finished.wait(0.5):
                for state in ("paused", "running", "queued"):
                    for run in client.get(f"/api/v1/runs?state={state}").json()["items"]:
                        client.post(f"/api/v1/{run['kind']}s/{run['id']}/stop")

    stopper = threading.Thread(target=stop_all)
    stopper.start()
    try:
        yield
    finally:
        finished.set()
        stopper.join()


@pytest.mark.timeout(3600)
def test_all_schemathesis_checks_pass(server: Served, tmp_path: Path) -> None:
    options = ("--checks", "all", "--exclude-checks", "object_level_authorization,ignored_auth")
    with stopping_runs(server):
        count = schemathesis(server, tmp_path, *options, "-n", str(MAX_PER_OPERATION))
    assert count >= CASES
    assert server.client.get("/readyz").status_code == 200


@pytest.mark.timeout(3600)
@pytest.mark.parametrize(
    "paths", at_length(["trainings"], ["trainings", "races|stage|what-if", "experiments"])
)
def test_no_operation_ignores_its_authentication(tmp_path: Path, paths: str) -> None:
    options = ("--checks", "ignored_auth", "--include-path-regex", f"^/api/v1/({paths})")
    credentials = ("--header", f"Authorization: Bearer {TOKEN}")
    phases = ("--phases", "fuzzing,stateful", "--generation-with-security-parameters", "false")
    more = (*credentials, *phases, "-n", at_length("2", "5"))
    with serving(tmp_path / "data", HEXAPODS_TOKEN=TOKEN) as server:
        assert schemathesis(server, tmp_path, *options, *more) > 20


def test_our_custom_check_is_registered() -> None:
    options = [sys.executable, "-m", "schemathesis.cli", "run", "--help"]
    env = {**os.environ, "SCHEMATHESIS_HOOKS": "tests.promises.contract_checks", "COLUMNS": "200"}
    help_text = subprocess.run(
        options, cwd=ROOT, env=env, capture_output=True, text=True, check=True
    )
    assert CHECK in re.sub(r"\s", "", help_text.stdout)


def test_the_event_stream_conforms_to_its_description(server: Served) -> None:
    described = server.client.get("/openapi.json").json()
    answers = described["paths"][ENDLESS]["get"]["responses"]
    for query, status in (("", 200), ("?run_id=none", 404), (f"?run_id={'x' * 65}", 422)):
        answer = answers[str(status)]
        if "$ref" in answer:
            answer = described["components"]["responses"][answer["$ref"].rpartition("/")[2]]
        with server.client.stream("GET", ENDLESS + query) as response:
            assert response.status_code == status
            assert response.headers["content-type"].partition(";")[0] in answer["content"]
