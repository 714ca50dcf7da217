"""Run a module of the tests in a process of its own, which may be killed."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def start_script(
    module: str, *arguments: str, before: tuple[str, ...] = ()
) -> "subprocess.Popen[str]":
    """Start `python -m module` with pipes for standard input and output.

    Args:
        module: name of the module.
        arguments: its command-line arguments.
        before: command prefix, such as `nice`.
    """
    return subprocess.Popen(
        [*before, sys.executable, "-m", module, *arguments],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
