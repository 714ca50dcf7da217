"""`hexapods serve`: links for a shared server are printed once they can be opened."""

import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import httpx2
import pytest

from app.api.reachable import machine_addresses, reachable_first
from tests.cli.running import refusal
from tests.features.needing import needs
from tests.forked import start_hexapods
from tests.served import environ
from tests.timeouts import LONG_S


@contextmanager
def serving(folder: Path, *options: str, **variables: str) -> Iterator[IO[str]]:
    """Yield what `hexapods serve` prints, and end it."""
    command = ["serve", *options, "--port", "0", "--data", str(folder)]
    process = start_hexapods(command, environ(**variables))
    assert process.stdout is not None
    with process.stdout as printed:
        try:
            yield printed
        finally:
            process.send_signal(signal.SIGTERM)
            printed.read()
            process.wait(LONG_S)


def test_shared_links_are_printed_when_the_server_answers(tmp_path: Path) -> None:
    with serving(tmp_path, "--share", "--host", "127.0.0.1") as printed:
        line = next(line for line in printed if line.startswith("Operator"))
        match = re.search(r"http://[^:/]+:(\d+)(/\?token=\S+)", line)
        assert match is not None, line
        port, link = match.groups()
        opened = httpx2.get(f"http://127.0.0.1:{port}{link}", timeout=LONG_S)
        assert opened.status_code == 303
        assert "hexapods" in opened.headers["set-cookie"]
        spectators = next(printed)
        assert spectators.startswith("Spectators")
        assert f":{port}/" in spectators
        # No phone can open it: why, and no code.
        assert next(printed).startswith("Only this machine can open this page; to let others watch")


def test_a_shared_server_prints_a_code_of_the_address_of_the_network(tmp_path: Path) -> None:
    addresses = reachable_first(machine_addresses("0.0.0.0"))
    with serving(tmp_path, "--share") as printed:
        line = next(line for line in printed if line.startswith("Spectators"))
        after = next(printed)
    if addresses:
        assert line.split()[-1].startswith(f"http://{addresses[0].host}:")
        assert "\x1b[" in after or "█" in after
    else:
        assert after.startswith("Phones cannot reach this machine")


@pytest.mark.parametrize("is_option", [True, False])
@needs("demo")
def test_a_demo_on_loopback_makes_a_token_and_prints_the_links(
    tmp_path: Path, is_option: bool
) -> None:
    options = ["--demo"] if is_option else []
    variables = {} if is_option else {"HEXAPODS_DEMO": "1"}
    with serving(tmp_path, *options, **variables) as printed:
        line = next(line for line in printed if line.startswith("Operator"))
        match = re.search(r"http://127.0.0.1:(\d+)/\?token=(\S+)", line)
        assert match is not None, line
        address = f"http://127.0.0.1:{match[1]}"
        assert next(printed).startswith("Visitors (may train")
        allowance = httpx2.get(f"{address}/api/v1/allowance", timeout=LONG_S).json()
        assert allowance["hours"] == 24
        bearer = {"Authorization": f"Bearer {match[2]}"}
        visitors = f"{address}/api/v1/visitors"
        assert httpx2.get(visitors, headers=bearer, timeout=LONG_S).json() == {"items": []}
        assert httpx2.get(visitors, timeout=LONG_S).status_code == 403


def test_the_token_of_a_service_is_not_printed(tmp_path: Path) -> None:
    token = "a-token-of-a-service"
    command = ["serve", "--port", "0", "--data", str(tmp_path)]
    process = start_hexapods(command, environ(HEXAPODS_DEMO="1", HEXAPODS_TOKEN=token))
    assert process.stdout is not None
    with process.stdout as printed:
        said = printed.readline()
        process.send_signal(signal.SIGTERM)
        assert token not in said + printed.read()
        process.wait(LONG_S)


@needs("demo")
def test_a_demo_for_others_needs_a_token(tmp_path: Path) -> None:
    command = ("serve", "--demo", "--host", "0.0.0.0", "--port", "0", "--data", str(tmp_path))
    assert "a demo needs HEXAPODS_TOKEN" in refusal(*command, folder=tmp_path)
