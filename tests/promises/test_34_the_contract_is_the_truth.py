"""Promise 34: the contract is the truth: schemathesis with all checks finds nothing to object to.

In full by `make soak`: 5,000 cases of all of schemathesis's phases against a real server whose
jobs run and are stopped meanwhile, as one of the class would. The gate has the same phases with
fewer cases of each operation.

Every check is on, with these exceptions, each for one reason:

- `object_level_authorization` needs users who own objects. There is one operator here, and all
  who may read see the same.
- `ignored_auth` has a server of its own, since only one with a token refuses anyone. It guesses,
  and who guesses 20 times is answered 429 whatever comes next: so each kind of run has its turn.
- `/api/v1/events` is a stream without an end, which schemathesis would read to its end: its
  answers are held to the contract by a test of their own.

`positive_data_acceptance` takes a 422 for an answer to valid data only where our own check,
`refused_for_its_meaning_only`, does; and 503 is no server's error where it is documented.
"""

import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx2
import pytest

from tests.promises.contract_checks import CHECK
from tests.promises.length import at_length
from tests.served import Served, serving_from

CASES = at_length(3000, 5000)
MOST_PER_OPERATION = at_length(3, 100)
TOKEN = "a-token-for-the-contract"
ENDLESS = "/api/v1/events"
ROOT = Path(__file__).parents[2]
CONFIG = """
[checks.positive_data_acceptance]
expected-statuses = ["2xx", "401", "403", "404", "409", "410", "422", "429", "503"]

[checks.not_a_server_error]
expected-statuses = ["2xx", "3xx", "4xx", "503"]
"""
Serve = Callable[..., Served]


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Serve]:
    """Servers that nothing is too often for."""
    with serving_from(tmp_path / "data") as start:
        yield lambda **more: start(HEXAPODS_STARTS_PER_MINUTE="1000000", **more)


def schemathesis(server: Served, folder: Path, *options: str) -> int:
    """How many cases schemathesis made, all of them passed."""
    config = folder / "schemathesis.toml"
    config.write_text(CONFIG)
    command = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run"]
    common = ["--seed", "1", "--continue-on-failure", "--exclude-path", ENDLESS, "--no-color"]
    # A what-if takes as long as the machine is busy.
    common += ["--request-timeout", "120", "--max-response-time", "120"]
    began_s = time.monotonic()
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [*command, f"{server.address}/openapi.json", *common, *options],
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
    found = re.search(r"^ *(\d+) generated, \1 passed", done.stdout, re.MULTILINE)
    assert found is not None, done.stdout[-5_000:]
    sys.stdout.write(f"{found[0]} in {time.monotonic() - began_s:.0f} s\n")
    return int(found[1])


@contextmanager
def stopping(server: Served) -> Iterator[None]:
    """Stop what was started every now and then, so that the queue has room for more."""
    over = threading.Event()

    def stop_all() -> None:
        with httpx2.Client(base_url=server.address, timeout=120, trust_env=False) as client:
            while not over.wait(0.5):
                for kind in ("races", "trainings", "experiments"):
                    for state in ("paused", "running", "queued"):
                        runs = client.get(f"/api/v1/{kind}?state={state}").json()["items"]
                        for run in runs:
                            client.post(f"/api/v1/{kind}/{run['id']}/stop")

    stopper = threading.Thread(target=stop_all)
    stopper.start()
    try:
        yield
    finally:
        over.set()
        stopper.join()


@pytest.mark.timeout(3600)
def test_all_checks_pass(serve: Serve, tmp_path: Path) -> None:
    server = serve()
    options = ("--checks", "all", "--exclude-checks", "object_level_authorization,ignored_auth")
    with stopping(server):
        count = schemathesis(server, tmp_path, *options, "-n", str(MOST_PER_OPERATION))
    assert count >= CASES
    assert server.client.get("/readyz").status_code == 200


@pytest.mark.timeout(3600)
@pytest.mark.parametrize(
    "paths", at_length(["trainings"], ["trainings", "races|stage|what-if", "experiments"])
)
def test_no_operation_ignores_who_asks(serve: Serve, tmp_path: Path, paths: str) -> None:
    server = serve(HEXAPODS_TOKEN=TOKEN)
    options = ("--checks", "ignored_auth", "--include-path-regex", f"^/api/v1/({paths})")
    told = ("--header", f"Authorization: Bearer {TOKEN}")
    phases = ("--phases", "fuzzing,stateful", "--generation-with-security-parameters", "false")
    assert schemathesis(server, tmp_path, *options, *told, *phases, "-n", "5") > 20


def test_our_own_check_is_among_them() -> None:
    options = [sys.executable, "-m", "schemathesis.cli", "run", "--help"]
    env = {**os.environ, "SCHEMATHESIS_HOOKS": "tests.promises.contract_checks", "COLUMNS": "200"}
    told = subprocess.run(options, cwd=ROOT, env=env, capture_output=True, text=True, check=True)
    assert CHECK in re.sub(r"\s", "", told.stdout)


def test_the_stream_of_events_answers_as_described(serve: Serve) -> None:
    server = serve()
    described = server.client.get("/openapi.json").json()
    answers = described["paths"][ENDLESS]["get"]["responses"]
    for query, status in (("", 200), ("?run_id=none", 404), (f"?run_id={'x' * 65}", 422)):
        answer = answers[str(status)]
        if "$ref" in answer:
            answer = described["components"]["responses"][answer["$ref"].rpartition("/")[2]]
        with server.client.stream("GET", ENDLESS + query) as response:
            assert response.status_code == status
            assert response.headers["content-type"].partition(";")[0] in answer["content"]
