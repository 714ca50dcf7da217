"""`hexapods config`: the settings and options that hold, and where each comes from."""

import json
import sys
from collections.abc import Iterator
from typing import Any, NamedTuple

from cyclopts import App, ArgumentCollection, CycloptsError, MissingArgumentError

from app.cli.commands import command_paths
from app.cli.configuration import ENVIRONMENT, Configuration, declared_settings, sentence_of
from app.cli.options import AsJson
from app.cli.terminal import show_table
from app.setting_fields import variable_of
from app.settings import read_settings
from hexapods.domain.errors import InvalidInput


class _Row(NamedTuple):
    """A setting, or an option of a command.

    Attributes:
        name: of the setting, or the command and its option.
        value: in plain types.
        source: a variable, the configuration file, or `default`.
    """

    name: str
    value: Any
    source: str


def config(*, as_json: AsJson = False) -> int:
    """Show the settings that hold, and the options that hexapods.toml and the environment give.

    Each is shown with where it comes from. Options that are given nowhere are shown by --help of
    their commands. Secrets are not printed.

    Raises:
        InvalidInput: if one of them is not valid.
    """
    configuration, added = Configuration.current()
    settings = [*_settings(configuration, added)]
    options = [*_options(configuration)]
    if as_json:
        rows_of = {"settings": settings, "options": options}
        shown = {key: [row._asdict() for row in rows] for key, rows in rows_of.items()}
        print(json.dumps({"file": configuration.file, **shown}))
        return 0
    file = configuration.file
    print("There is no hexapods.toml here." if file is None else f"The file is {file}.")
    for title, rows in (("Settings", settings), ("Options", options)):
        texts = [(row.name, _text(row.value), row.source) for row in rows]
        if texts and sys.stdout.isatty():
            show_table(title, ("name", "value", "from"), texts, text=(0, 1, 2))
        elif texts:
            print("\n".join(map("\t".join, texts)))
    return 0


def _text(value: Any) -> str:
    if isinstance(value, list):
        return ",".join(map(str, value))
    return "" if value is None else str(value)


def _settings(configuration: Configuration, added: Any) -> Iterator[_Row]:
    settings = read_settings()
    for values in (settings, *settings.features):
        for declared in declared_settings().values():
            if not hasattr(values, declared.name):
                continue
            value, variable = getattr(values, declared.name), variable_of(declared.name)
            if variable in added:
                source = str(configuration.file)
            else:
                source = variable if configuration.environ.get(variable) else "default"
            if not declared.repr and value is not None:
                value = "(secret)"
            is_plain = isinstance(value, int | str | None)
            plain = list(value) if isinstance(value, tuple) else value if is_plain else str(value)
            yield _Row(declared.name, plain, source)


def _options(configuration: Configuration) -> Iterator[_Row]:
    """Yield the options that the file and the environment give, of each command that is there."""
    from app.cli.program import program_of  # noqa: PLC0415 - it imports this package's commands

    for command in command_paths():
        has_variables = bool(configuration.variables_of([command]))
        if not has_variables and command not in configuration.tables:
            continue
        program = program_of([command], configuration)
        verbs = [verb for verb in program[command] if not verb.startswith("-")]
        for chain in [[command, verb] for verb in verbs] or [[command]]:
            yield from _options_of(program, chain, configuration)


def _options_of(program: App, chain: list[str], configuration: Configuration) -> Iterator[_Row]:
    rows: list[_Row] = []

    def note(_: App, commands: tuple[str, ...], arguments: ArgumentCollection) -> None:
        for argument in arguments:
            if argument.tokens:
                token = argument.tokens[0]
                values = [each.value for each in argument.tokens]
                source = str(configuration.file)
                if token.source == ENVIRONMENT:
                    key = argument.name.removeprefix("--")
                    source = configuration.label(commands, ENVIRONMENT, key)
                name = f"{' '.join(commands)} {argument.name}"
                rows.append(_Row(name, values if len(values) > 1 else values[0], source))

    program.config = [*configuration.sources(program), note]
    try:
        program.parse_args(chain, exit_on_error=False, print_error=False)
    except MissingArgumentError:
        pass  # that is for the command line
    except CycloptsError as error:
        raise InvalidInput(sentence_of(error, configuration)) from error
    yield from rows
