"""Options of a command for declared settings, and for the settings of the agents that it names.

A command takes them by its `**` parameter, whose annotation says of which settings they are:
`**settings: Annotated[Any, DeclaredOptions(...), AgentOptions(...)]`. It gets the values that are
given, by name; for the others the defaults of the declarations hold.
"""

import inspect
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from itertools import pairwise
from typing import Annotated, Any, Protocol, get_args

from cyclopts import CycloptsError, Group, Parameter, Token

from hexapods.domain.errors import HexapodError
from hexapods.domain.settings import REQUIRED, DeclaredSetting, Value
from hexapods.experiments.config import settings_by_name
from hexapods.runs.config import TrainingConfig, agent_settings, usable_agents

Converter = Callable[[Any, Sequence[Token]], Any]
"""Converts the words of an option to its value; a ValueError says what must be given."""
_CLASS = re.compile(r"[^\W\d][\w.]*:[^\W\d]\w*")
"""An agent by its class, such as `my.module:Agent`."""
_LAST = 9
"""Sort key of groups that `--help` shows below the others."""


class OptionSource(Protocol):
    """Makes options of a command; it stands in the annotation of its `**` parameter."""

    def parameters(self, words: Sequence[str] | None) -> Iterable[inspect.Parameter]:
        """Return the parameters of the options.

        Args:
            words: of the command line after the command; None for all options that there may be.
        """


def with_options(
    function: Callable[..., int], words: Sequence[str] | None = None
) -> Callable[..., int]:
    """Return a command whose signature has a parameter for each option of its `**` parameter.

    Args:
        function: the command.
        words: of the command line after it; None for all options that there may be.
    """
    signature = inspect.signature(function)
    *_, last = signature.parameters.values() or (None,)
    if last is None or last.kind is not last.VAR_KEYWORD:
        return function

    @wraps(function)
    def command(*args: Any, **kwargs: Any) -> int:
        return function(*args, **kwargs)

    parameters = [*signature.parameters.values()][:-1]
    for source in get_args(last.annotation)[1:]:
        parameters += source.parameters(words)
    command.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    return command


@dataclass(frozen=True)
class DeclaredOptions:
    """An option for each of some declared settings.

    Attributes:
        settings: the declarations by name.
        names: of the settings that have an option; None for all.
        flags: option by name of the setting, where it is another than that of `flag`.
        lists: whether an option takes several values, separated by commas.
        group: in which `--help` shows the options.
    """

    settings: Mapping[str, DeclaredSetting]
    names: Sequence[str] | None = None
    flags: Mapping[str, str] = field(default_factory=dict)
    lists: bool = False
    group: Group | None = None

    def parameters(self, words: Sequence[str] | None) -> Iterator[inspect.Parameter]:
        """Yield the parameters of the options."""
        del words
        for name in self.settings if self.names is None else self.names:
            setting = self.settings[name]
            yield _parameter(
                setting,
                name=self.flags.get(name, flag(name)),
                converter=reads(setting, lists=self.lists),
                help=_help(setting, lists=self.lists),
                **({} if self.group is None else {"group": self.group}),
                metavar=_metavar(setting, self.lists),
            )


@dataclass(frozen=True)
class AgentOptions:
    """An option for each setting of the agents; those of the named agents are shown in help.

    Attributes:
        is_argument: whether the agent is an argument of the command, and not its option `--agent`.
        flags: option by name of the setting, where the command has one of that name.
        lists: whether an option takes several values, separated by commas.
    """

    is_argument: bool = False
    flags: Mapping[str, str] = field(default_factory=dict)
    lists: bool = False

    def parameters(self, words: Sequence[str] | None) -> Iterator[inspect.Parameter]:
        """Yield the parameters: one group an agent, and hidden those of agents not named."""
        registered = usable_agents()
        named = registered if words is None else self._named(words) or (TrainingConfig.agent,)
        try:
            declared = settings_by_name(named)
        except HexapodError:  # the command reports the unknown agent
            named, declared = (), {}
        for name, (setting, *_) in declared.items():
            groups = [
                Group(f"Settings of {agent}", sort_key=(_LAST, number))
                for number, agent in enumerate(named)
                if name in agent_settings(agent)
            ]
            yield self._parameter(setting, reads(setting, lists=self.lists), group=groups)
        for name, (setting, *_) in settings_by_name(registered).items():
            if name not in declared:
                yield self._parameter(setting, self._refusal(name, named), show=False)

    def _named(self, words: Sequence[str]) -> tuple[str, ...]:
        """Return the agents that a command line names."""
        if self.is_argument:
            registered = usable_agents()
            return tuple(word for word in words if word in registered or _CLASS.fullmatch(word))[:1]
        values = [word.removeprefix("--agent=") for word in words if word.startswith("--agent=")]
        values += [value for option, value in pairwise(words) if option == "--agent"]
        return tuple(name for value in values for name in split(value))

    def _parameter(
        self, setting: DeclaredSetting, converter: Converter, **shown: Any
    ) -> inspect.Parameter:
        return _parameter(
            setting,
            name=self._flag(setting.name),
            converter=converter,
            help=_help(setting, lists=self.lists),
            metavar=_metavar(setting, self.lists),
            **shown,
        )

    def _flag(self, name: str) -> str:
        return self.flags.get(name, flag(name))

    def _refusal(self, name: str, named: Sequence[str]) -> Converter:
        """Return a converter that refuses a setting which none of the named agents has."""

        def refuse(_: Any, tokens: Sequence[Token]) -> str:
            if not named:
                return tokens[0].value
            owners = [agent for agent in usable_agents() if name in agent_settings(agent)]
            valid = ", ".join(map(self._flag, settings_by_name(named)))
            (token,) = tokens
            origin = "" if token.source in ("", "cli") else f" (from {token.source})"
            raise CycloptsError(
                msg=f"{self._flag(name)}{origin} is no setting of {', '.join(named)}, which has "
                f"{valid or 'none'}; it is one of {', '.join(owners)}"
            )

        return refuse


def _parameter(setting: DeclaredSetting, **option: Any) -> inspect.Parameter:
    default = None if setting.default is REQUIRED else setting.default
    if setting.choices:
        option["completer"] = lambda _: [*setting.choices]
    return inspect.Parameter(
        setting.name,
        inspect.Parameter.KEYWORD_ONLY,
        default=default,
        annotation=Annotated[object, Parameter(n_tokens=1, show_default=False, **option)],
    )


def _metavar(setting: DeclaredSetting, lists: bool) -> str:
    if lists:
        return "LIST"
    return "VALUE" if not setting.is_number else "N" if setting.is_whole else "X"


def _help(setting: DeclaredSetting, lists: bool = False) -> str:
    about, default = setting.about, setting.default
    # The placeholder of the option's value already says which kind of number it takes.
    valid = re.sub(r"^a (whole )?number (of )?", "", setting.valid)
    if default is not REQUIRED and default is not None:
        valid = f"{valid}; default {default}"
    if lists and about.examples:
        examples = ",".join(f"{value:g}" for value in about.examples)
        return f"such as {examples} [each {valid}]"
    return f"{about.help} [{valid}]".lstrip()


def reads(setting: DeclaredSetting, *, lists: bool = False) -> Converter:
    """Return a converter to a value of a setting, whose error names the valid values.

    Args:
        setting: the declaration.
        lists: whether it converts several values, separated by commas, to a tuple.
    """

    def parse(text: str) -> Value:
        try:
            return setting.parse(text)
        except ValueError as error:
            raise ValueError(f"must be {setting.valid}, not {text!r}") from error

    def convert(_: Any, tokens: Sequence[Token]) -> Value | tuple[Value, ...]:
        (token,) = tokens
        return tuple(map(parse, split(token.value))) if lists else parse(token.value)

    return convert


def split(text: str) -> list[str]:
    """Split a comma-separated list."""
    return [part.strip() for part in text.split(",")]


def flag(name: str) -> str:
    """Return the option of a setting: `--grid-side-m`."""
    return f"--{name.replace('_', '-')}"
