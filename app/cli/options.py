"""Options that several commands share, and how their values are read."""

import argparse
import json
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from app.domain.errors import InvalidInput
from app.domain.gait import NAMED_GAITS, GaitSpec
from app.domain.observation import OBSERVATIONS
from app.domain.robot import PRESETS, Robot, robot
from app.domain.settings import DeclaredSetting, Value, declared_fields
from app.runs.config import SIMULATORS, WalkingProblem, gait_from_json

_GAIT_FIELDS = ("right_leg", "left_leg", "symmetry", "pairs")


def add_walk_options(parser: argparse.ArgumentParser) -> None:
    """The walking problem: gait, robot, simulator, foot grid."""
    parser.add_argument(
        "--gait",
        required=True,
        help=f"{', '.join(NAMED_GAITS)}, or JSON such as "
        '\'{"right_leg": 1, "left_leg": 2, "symmetry": "origin"}\' (or "pairs": [[1, 4], …])',
    )
    parser.add_argument(
        "--robot",
        default="stiff",
        help=f"{', '.join(PRESETS)}, a TOML file, or JSON of what differs from a preset",
    )
    parser.add_argument("--simulator", default="mujoco", help=" or ".join(SIMULATORS))
    add_settings(parser, declared_fields(WalkingProblem))


def add_settings(
    parser: argparse.ArgumentParser,
    settings: Mapping[str, DeclaredSetting],
    names: Iterable[str] | None = None,
) -> None:
    """Add an option for each declared setting, or for those that are named."""
    for name in settings if names is None else names:
        setting = settings[name]
        about = setting.about
        label = f"{about.title} {about.symbol}" if about.symbol else about.title
        parser.add_argument(
            flag(name),
            type=parser_of(setting),
            default=setting.default,
            help=f"{label}. {about.help} Valid: {setting.valid} (default {setting.default})",
        )


def flag(name: str) -> str:
    """The option of a setting."""
    return f"--{name.replace('_', '-')}"


def parser_of(setting: DeclaredSetting) -> Callable[[str], Value]:
    """Parses a setting's value for argparse, which reports what is valid."""

    def parse(text: str) -> Value:
        try:
            return setting.parse(text)
        except InvalidInput as error:
            message = f"must be {setting.valid}, not {text!r}"
            raise argparse.ArgumentTypeError(message) from error

    return parse


def add_observation(parser: argparse.ArgumentParser, help_text: str) -> None:
    """How an agent reads its state."""
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
    }


def read_gait(text: str) -> str | GaitSpec:
    """A gait by name, or a specification in JSON.

    Raises:
        InvalidInput: if the JSON is no gait.
    """
    if not text.lstrip().startswith("{"):
        return text
    given = _json("--gait", text)
    unknown = set(given) - set(_GAIT_FIELDS)
    if unknown or not {"right_leg", "left_leg"} <= set(given):
        raise InvalidInput(
            "--gait needs right_leg and left_leg, and either symmetry or pairs; "
            f"not {', '.join(sorted(given)) or 'nothing'}"
        )
    try:
        return gait_from_json(given)
    except (TypeError, ValueError) as error:
        raise InvalidInput("--gait: pairs must look like [[1, 4], [2, 5], [3, 6]]") from error


def read_robot(text: str) -> Robot:
    """A robot by its preset's name, from a TOML file, or in JSON.

    Raises:
        InvalidInput: if it is none of them.
    """
    if text.lstrip().startswith("{"):
        return robot(_json("--robot", text))
    if not text.endswith(".toml"):
        return robot(text)
    try:
        return robot(tomllib.loads(Path(text).read_text("utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InvalidInput(f"--robot {text}: cannot be read as TOML: {error}") from error


def whole(text: str) -> int:
    """A whole number, or a clear refusal."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number, not {text!r}") from None


def _json(option: str, text: str) -> dict[str, Any]:
    try:
        value = json.loads(text)
    except json.JSONDecodeError as error:
        raise InvalidInput(f"{option}: not valid JSON: {error}") from error
    if not isinstance(value, dict):
        raise InvalidInput(f"{option}: must be a JSON object")
    return value
