"""The `hexapods` command line: each command parses its options and makes one call.

Commands: `serve`, `train`, `race`, `experiment`, `sweep`, `runs` (list, show, delete), `export`,
`imports`, `doctor` (with checks in `data_diagnostics` and `physics_diagnostics`), `bench` (with the
measurements in `benchmarks`). Their module docstrings are the descriptions in `--help`.
Shared: `options` (options and parsers of their values), `trial_options` and `trials` (experiments
and sweeps), `files` (files that users name), `server_client` (requests to a running server),
`terminal` (progress bars and tables).
"""

import argparse
import io
import sys
from collections.abc import Sequence

from app import __version__
from app.cli import (
    bench,
    doctor,
    experiment,
    export,
    imports,
    race,
    runs,
    serve,
    sweep,
    train,
)
from app.cli.options import CommandParser
from app.domain.errors import HexapodError

COMMANDS = (serve, train, race, experiment, sweep, runs, export, imports, doctor, bench)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 2 after a `HexapodError`, 130 after SIGINT."""
    # Replace characters that the terminal cannot encode, rather than fail.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    sys.path.insert(0, "")  # so that --agent my_agent:Agent finds my_agent.py in this folder
    options = _parser().parse_args(arguments)
    try:
        code: int = options.run(options)
    except HexapodError as error:
        print(f"hexapods {options.command}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="hexapods",
        description="Six-legged robots that learn to walk, and race against look-ahead search.",
    )
    parser.add_argument("--version", action="version", version=f"hexapods {__version__}")
    commands = parser.add_subparsers(
        dest="command", required=True, metavar="COMMAND", parser_class=CommandParser
    )
    for command in COMMANDS:
        command.add_to(commands)
    return parser
