"""`hexapods serve`: links for a shared server are printed once they can be opened."""

import re
import subprocess
from pathlib import Path

import httpx2

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
