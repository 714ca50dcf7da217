"""Promise 34: a client that a public generator makes from the document works a race."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

from tests.served import serving_from

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "generated_client.py"
GENERATOR = Path(sys.executable).with_name("openapi-python-client")
UNREADABLE = r"Unsupported content.type (?:application|image|video)/"
"""This generator reads no files but `application/octet-stream`."""


def test_a_generated_client_starts_watches_and_stops_a_race(tmp_path: Path) -> None:
    with serving_from(tmp_path / "data") as start:
        server = start()
        document = tmp_path / "openapi.json"
        document.write_text(json.dumps(server.client.get("/openapi.json").json()))
        command: list[str | Path] = [GENERATOR, "generate", "--path", document]
        command += ["--output-path", tmp_path / "client"]
        generated = subprocess.run(
            [*command, "--meta", "none"],
            # It formats what it has written by ruff.
            env={**os.environ, "PATH": f"{GENERATOR.parent}{os.pathsep}{os.environ['PATH']}"},
            capture_output=True,
            text=True,
            check=False,
        )
        text = generated.stdout + generated.stderr
        assert generated.returncode == 0, text[-5000:]
        assert text.count("WARNING") == len(re.findall(UNREADABLE, text)), text[-5000:]
        (tmp_path / "client").rename(tmp_path / "racing_hexapods_client")

        done = subprocess.run(
            [sys.executable, EXAMPLE, server.address],
            env={**os.environ, "PYTHONPATH": str(tmp_path)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        started, running, stopped = done.stdout.splitlines()
        run_id = started.removeprefix("started ")
        race = server.client.get(f"/api/v1/races/{run_id}").json()
        assert race["state"] == "stopped"
        assert running.startswith("running: ")
        assert stopped == f"stopped after {race['progress']['done']} steps"
        assert 0 < race["progress"]["done"] < race["progress"]["total"]
