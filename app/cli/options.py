"""Options that several commands share, and readers of gaits and robots."""

import json
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter, Token

from app.cli.robot_names import stored_robot
from hexapods.domain.disturbance_documents import parse_disturbance
from hexapods.domain.disturbances import KINDS
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import DEFAULT_GAIT, NAMED_GAITS, GaitSpec
from hexapods.domain.gait import read_gait as gait_of_legs
from hexapods.domain.robot import PRESETS, Robot, robot
from hexapods.domain.world import WORLDS, world_from
from hexapods.runs.config import SimulatorName


def whole_number(text: str) -> int:
    """Parse a whole number; a ValueError says that it is none."""
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"must be a whole number, not {text!r}") from None


def _whole_number(_: Any, tokens: Sequence[Token]) -> int:
    return whole_number(tokens[0].value)


WholeNumber = Annotated[int, Parameter(converter=_whole_number, metavar="N")]
AsJson = Annotated[bool, Parameter(name="--json", help="print JSON")]
Data = Annotated[
    str | None,
    Parameter(metavar="FOLDER", help="data folder (default: the user's, or HEXAPODS_DATA)"),
]
RunId = Annotated[
    str, Parameter(name="RUN", help="id of the run, as listed by `hexapods runs list`")
]
Workers = Annotated[
    WholeNumber | None, Parameter(help="worker processes on this machine (default: one per core)")
]
WALKING_PROBLEM = Group("Walking problem", sort_key=(1, 0))
_GAIT_NAMES = ", ".join(NAMED_GAITS).replace(DEFAULT_GAIT, f"{DEFAULT_GAIT} (default)", 1)
Gait = Annotated[
    str,
    Parameter(
        metavar="NAME",
        group=WALKING_PROBLEM,
        completer=lambda _: [*NAMED_GAITS],
        show_default=False,
        help=f"{_GAIT_NAMES}, or JSON with `groups`, `pairs`, or `right_leg`, "
        "`left_leg` and `symmetry`: '{\"groups\": [[1, 3, 5], [2, 4, 6]]}'",
    ),
]


@Parameter(name="*", group=WALKING_PROBLEM)
@dataclass(frozen=True, kw_only=True)
class WalkOptions:
    """Options of the walking problem, beside its gait and its declared settings."""

    robot: Annotated[
        str,
        Parameter(
            metavar="NAME",
            completer=lambda _: [*PRESETS],
            help=f"{', '.join(PRESETS)}, a stored robot's name or id, a TOML file, or JSON "
            "with changes of one of these",
        ),
    ] = "stiff"
    simulator: Annotated[SimulatorName, Parameter(metavar="NAME")] = "mujoco"
    world: Annotated[
        str | None,
        Parameter(metavar="NAME", completer=lambda _: [*WORLDS], help=f"{', '.join(WORLDS)}"),
    ] = None
    disturb: Annotated[
        tuple[str, ...],
        Parameter(
            metavar="KIND:…",
            help=f"{', '.join(KINDS)}; such as limp:legs=1,4:at=25:until=40; repeat for several",
        ),
    ] = ()

    def fields(self) -> dict[str, Any]:
        """Return the fields of a walking problem that the options give.

        Raises:
            HexapodError: if one is not valid.
        """
        return {
            "robot": read_robot(self.robot),
            "simulator": self.simulator,
            "world": world_from(self.world, map(parse_disturbance, self.disturb)),
        }


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class KeepOptions:
    """Whether a run is kept in the data folder, and as what."""

    keep: Annotated[bool, Parameter(help="keep it in the data folder, for the page to show")] = (
        False
    )
    name: Annotated[str | None, Parameter(metavar="TEXT", help="name of the kept run")] = None

    def check(self) -> None:
        """Raise InvalidInput if a run has a name that is not kept."""
        if self.name is not None and not self.keep:
            raise InvalidInput("--name is of a run that is kept; add --keep, or leave --name out")


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


def _json(option: str, text: str) -> dict[str, Any]:
    try:
        value = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        reason = _TOO_DEEP if isinstance(error, RecursionError) else error
        raise InvalidInput(f"{option}: not valid JSON: {reason}") from error
    if not isinstance(value, dict):
        raise InvalidInput(f"{option}: must be a JSON object")
    return value
