"""The `hexapods` command line: each command parses its options and makes one call.

Commands: `serve`, `train`, `race`, `benchmark`, `runs` (list, show, delete), `verify`
(by a `verifier` of each kind of file; score files in `verify_benchmark`), `doctor` (with checks in
`machine_checks` and `data_checks`), `bench` (with the measurements in `benchmarks`).
Most descriptions in `--help` are module docstrings.
Features add commands of their own, and verbs and verifiers of these (`commands`).
Shared: `options` (options and parsers of their values), `files` (files that users name),
`stored_runs` (runs of a data folder), `robot_names` (stored robots by name), `server_client`
(requests to a running server), `terminal` (progress bars and tables), `exit_codes`.
"""

import argparse
import gc
import importlib
import io
import os
import select
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from app.cli.commands import command_modules
from app.cli.exit_codes import INTERRUPTED
from app.cli.options import CommandParser
from app.cli.robot_names import stored_robots_known
from hexapods import __version__
from hexapods.domain.errors import HexapodError

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
    given = sys.argv[1:] if arguments is None else arguments
    try:
        try:
            return _run(given)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        if not _has_no_reader(sys.stdout):
            raise
        with Path(os.devnull).open("w") as nowhere:  # for what Python still writes when it ends
            os.dup2(nowhere.fileno(), sys.stdout.fileno())
        return _OUTPUT_CLOSED


def _run(given: Sequence[str]) -> int:
    try:
        with without_garbage_collection():
            parser = _parser(given)
    except HexapodError as error:
        print(f"hexapods: {error}", file=sys.stderr)
        return 2
    options = parser.parse_args(given)
    try:
        with stored_robots_known(vars(options).get("data")):
            code: int = options.run(options)
    except HexapodError as error:
        print(f"hexapods {options.command}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    return code


def _has_no_reader(output: TextIO) -> bool:
    poll = select.poll()
    poll.register(output.fileno(), 0)  # errors and the other end's closing are always told
    return bool(poll.poll(0))


@contextmanager
def without_garbage_collection() -> Iterator[None]:
    """Disable garbage collection during imports, and exempt the imported objects from it.

    Modules last as long as the process. Their objects are so many that looking for garbage among
    them takes up to a third of the time in which a server starts, and again when it ends.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if was_enabled:
            gc.enable()


def _parser(arguments: Sequence[str] = ()) -> argparse.ArgumentParser:
    """Return the parser of the command that the arguments begin with, or else of all commands.

    Importing all of them takes twice the time in which most commands start.
    """
    parser = argparse.ArgumentParser(
        prog="hexapods",
        description="Six-legged robots that learn to walk, and race against look-ahead search.",
    )
    parser.add_argument("--version", action="version", version=f"hexapods {__version__}")
    commands = parser.add_subparsers(
        dest="command", required=True, metavar="COMMAND", parser_class=CommandParser
    )
    if list(arguments) != ["--version"]:  # which needs no command
        for module in command_modules(arguments[0] if arguments else None).values():
            importlib.import_module(module).add_to(commands)
    return parser
