"""Run `hexapods` in a subprocess and a working folder of its own, as a user does."""

import contextlib
import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from app.cli import main

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


def refusal_in_process(*arguments: str, folder: Path) -> str:
    """Return the error message as `refusal` does, of a command that runs in this process.

    It takes a tenth of the time of another process.
    """
    said = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stderr(said):
        patch.chdir(folder)
        patch.setattr(sys, "path", [*sys.path])
        try:
            code: object = main(arguments)
        except SystemExit as ended:
            code = ended.code
    assert code == 2, (code, said.getvalue())
    return said.getvalue().strip().splitlines()[-1]
