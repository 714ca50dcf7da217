"""Run `hexapods` in a subprocess and a working folder of its own, as a user does."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "docs" / "examples"


def hexapods(*arguments: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command to its end, with additional environment variables."""
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
    """Return the error message of a command, which must exit with 2."""
    done = hexapods(*arguments, folder=folder)
    assert done.returncode == 2, (done.returncode, done.stdout, done.stderr)
    assert "Traceback" not in done.stderr
    return done.stderr.strip().splitlines()[-1]
