"""`hexapods doctor` in this process: what its checks say."""

import json
from pathlib import Path
from typing import Any

import pytest

from app.cli import machine_checks
from tests.cli.running import in_process

ANY_PORT = {"HEXAPODS_PORT": "0"}


@pytest.fixture(autouse=True)
def known_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out, in this process, the physics, which take a second each time.

    `hexapods doctor` in a process of its own checks them.
    """
    monkeypatch.delitem(machine_checks.CHECKS, "physics")


def examined(folder: Path, **variables: str) -> dict[str, Any]:
    """Return the checks' results by name, for the data folder `data`."""
    data = ("--data", str(folder / "data"))
    done = in_process("doctor", *data, "--json", folder=folder, **{**ANY_PORT, **variables})
    document = json.loads(done.stdout)
    assert done.returncode == (0 if document["ok"] else 1)
    assert "Traceback" not in done.stderr
    assert document["ok"] == all(check["ok"] for check in document["checks"])
    return {check["name"]: (check["ok"], check["said"]) for check in document["checks"]}


def failures(checks: dict[str, Any]) -> dict[str, str]:
    """Return what is said of the failed checks."""
    return {name: said for name, (ok, said) in checks.items() if not ok}
