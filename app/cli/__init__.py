"""The `hexapods` command: arguments in, one call out."""

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
    """Run one command; the exit code is 2 for what cannot be done as asked, with one sentence."""
    # A terminal that cannot show an α or a tick is no reason to end.
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
