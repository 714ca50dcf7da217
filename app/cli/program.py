"""The program `hexapods`: the parser of its commands, and how one is run."""

import argparse
import gc
import importlib
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from app.cli.commands import command_modules
from app.cli.exit_codes import INTERRUPTED
from app.cli.options import CommandParser
from app.cli.robot_names import stored_robots_known
from hexapods.domain.errors import HexapodError
from hexapods.version import __version__


def run(arguments: Sequence[str]) -> int:
    """Run the command that the arguments name, and return its exit code; see `app.cli.main`."""
    try:
        with without_garbage_collection():
            parser = parser_of(arguments)
    except HexapodError as error:
        print(f"hexapods: {error}", file=sys.stderr)
        return 2
    options = parser.parse_args(arguments)
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


def parser_of(arguments: Sequence[str] = ()) -> argparse.ArgumentParser:
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
    for module in command_modules(arguments[0] if arguments else None).values():
        importlib.import_module(module).add_to(commands)
    return parser
