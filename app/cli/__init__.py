"""The `hexapods` command line: each command is a function that makes one call.

Its signature declares arguments and options, and its docstring is its description in `--help`.
Commands: `serve`, `train`, `race`, `benchmark`, `runs` (list, show, delete), `verify`
(by a `verifier` of each kind of file; score files in `verify_benchmark`), `config` (what holds of a
`configuration`), `doctor` (with checks in `machine_checks` and `data_checks`), `bench` (with the
measurements in `benchmarks`).
`program` makes the program of all, and runs one.
Features add commands of their own, and verbs and verifiers of these (`commands`).
Shared: `options` (options and readers of their values), `setting_options` (options of declared
settings and of agents), `files` (files that users name), `stored_runs` (runs of a data folder),
`kept_runs` (trainings and races that stay there, which a `run_keeper` computes), `configuration`
(options of a file and of the environment), `robot_names` (stored robots by name), `server_client`
(requests to a running server), `terminal` (progress bars and tables), `exit_codes`.
"""

import io
import os
import select
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from hexapods.version import __version__

_OUTPUT_CLOSED = 128 + 13
"""Exit code that a shell reports of a tool that SIGPIPE ended."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    It is 1 if something that was computed failed, 2 after a `HexapodError`, 130 after SIGINT, and
    141 if the reader of standard output has gone, as of `| head`: what a shell reports of its own
    tools.
    """
    # Replace characters that the terminal cannot encode, rather than fail.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    sys.path.insert(0, "")  # so that --agent my_agent:Agent finds my_agent.py in this folder
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        try:
            if list(arguments) == ["--version"]:
                print(f"hexapods {__version__}")
                return 0
            # Imported here: its imports take longer than it takes to answer the above.
            from app.cli.program import run  # noqa: PLC0415

            return run(arguments)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        if not _has_no_reader(sys.stdout):
            raise
        with Path(os.devnull).open("w") as nowhere:  # for what Python still writes when it ends
            os.dup2(nowhere.fileno(), sys.stdout.fileno())
        return _OUTPUT_CLOSED


def _has_no_reader(output: TextIO) -> bool:
    if sys.platform == "win32":
        return True  # it cannot be asked there
    poll = select.poll()
    poll.register(output.fileno(), 0)  # errors and the other end's closing are always told
    return bool(poll.poll(0))
