"""Runs a function of the tests in a process of its own, which may be killed."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def start_script(
    module: str, *arguments: str, before: tuple[str, ...] = ()
) -> "subprocess.Popen[str]":
    """Start `python -m module`; it says what it does line by line.

    Args:
        module: of the tests.
        arguments: of its command line.
        before: what to put before the command.
    """
    return subprocess.Popen(
        [*before, sys.executable, "-m", module, *arguments],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
