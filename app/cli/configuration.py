"""Options and settings from a configuration file and from the environment.

The file, `hexapods.toml` of the working directory or that of `--config`, has the settings of a
server by their names, as `port` of HEXAPODS_PORT, and the options of each command in a table:

    quota_mb = 500
    [train]
    steps = 1000

In the environment the latter is HEXAPODS_TRAIN_STEPS. An option that is a setting, such as
`--data`, has the setting's name alone. The command line comes first, then the environment, then
the file.
"""

import json
import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import Field, dataclass, field, fields
from itertools import chain
from pathlib import Path
from typing import Any

from cyclopts import App, ArgumentCollection, CycloptsError
from cyclopts.config import Dict

from app.cli.commands import command_paths
from app.cli.setting_options import flag
from app.feature_settings import installed_settings
from app.setting_fields import PREFIX, kind_of, variable_of
from app.settings import Settings, read_without
from hexapods.domain.errors import InvalidInput, UnknownName

FILE = "hexapods.toml"
"""Configuration file of the working directory."""
VARIABLE = f"{PREFIX}CONFIG"
"""Environment variable that names another configuration file."""
OPTION = "--config"
ENVIRONMENT = "environment"
"""Source of options that a variable gives."""


def take_option(words: Sequence[str]) -> tuple[str | None, list[str]]:
    """Return the configuration file that a command line names, and the command line without it.

    Raises:
        InvalidInput: if the option has no value.
    """
    rest, path = list(words), None
    end = rest.index("--") if "--" in rest else len(rest)
    for at, word in enumerate(rest[:end]):
        if word == OPTION:
            if at + 1 >= end:
                raise InvalidInput(f"{OPTION} needs a value: a TOML file, such as {FILE}")
            path = rest[at + 1]
            del rest[at : at + 2]
            break
        if word.startswith(f"{OPTION}="):
            path = word.removeprefix(f"{OPTION}=")
            del rest[at]
            break
    return path, rest


@dataclass(frozen=True)
class Configuration:
    """What a configuration file and the environment say.

    Attributes:
        file: name of the file, as in messages; None without one.
        content: its values, by key.
        environ: the environment.
    """

    file: str | None = None
    content: Mapping[str, Any] = field(default_factory=dict)
    environ: Mapping[str, str] = field(default_factory=lambda: os.environ)

    @classmethod
    def read(cls, path: str | None = None) -> "Configuration":
        """Read the file of a path, of HEXAPODS_CONFIG, or the one of the working directory.

        Raises:
            InvalidInput: if a file that is named does not exist, or one cannot be read.
        """
        named = path or os.environ.get(VARIABLE)
        if named is None and not Path(FILE).exists():
            return cls()
        file = named or FILE
        try:
            content = tomllib.loads(Path(file).expanduser().read_text("utf-8"))
        except OSError as error:
            raise InvalidInput(
                f"cannot read the configuration {file}: {error.strerror}; name a TOML file by "
                f"{OPTION} or {VARIABLE}"
            ) from error
        except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
            raise InvalidInput(f"the configuration {file} is not valid TOML: {error}") from error
        return cls(file, content)

    @property
    def tables(self) -> dict[str, Mapping[str, Any]]:
        """Options of commands in the file, by command."""
        return {key: value for key, value in self.content.items() if isinstance(value, dict)}

    def setting_texts(self) -> dict[str, str]:
        """Return the settings of the file as texts of variables, by their names; checked.

        Raises:
            InvalidInput: if a key is neither a setting nor a command, or a value is not valid.
        """
        written = {key: value for key, value in self.content.items() if key not in self.tables}
        if not self.content:
            return {}
        declared, commands = declared_settings(), command_paths()
        for key in self.content:
            if key in self.tables and key not in commands:
                raise InvalidInput(f"{self.file}: {UnknownName('command', key, commands)}")
            if key in written and key not in declared:
                options = [name for name, table in self.tables.items() if key in table]
                also = f" (in [{options[0]}] it is an option)" if options else ""
                if key in commands:
                    raise InvalidInput(f"{self.file}: {key} must be a table: [{key}]")
                raise InvalidInput(f"{self.file}: {UnknownName('setting', key, declared)}{also}")
        return {key: self._text(declared[key], value) for key, value in written.items()}

    def _text(self, declared: Field[Any], value: Any) -> str:
        label = f"{declared.name} of {self.file}"
        match value:
            case bool():
                text = str(int(value))
            case str() | int() | float():
                text = str(value)
            case [*names] if all(isinstance(name, str) for name in names):
                text = ",".join(names)
            case _:
                raise InvalidInput(f"{label} must be a text, a number, true, false or a list")
        if text and (kind := kind_of(declared)) is not None:
            kind.check(label, kind.read(label, text))  # type: ignore[arg-type]  # its own value
        return text

    @classmethod
    def current(cls) -> "tuple[Configuration, Mapping[str, str]]":
        """Return the configuration of the command that runs, and the variables that it has set."""
        return _CURRENT.get() or (cls(), {})

    @contextmanager
    def settings_in_environment(self) -> Iterator[None]:
        """Set the variables of the file's settings that are not set, as long as the context lasts.

        All that reads settings reads them there, in processes that this one starts, too.

        Raises:
            InvalidInput: as `setting_texts`.
        """
        texts = {variable_of(name): text for name, text in self.setting_texts().items()}
        added = {name: text for name, text in texts.items() if not os.environ.get(name)}
        os.environ.update(added)
        reset = _CURRENT.set((self, added))
        try:
            yield
        finally:
            _CURRENT.reset(reset)
            for name in added:
                os.environ.pop(name, None)

    def variables_of(self, command: Sequence[str]) -> dict[str, str]:
        """Return the variables that are set of a command's options: values by variable."""
        prefix = _prefix(command)
        return {
            name: value for name, value in self.environ.items() if name.startswith(prefix) and value
        }

    def agent_words(self, command: str, words: Sequence[str]) -> list[str]:
        """Return the option `--agent` of a command as words, if the command line has none."""
        if any(word == "--agent" or word.startswith("--agent=") for word in words):
            return []
        table = self.tables.get(command, {})
        agent = self.environ.get(f"{_prefix([command])}AGENT") or table.get("agent")
        return ["--agent", agent] if isinstance(agent, str) else []

    def sources(self, program: App) -> "list[_Source]":
        """Return what adds options to those of the command line, the first before the second."""
        return [_Source(self, program, ENVIRONMENT), _Source(self, program, self.file or FILE)]

    def label(self, command: Sequence[str], source: str, key: str) -> str:
        """Return where an option stands, for messages."""
        if source == ENVIRONMENT:
            return _prefix(command) + key.replace("-", "_").upper()
        return f"{key} in [{'.'.join(command)}] of {self.file}"


_CURRENT: ContextVar[tuple[Configuration, Mapping[str, str]] | None] = ContextVar(
    "configuration", default=None
)


@dataclass(frozen=True)
class _Source:
    """Adds options of a file or of the environment, where nothing before has them (cyclopts)."""

    configuration: Configuration
    program: App
    source: str

    def __call__(self, app: App, commands: tuple[str, ...], arguments: ArgumentCollection) -> None:
        """Add the options of a command to its arguments.

        Raises:
            CycloptsError: if one is unknown, or no option but a setting.
        """
        lists = {
            _key(name): argument.token_count()[1]
            for argument in arguments
            for name in argument.names
            if name.startswith("--")
        }
        shown = [_key(argument.name) for argument in arguments if argument.show]
        values = self._values(commands)
        settings = declared_settings() if values else {}
        for key in values:
            label = self.configuration.label(commands, self.source, key)
            name = key.replace("-", "_")
            if name in settings and key in lists:
                instead = (
                    variable_of(name)
                    if self.source == ENVIRONMENT
                    else f"`{name} = …` above the tables"
                )
                raise CycloptsError(
                    msg=f"{label}: {name} is a setting, of all commands; write {instead}"
                )
            if key not in lists:
                valid = [option for option in shown if option.replace("-", "_") not in settings]
                what = f"option of {' '.join(commands)}"
                raise CycloptsError(msg=f"{label}: {UnknownName(what, key, valid)}")
        if self.source == ENVIRONMENT:
            values = {key: text.split() if lists[key] else text for key, text in values.items()}
        else:
            values = {key: _plain(value, is_list=lists[key]) for key, value in values.items()}
        data: dict[str, Any] = values
        for command in reversed(commands):
            data = {command: data}
        Dict(data, source=self.source)(app, commands, arguments)

    def _values(self, commands: tuple[str, ...]) -> dict[str, Any]:
        """Return the values of a command's options by key, with hyphens."""
        if self.source == ENVIRONMENT:
            texts = self.configuration.variables_of(commands)
            prefix = _prefix(commands)
            return {_key(name.removeprefix(prefix)): text for name, text in texts.items()}
        table: Mapping[str, Any] = self.configuration.content
        place = self.program
        for depth, command in enumerate(commands):
            verbs = {verb for verb in place if not verb.startswith("-")}
            if depth and (unknown := [key for key in table if key not in verbs]):
                table_name = ".".join(commands[:depth])
                raise CycloptsError(
                    msg=f"{self.source}: [{table_name}] has a table for each verb: "
                    f"{UnknownName('verb', unknown[0], verbs)}"
                )
            inner = table.get(command, {})
            if not isinstance(inner, dict):
                raise CycloptsError(
                    msg=f"{self.source}: {command} must be a table: [{'.'.join(commands)}]"
                )
            table, place = inner, place[command]
        return {_key(key): value for key, value in table.items()}


def _plain(value: Any, *, is_list: bool) -> Any:
    """Return a value of the file as the words that an option takes."""
    if isinstance(value, dict):
        return json.dumps(value)
    if isinstance(value, list) and not is_list:
        return ",".join(map(str, value))
    return value


def declared_settings() -> dict[str, Field[Any]]:
    """Return the declarations of all settings, of the core and of features, by name."""
    declared = [*fields(Settings), *chain(*map(fields, installed_settings(read_without())))]
    return {each.name: each for each in declared if each.name != "features"}


def sentence_of(error: CycloptsError, configuration: Configuration) -> str:
    """Return what is wrong with an option that the file or the environment gives."""
    token = getattr(error, "token", None)
    command = tuple(error.command_chain or ())
    text = str(error)
    if (
        token is None
        or token.keyword is None
        or token.source
        not in (
            ENVIRONMENT,
            configuration.file,
        )
    ):
        return text
    key = token.keyword.strip("[]")
    label = configuration.label(command, token.source, key)
    text = text.replace(f" from {token.source}", "")
    return text.replace(token.keyword, label).replace(flag(key), label)


def _prefix(command: Sequence[str]) -> str:
    return PREFIX + "".join(f"{word.replace('-', '_').upper()}_" for word in command)


def _key(name: str) -> str:
    return name.lstrip("-").replace("_", "-").lower()
