"""`hexapods serve`: links for a shared server are printed once they can be opened."""

import re
import subprocess
from pathlib import Path

import httpx2
import pytest

from tests.forked import HEXAPODS
from tests.served import environ
from tests.timeouts import LONG_S


def test_shared_links_are_printed_when_the_server_answers(tmp_path: Path) -> None:
    command = [*HEXAPODS, "serve", "--share", "--host", "127.0.0.1", "--port", "0"]
    with subprocess.Popen(
        [*command, "--data", str(tmp_path)], env=environ(), stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        try:
            line = next(line for line in process.stdout if line.startswith("Operator"))
            found = re.search(r"http://[^:/]+:(\d+)(/\?token=\S+)", line)
            assert found is not None, line
            port, link = found.groups()
            opened = httpx2.get(f"http://127.0.0.1:{port}{link}", timeout=LONG_S)
            assert opened.status_code == 303
            assert "hexapods" in opened.headers["set-cookie"]
            spectators = next(process.stdout)
            assert spectators.startswith("Spectators")
            assert f":{port}/" in spectators
        finally:
            process.terminate()
            process.stdout.read()


@pytest.mark.parametrize("is_option", [True, False])
def test_a_demo_on_loopback_makes_a_token_and_prints_the_links(
    tmp_path: Path, is_option: bool
) -> None:
    command = [*HEXAPODS, "serve", "--port", "0", "--data", str(tmp_path)]
    command += ["--demo"] if is_option else []
    variables = {} if is_option else {"HEXAPODS_DEMO": "1"}
    with subprocess.Popen(
        command, env=environ(**variables), stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        try:
            line = next(line for line in process.stdout if line.startswith("Operator"))
            found = re.search(r"http://127.0.0.1:(\d+)/\?token=(\S+)", line)
            assert found is not None, line
            address = f"http://127.0.0.1:{found[1]}"
            assert next(process.stdout).startswith("Visitors (may train")
            allowance = httpx2.get(f"{address}/api/v1/allowance", timeout=LONG_S).json()
            assert allowance["hours"] == 24
            bearer = {"Authorization": f"Bearer {found[2]}"}
            visitors = f"{address}/api/v1/visitors"
            assert httpx2.get(visitors, headers=bearer, timeout=LONG_S).json() == {"items": []}
            assert httpx2.get(visitors, timeout=LONG_S).status_code == 403
        finally:
            process.terminate()
            process.stdout.read()


def test_the_token_of_a_service_is_not_printed(tmp_path: Path) -> None:
    command = [*HEXAPODS, "serve", "--port", "0", "--data", str(tmp_path)]
    token = "a-token-of-a-service"
    variables = environ(HEXAPODS_DEMO="1", HEXAPODS_TOKEN=token)
    with subprocess.Popen(command, env=variables, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        said = process.stdout.readline()
        process.terminate()
        assert token not in said + process.stdout.read()


def test_a_demo_for_others_needs_a_token(tmp_path: Path) -> None:
    command = [*HEXAPODS, "serve", "--demo", "--host", "0.0.0.0", "--port", "0"]
    refused = subprocess.run(
        [*command, "--data", str(tmp_path)],
        env=environ(),
        capture_output=True,
        text=True,
        check=False,
        timeout=LONG_S,
    )
    assert refused.returncode == 2
    assert "a demo needs HEXAPODS_TOKEN" in refused.stderr
