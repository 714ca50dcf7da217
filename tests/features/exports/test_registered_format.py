"""A registered export format gets its route, its command and its row of the menu."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.timeouts import LONG_S

ROOT = Path(__file__).parents[3]
DUMMY = """
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Le
from hexapods.domain.settings import Setting
from hexapods.exports.export_format import ExportFormat, FileType
from hexapods.exports.options import ExportOptions
from hexapods.exports.registry import EXPORTS


@dataclass(frozen=True)
class DummyOptions(ExportOptions):
    loops: Annotated[int, Ge(1), Le(9), Setting(title="Loops", help="How many.")] = 2


def write(source, file, options, execution):
    return [f"{source.title}: {len(source.walks().lanes)} lanes, {options.loops} loops"]


EXPORTS["dummy"] = ExportFormat(
    title="a dummy",
    files=(FileType("dum", "Dummy", "text/plain"), FileType("my", "Lacking", "text/x", "video")),
    write=write,
    note="It is a dummy.",
    options=DummyOptions,
)
"""
"""All that a new format consists of."""
USE = """
import contextlib, io, json, sys
from pathlib import Path
from starlette.testclient import TestClient
from app.cli import main
from app.server import create_app
from app.settings import Settings
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened

folder = Path(sys.argv[1])
with opened(folder, None) as store:
    ended_training(store, "00000000000t1", "practice")
    ended_race(store, "00000000000r1", "00000000000t1")
    client = TestClient(create_app(Settings(data=folder), store), base_url="http://localhost:8000")
    route = "/api/v1/runs/00000000000r1/dummy"
    answers = [client.get(route, params=p) for p in ({}, {"loops": 10}, {"format": "my"})]
    found = {
        "answers": [[one.status_code, one.headers["content-type"], one.text] for one in answers],
        "menu": client.get("/api/v1/options").json()["exports"],
        "parameters": [
            one["name"]
            for one in client.get("/openapi.json").json()
            ["paths"]["/api/v1/runs/{run_id}/dummy"]["get"]["parameters"]
        ],
    }
    code = main(["runs", "dummy", "00000000000r1", "--loops", "3", "--out", str(folder / "x.dum"),
                 "--data", str(folder), "--json"])
print()
print(json.dumps({**found, "code": code, "file": (folder / "x.dum").read_text()}))
"""


@pytest.mark.promises
def test_a_format_that_is_registered_has_its_route_command_and_menu(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", DUMMY + USE, str(tmp_path / "data")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=LONG_S,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    report: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])

    (status, media_type, text), (refused, _, problem), (other, other_type, _) = report["answers"]
    assert (status, media_type.partition(";")[0], other) == (200, "text/plain", 200)
    assert text.endswith(": 2 lanes, 2 loops")
    assert refused == 422
    assert "loops must be a whole number from 1 to 9" in problem
    assert other_type.startswith("text/x")
    assert {"format", "loops"} < {*report["parameters"]}
    menu = {entry["title"]: (entry["address"], entry["method"]) for entry in report["menu"]}
    assert menu["Dummy"] == ("dummy?format=dum", "GET")
    assert (report["code"], report["file"].partition(": ")[2]) == (0, "2 lanes, 3 loops")
