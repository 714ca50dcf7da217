"""The program `hexapods`: its commands by their functions' signatures, and how one is run.

A command is a function that returns an exit code: its signature declares arguments and options,
and its docstring is shown by `--help`. A function that returns an `App` makes a command of several
verbs, or one whose help depends on what is installed.
"""

import gc
import inspect
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from cyclopts import App, CycloptsError, MissingArgumentError, Parameter, UnusedCliTokensError
from cyclopts.help import DefaultFormatter, PanelSpec
from rich.box import Box
from rich.console import Console

from app.cli.commands import command_paths, load
from app.cli.configuration import FILE, OPTION, Configuration, sentence_of, take_option
from app.cli.exit_codes import INTERRUPTED
from app.cli.robot_names import stored_robots_known
from app.cli.setting_options import with_options
from hexapods.domain.errors import HexapodError
from hexapods.version import __version__

_HELP = ("--help", "-h")
_FORMAT = DefaultFormatter(panel_spec=PanelSpec(box=Box("    \n" * 8), padding=(0, 0, 0, 4)))
"""Help without lines around groups, which would also be in files and read out aloud."""


def run(arguments: Sequence[str]) -> int:
    """Run the command that the arguments name, and return its exit code; see `app.cli.main`."""
    try:
        path, words = take_option(arguments)
        configuration = Configuration.read(path)
        with configuration.settings_in_environment():
            return _run(words, configuration)
    except HexapodError as error:
        print(f"hexapods: {error}", file=sys.stderr)
        return 2


def _run(arguments: Sequence[str], configuration: Configuration) -> int:
    """Run a command; what its command line leaves open, a configuration may say."""
    name = "hexapods"
    try:
        with without_garbage_collection():
            program = program_of(arguments, configuration)
            chain, apps, _ = program.parse_commands(arguments)
            name = " ".join(("hexapods", *chain[:1]))
            command, bound, _ = program.parse_args(
                arguments, console=_Output(), exit_on_error=False, print_error=False
            )
            if command == program.help_print and not {*_HELP} & {*arguments}:
                verbs = [verb for verb in apps[-1] if not verb.startswith("-")]
                raise CycloptsError(msg=f"name a command: {', '.join(verbs)}")
    except (CycloptsError, HexapodError) as error:
        print(f"{name}: {_sentence(error, configuration)}", file=sys.stderr)
        return 2
    try:
        with stored_robots_known(bound.arguments.get("data")):
            code: int | None = command(*bound.args, **bound.kwargs)
    except HexapodError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    return code or 0


def _sentence(error: CycloptsError | HexapodError, configuration: Configuration) -> str:
    """Return what is wrong with the arguments, and what is valid."""
    if isinstance(error, MissingArgumentError) and error.argument is not None:
        option, valid = error.argument, error.argument.parameter.help
        return f"{error.keyword or option.name} needs a value{f': {valid}' if valid else ''}"
    if isinstance(error, UnusedCliTokensError):
        return f"there is no argument {', '.join(map(repr, error.unused_tokens or ()))}; see --help"
    return str(error) if isinstance(error, HexapodError) else sentence_of(error, configuration)


def program_of(
    arguments: Sequence[str] | None = None, configuration: Configuration | None = None
) -> App:
    """Return the program with the command that the arguments begin with, or else with all.

    Importing all of them takes twice the time in which most commands start.

    Args:
        arguments: of the command line, which may name agents; None for all commands and all agents.
        configuration: may name an agent too, and says what else the command line leaves open.

    Raises:
        InvalidInput: as `command_paths`.
    """
    program = App(
        name="hexapods",
        help="Six-legged robots that learn to walk, and race against look-ahead search.\n\n"
        f"Settings and options may stand in {FILE}, or in the file of {OPTION}.",
        version=f"hexapods {__version__}",
        help_flags=_HELP,
        help_format="markdown",
        help_formatter=_FORMAT,
        default_parameter=Parameter(negative=(), allow_repeating=True, show_default=_shown),
    )
    if configuration is not None:
        program.config = configuration.sources(program)
    first, *words = arguments or (None,)
    for name, path in command_paths(first).items():
        function = load(path)
        if inspect.signature(function).return_annotation is App:
            program.command(function(), name=name)
        else:
            shown = [*words] if name == first else None
            if shown is not None and configuration is not None:
                shown += configuration.agent_words(name, shown)
            program.command(with_options(function, shown), name=name)
    program.register_install_completion_command(help="Install completion in the shell.")
    return program


def _shown(default: Any) -> str | None:
    """Return the text of a default in `--help`; None for those that say nothing."""
    return None if default is None or default is False or default == () else str(default)


class _Output(Console):
    """Standard output; `app.cli.main` ends the program if its reader has gone."""

    def on_broken_pipe(self) -> None:
        """Raise what the console would end the program for, with another exit code."""
        raise BrokenPipeError


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
