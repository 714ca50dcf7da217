"""The `hexapods` command line: each command parses its options and makes one call.

Commands: `serve`, `train`, `race`, `experiment`, `sweep`, `tune`, `best-known`, `runs` (list,
show, delete; `run_files` has its verbs that write files), `export`, `imports`, `doctor` (with
checks in `data_diagnostics` and `physics_diagnostics`), `bench` (with the measurements in
`benchmarks`). Their module docstrings are the descriptions in `--help`.
Shared: `options` (options and parsers of their values), `trial_options` and `trials` (experiments
and sweeps), `files` (files that users name), `stored_runs` (runs of a data folder),
`server_client` (requests to a running server), `terminal` (progress bars and tables).
"""

import argparse
import gc
import importlib
import io
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from app import __version__
from app.cli.options import CommandParser
from app.domain.errors import HexapodError

COMMANDS = {
    "serve": "serve",
    "train": "train",
    "race": "race",
    "experiment": "experiment",
    "sweep": "sweep",
    "tune": "tune",
    "best-known": "best_known",
    "runs": "runs",
    "export": "export",
    "import": "imports",
    "doctor": "doctor",
    "bench": "bench",
}
"""Name of the module of each command."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 2 after a `HexapodError`, 130 after SIGINT."""
    # Replace characters that the terminal cannot encode, rather than fail.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    sys.path.insert(0, "")  # so that --agent my_agent:Agent finds my_agent.py in this folder
    given = sys.argv[1:] if arguments is None else arguments
    with without_garbage_collection():
        parser = _parser(given)
    options = parser.parse_args(given)
    try:
        code: int = options.run(options)
    except HexapodError as error:
        print(f"hexapods {options.command}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    return code


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
    named = [name for name in arguments[:1] if name in COMMANDS]
    for name in named or COMMANDS:
        importlib.import_module(f"app.cli.{COMMANDS[name]}").add_to(commands)
    return parser
