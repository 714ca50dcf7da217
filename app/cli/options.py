"""Options that several commands share, and the parsers of their values."""

import argparse
import contextlib
import json
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from app.cli.robot_names import stored_robot
from hexapods.domain.disturbance_documents import parse_disturbance
from hexapods.domain.disturbances import KINDS
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.gait import NAMED_GAITS, GaitSpec
from hexapods.domain.gait import read_gait as gait_of_legs
from hexapods.domain.observation import OBSERVATIONS
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.settings import REQUIRED, DeclaredSetting, Value, declared_fields
from hexapods.domain.world import WORLDS, world_from
from hexapods.experiments.config import settings_by_name
from hexapods.runs.config import SIMULATORS, TrainingConfig, WalkingProblem, usable_agents


def add_walk_options(parser: argparse.ArgumentParser, needs_gait: bool = True) -> None:
    """Add the options of the walking problem: gait, robot, simulator, foot grid."""
    parser.add_argument(
        "--gait",
        required=needs_gait,
        help=f"gait: {', '.join(NAMED_GAITS)}, or JSON such as "
        '\'{"right_leg": 1, "left_leg": 2, "symmetry": "origin"}\' (or "pairs": [[1, 4], …], '
        'or "groups": [[1, 3, 5], …])',
    )
    parser.add_argument(
        "--robot",
        default="stiff",
        help=f"robot: {', '.join(PRESETS)}, the name or id of a stored one, a TOML file, or JSON "
        "with changes of a preset or stored one",
    )
    parser.add_argument(
        "--simulator", default="mujoco", help=f"simulator: {' or '.join(SIMULATORS)}"
    )
    add_settings(parser, declared_fields(WalkingProblem))
    parser.add_argument("--world", help=f"named world: {', '.join(WORLDS)}")
    parser.add_argument(
        "--disturb",
        action="append",
        default=[],
        metavar="KIND:FIELD=VALUE:at=STEP:until=STEP",
        help=f"disturbance, such as limp:legs=1,4:at=25; repeat for several: {', '.join(KINDS)}",
    )


def add_settings(
    parser: argparse.ArgumentParser,
    settings: Mapping[str, DeclaredSetting],
    names: Iterable[str] | None = None,
    flags: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """Add an option for each declared setting, or for those that are named.

    `flags` has names of options that are others than those of `flag`.
    """
    for name in settings if names is None else names:
        setting = settings[name]
        parser.add_argument(
            flags.get(name, flag(name)),
            dest=name,
            type=parser_of(setting),
            default=setting.default,
            help=_help(setting),
        )


class CommandParser(argparse.ArgumentParser):
    """Parser of a command, optionally with an option for each setting of the agents.

    These are the registered agents and those named by `--agent`, whose modules are imported only
    when the arguments are parsed.

    Attributes:
        offers_settings: whether the parser has options for the agents' settings.
        takes_lists: whether such an option takes several values, separated by commas.
        takes_agent_first: whether the agent is an argument, and no option.
        setting_flags: by name of a setting its option, where the command has one of that name.
    """

    offers_settings = takes_lists = takes_agent_first = False
    setting_flags: Mapping[str, str] = MappingProxyType({})

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Add the options of the agents' settings, then parse."""
        if self.offers_settings:
            agent_parser = argparse.ArgumentParser(add_help=False)
            agent_parser.add_argument("--agent", action="append", default=[])
            given, _ = agent_parser.parse_known_args(args)
            named = [name for text in given.agent for name in split(text)]
            if self.takes_agent_first:
                named = [text for text in args or () if text in usable_agents() or ":" in text][:1]
            own: Mapping[str, Sequence[DeclaredSetting]] = {}
            with contextlib.suppress(HexapodError):  # the command reports the unknown agent
                own = settings_by_name(named or [TrainingConfig.agent])
            self._add_settings(own, settings_by_name(usable_agents()))
        return super().parse_known_args(args, namespace)

    def _add_settings(
        self,
        own: Mapping[str, Sequence[DeclaredSetting]],
        every: Mapping[str, Sequence[DeclaredSetting]],
    ) -> None:
        """Add options for the settings of all agents; only those of the named agents are parsed."""
        group = self.add_argument_group("settings of the agents")
        for name, declared in {**every, **own}.items():
            setting = declared[0]
            read = parser_of(setting) if name in own else str
            if self.takes_lists:
                add_list(group, setting, read)
            else:
                option = self.setting_flags.get(name, flag(name))
                group.add_argument(option, dest=name, type=read, help=_help(setting))
        self.set_defaults(agent_settings=tuple({**every, **own}))


def settings_from(options: argparse.Namespace) -> dict[str, Any]:
    """Return the agents' settings that were given on the command line, by name."""
    given = {name: getattr(options, name) for name in vars(options).get("agent_settings", ())}
    return {name: value for name, value in given.items() if value is not None}


def add_list(
    parser: argparse._ActionsContainer,
    setting: DeclaredSetting,
    read: Callable[[str], Any] | None = None,
) -> None:
    """Add an option for comma-separated values of a setting; `read` parses one value."""
    one = parser_of(setting) if read is None else read
    parser.add_argument(
        flag(setting.name),
        type=lambda text: tuple(one(part) for part in split(text)),
        metavar="LIST",
        help=_help(setting, lists=True),
    )


def split(text: str) -> list[str]:
    """Split a comma-separated list."""
    return [part.strip() for part in text.split(",")]


def _help(setting: DeclaredSetting, lists: bool = False) -> str:
    about, default = setting.about, setting.default
    given = "" if default is REQUIRED or default is None else f" (default {default})"
    if lists and about.examples:
        examples = ",".join(f"{value:g}" for value in about.examples)
        text = f"such as {examples}; each {setting.valid}{given}"
    else:
        label = f"{about.title} {about.symbol}" if about.symbol else about.title
        text = " ".join(filter(None, [f"{label}.", about.help, f"Valid: {setting.valid}{given}"]))
    return text.replace("%", "%%")


def flag(name: str) -> str:
    """Return the option's name of a setting."""
    return f"--{name.replace('_', '-')}"


def parser_of(setting: DeclaredSetting) -> Callable[[str], Value]:
    """Return a parser of a setting's value for argparse, whose error names the valid values."""

    def parse(text: str) -> Value:
        try:
            return setting.parse(text)
        except InvalidInput as error:
            message = f"must be {setting.valid}, not {text!r}"
            raise argparse.ArgumentTypeError(message) from error

    return parse


def add_observation(parser: argparse.ArgumentParser, help_text: str) -> None:
    """Add `--observation`: how an agent observes the robot's state."""
    parser.add_argument(
        "--observation", default="measured", help=f"{' or '.join(OBSERVATIONS)}: {help_text}"
    )


def walk_from(options: argparse.Namespace) -> dict[str, Any]:
    """Convert options of `add_walk_options` to fields of a config."""
    return {
        "gait": read_gait(options.gait),
        "robot": read_robot(options.robot),
        "simulator": options.simulator,
        "divisions": options.divisions,
        "grid_side_m": options.grid_side_m,
        "tolerance": options.tolerance,
        "reward": options.reward,
        "world": world_from(options.world, map(parse_disturbance, options.disturb)),
    }


_TOO_DEEP = "it is nested too deeply"


def read_gait(text: str) -> str | GaitSpec:
    """Parse a gait: a name, or a specification in JSON.

    Raises:
        InvalidInput: if the JSON is not a valid gait.
    """
    if not text.lstrip().startswith("{"):
        return text
    return gait_of_legs(_json("--gait", text))


def read_robot(text: str) -> Robot:
    """Parse a robot: its name, the id of a stored one, the path of a TOML file, or JSON.

    Raises:
        InvalidInput: if it is none of these.
    """
    if text.lstrip().startswith("{"):
        return robot(_json("--robot", text))
    if not text.endswith(".toml"):
        return robot(text) if text in PRESETS else stored_robot(text)
    try:
        return robot(tomllib.loads(Path(text).read_text("utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        reason = _TOO_DEEP if isinstance(error, RecursionError) else error
        raise InvalidInput(f"--robot {text}: cannot be read as TOML: {reason}") from error


def integer(text: str) -> int:
    """Parse an integer for argparse, with a clear error."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number, not {text!r}") from None


def _json(option: str, text: str) -> dict[str, Any]:
    try:
        value = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        reason = _TOO_DEEP if isinstance(error, RecursionError) else error
        raise InvalidInput(f"{option}: not valid JSON: {reason}") from error
    if not isinstance(value, dict):
        raise InvalidInput(f"{option}: must be a JSON object")
    return value
