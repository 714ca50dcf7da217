"""Run `hexapods` in a working folder, in a process of its own as a user does, or in this one."""

import contextlib
import gc
import io
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from app.cli import main
from tests.forked import start_hexapods

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "docs" / "examples"
_DATA = "HEXAPODS_DATA"
Run = Callable[..., subprocess.CompletedProcess[str]]


def hexapods(*arguments: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command to its end, with additional environment variables.

    Its data folder is one of the test's, not the user's.
    """
    with tempfile.TemporaryFile("w+", encoding="utf-8") as errors:
        env = {"PATH": "/usr/bin:/bin", _DATA: str(folder / "data"), **variables}
        process = start_hexapods(arguments, env, errors, folder)
        assert process.stdout is not None
        with process.stdout as printed:
            text = printed.read()
        code = process.wait()
        errors.seek(0)
        return subprocess.CompletedProcess(arguments, code, text, errors.read())


def in_process(*arguments: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command like `hexapods`, but in this process, which takes a tenth of the time."""
    out, err = io.StringIO(), io.StringIO()
    with (
        pytest.MonkeyPatch.context() as patch,
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        for name in [name for name in os.environ if name.startswith("HEXAPODS_")]:
            patch.delenv(name)
        for name, value in {_DATA: str(folder / "data"), **variables}.items():
            patch.setenv(name, value)
        patch.chdir(folder)
        patch.setattr(sys, "path", [*sys.path])
        # Garbage of the tests before must not be exempted from collection.
        patch.setattr(gc, "freeze", lambda: None)
        try:
            code: Any = main(arguments)
        except SystemExit as ended:
            code = ended.code
    return subprocess.CompletedProcess(arguments, code, out.getvalue(), err.getvalue())


def output(*arguments: str, folder: Path, run: Run = hexapods) -> Any:
    """Return the JSON that a command, which must succeed, prints."""
    done = run(*arguments, "--json", folder=folder)
    assert done.returncode == 0, done.stderr
    assert done.stderr == "", "a program that reads JSON gets no progress bar"
    return json.loads(done.stdout)


def refusal(*arguments: str, folder: Path, run: Run = hexapods, **variables: str) -> str:
    """Return the error message of a command, which must exit with 2."""
    done = run(*arguments, folder=folder, **variables)
    assert done.returncode == 2, (done.returncode, done.stdout, done.stderr)
    assert "Traceback" not in done.stderr
    return done.stderr.strip().splitlines()[-1]
