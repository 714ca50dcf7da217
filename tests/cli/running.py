"""Runs `hexapods` as a user does: in a process of its own, in a folder of its own."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "docs" / "examples"


def hexapods(*arguments: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """The finished command, with further variables in its environment."""
    return subprocess.run(
        [sys.executable, "-m", "app.cli", *arguments],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin", **variables},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )


def output(*arguments: str, folder: Path) -> Any:
    """Return the JSON that a command, which must succeed, prints."""
    done = hexapods(*arguments, "--json", folder=folder)
    assert done.returncode == 0, done.stderr
    assert done.stderr == "", "a program that reads JSON gets no progress bar"
    return json.loads(done.stdout)


def refusal(*arguments: str, folder: Path) -> str:
    """The one sentence with which a command refuses."""
    done = hexapods(*arguments, folder=folder)
    assert done.returncode == 2, (done.returncode, done.stdout, done.stderr)
    assert "Traceback" not in done.stderr
    return done.stderr.strip().splitlines()[-1]
