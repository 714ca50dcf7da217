"""Arguments of the public functions: the forms of an agent, a robot or a world that they accept."""

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn, TypedDict, TypeVar

import numpy as np

from hexapods.agents import registry
from hexapods.agents.registry import AgentClass
from hexapods.domain.creatures import own_gait
from hexapods.domain.disturbance_documents import as_text, disturbance_from, parse_disturbance
from hexapods.domain.disturbances import Disturbance
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import DEFAULT_GAIT, GaitSpec, read_gait
from hexapods.domain.grid import FootGrid
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.records import check_kept
from hexapods.domain.robot import PRESETS, Robot, document_of, read_document, robot
from hexapods.domain.robot_library import RobotLibrary
from hexapods.domain.simulator import RewardKind
from hexapods.domain.text import MAX_NAME, visible
from hexapods.domain.world import WORLDS, World, parse_world
from hexapods.files import path_of
from hexapods.imports.child import read_robot_file
from hexapods.imports.documents.folder import read_robot_path
from hexapods.runs.config import SimulatorName, WalkingProblem
from hexapods.runs.recommendation import recommend

C = TypeVar("C", bound=WalkingProblem)
GaitLike = str | Mapping[str, Any] | GaitSpec
"""A gait: its name, itself, or a mapping with `right_leg`, `left_leg`, and `symmetry`, `pairs` or
`groups`."""
RobotLike = str | Mapping[str, Any] | Robot
"""A robot: a preset's name, a mapping with what differs from a preset or from a stored robot, by
its `id`, or itself."""
WorldLike = str | Iterable[Disturbance | Mapping[str, Any] | str] | World
"""A world: its name, disturbances (each a text, a mapping or itself), or itself."""


class Walk(TypedDict, total=False):
    """Keyword arguments that describe a walking problem.

    Limits, and the defaults of what is left out, are those of `WalkingProblem`.
    """

    gait: GaitLike
    """A name, such as `left-right-origin` (default), or a `Gait` or its fields."""
    robot: RobotLike
    """A preset's name, `stiff` (default), `compliant` or `slippery`, or a `Robot`, or what differs
    from a preset."""
    simulator: SimulatorName
    """`mujoco` or `kinematic`, which is ideal: without slip."""
    divisions: int
    """Points along each side of the foot grid."""
    grid_side_m: float
    """Side of the foot grid [m]."""
    world: WorldLike
    """A name, such as `ice`, a list of disturbances, or a `World`; by default flat ground."""
    tolerance: float
    """How far the robot that the seed draws differs from its design, as a share."""
    reward: RewardKind
    """Displacement that a step's reward is: `forward`, along the robot's own heading, or `track`,
    along the track."""


WALK = tuple(Walk.__annotations__)
"""Names of the arguments that describe a walking problem."""


class _NotGiven:
    """Default of an argument whose value follows from others, such as from a table."""

    def __repr__(self) -> str:
        return "<default>"


NOT_GIVEN: Any = _NotGiven()


def given_arguments(
    arguments: Mapping[str, Any], names: Iterable[str], rest: str
) -> dict[str, Any]:
    """Return the arguments that a caller has given, by name, without the defaults `NOT_GIVEN`.

    Args:
        arguments: all arguments of a function, as `locals()` at its beginning.
        names: names of the arguments that count.
        rest: name of its `**` argument, whose content is added.
    """
    arguments_given = {name: arguments[name] for name in names if arguments[name] is not NOT_GIVEN}
    return {**arguments_given, **arguments[rest]}


def agent_name(agent: str | AgentClass) -> str:
    """Return the name of an agent: registered, or `my.module:Agent`.

    Args:
        agent: its name, or its class.

    Raises:
        UnknownName: if there is no agent of this name.
        InvalidInput: if the class is not that of an agent, or not found in its module.
    """
    if isinstance(agent, str):
        registry.find(agent)
        return agent
    if not isinstance(agent, type):
        raise InvalidInput(f"an agent is given by its name or its class, not as {agent!r}")
    names = (name for name, its_class in registry.registered().items() if its_class is agent)
    name = next(names, f"{agent.__module__}:{agent.__qualname__}")
    if "." in agent.__qualname__:
        raise InvalidInput(
            f"{agent.__qualname__} is defined inside of something else, where other processes do "
            "not find it; define the agent's class at the top level of a module"
        )
    if registry.find(name) is not agent:
        raise InvalidInput(f"{agent!r} is not what {name} imports; define it in a module")
    return name


def read_walk(values: Mapping[str, Any], like: WalkingProblem | None = None) -> dict[str, Any]:
    """Return the fields of a walking problem.

    Args:
        values: fields that a person has given, as `hexapods.train` describes.
        like: source of the other fields, except for the world and the tolerance; None for the
            defaults.

    Raises:
        UnknownName, InvalidInput: if a value is not valid.
    """
    walk: dict[str, Any] = {"gait": DEFAULT_GAIT}
    if like is not None:
        inherited = [name for name in WALK if name not in ("world", "tolerance")]
        walk = {name: getattr(like, name) for name in inherited}
    walk |= values
    walk["gait"] = read_gait(walk["gait"])
    if "robot" in walk:
        walk["robot"] = read_robot(walk["robot"])
    if "world" in walk:
        walk["world"] = read_world(walk["world"])
    return walk


def read_robot(value: RobotLike) -> Robot:
    """Return a robot from an argument, with a name that can be shown and stored.

    Raises:
        UnknownName, InvalidInput: if it is none.
    """
    if not isinstance(value, str | Mapping | Robot):
        _refuse("robot", f"{' or '.join(PRESETS)}, a mapping or a Robot", value)
    parsed = robot(value)
    # No file, database or terminal takes each character that a text of Python may have.
    named = replace(parsed, name=visible(parsed.name)[:MAX_NAME])
    is_unstored = isinstance(named, ModelRobot) and named.id is None
    return read_document(document_of(named), named.name) if is_unstored else named


def check_savable(config: C) -> C:
    """Return a config that can be saved and read again: to be called before what it decides.

    A robot of a class of one's own has no form in a file: its results are in memory alone.

    Raises:
        InvalidInput: if it cannot be saved.
    """
    return (
        check_kept(config, RobotLibrary()) if type(config.robot) in (Robot, ModelRobot) else config
    )


def load_robot(file: str | os.PathLike[str], name: str | None = None) -> Robot:
    """Return the robot of a file: MJCF, URDF or xacro, alone, in a folder or a zip; or a document.

    A document (`.json`) is what `hexapods robots export` writes. From then on `{"id": …}` is this
    robot too, also in tables and races that were made with it.

    Args:
        file: path of the file or folder.
        name: the robot's name, of at most 100 characters; by default that of the file, as much of
            it as a name may have.

    Raises:
        InvalidInput: if the file cannot be read, or its robot or its name is not valid.
        DamagedFile: if it is no robot.
        NotRead: if no process can be started to read it.

    Examples:
        >>> import hexapods as hx
        >>> dog = hx.load_robot("dog.json", name="Rex")
        >>> dog.name, len(dog.legs)
        ('Rex', 4)
        >>> hx.train(robot=dog, gait="trot", steps=20, simulator="kinematic").config.robot.name
        'Rex'
    """
    if name is not None and len(name) > MAX_NAME:
        raise InvalidInput(f"a robot's name is a text of at most {MAX_NAME} characters")
    path = path_of(file, "a robot's file")
    data, file_name = read_robot_path(path)
    stem = Path(file_name).stem
    if path.suffix.lower() != ".json":
        data = document_of(read_robot_file(data, file_name).robot(stem))
    return read_document(data, name or stem[:MAX_NAME])


def recommended_agent(
    robot: RobotLike = "stiff",
    gait: GaitLike | None = None,
    *,
    divisions: int = FootGrid.divisions,
) -> str:
    """Return the name of the learner to begin with for a robot in a gait.

    It follows from whether the robot stands while each group of legs swings (its support margin).

    Args:
        robot: as `train` takes it.
        gait: as `train` takes it; by default one that suits the robot.
        divisions: points along each side of the foot grid.

    Raises:
        UnknownName, InvalidInput: if an argument is not valid.

    Examples:
        >>> import hexapods as hx
        >>> hx.recommended_agent("dog")  # stands while two of its legs swing
        'linear-model'
        >>> hx.recommended_agent("dog", "bound")  # tips
        'multilevel-model'
    """
    parsed = read_robot(robot)
    gait = own_gait(parsed) if gait is None else read_gait(gait)
    walk = WalkingProblem(gait=gait, robot=parsed, divisions=divisions)
    return recommend(parsed, walk.resolved_gait, len(walk.grid)).agent


def _refuse(name: str, valid: str, value: object) -> NoReturn:
    raise InvalidInput(f"{name} is {valid}, not {value!r}")


def plain(value: Any) -> Any:
    """Convert the NumPy numbers and arrays in a value, such as those of `arange`, to Python's."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items()}
    if type(value) in (list, tuple):
        return type(value)(map(plain, value))
    return value


def values_of(value: object) -> tuple[Any, ...]:
    """Return the values of an argument of which several may be given, or one as it is."""
    values = plain(value)
    if isinstance(values, Sequence) and not isinstance(values, str):
        return tuple(map(plain, values))
    return (values,)


def check_callable(name: str, value: object) -> None:
    """Check an argument that is called back, if it is given.

    Raises:
        InvalidInput: if it is no function.
    """
    if value is not None and not callable(value):
        raise InvalidInput(f"{name} is a function that is called, not {value!r}")


def read_world(value: WorldLike) -> World:
    """Return a world: of a name such as `ice`, of a text or mappings, or the world itself.

    Raises:
        UnknownName, InvalidInput: if a disturbance is not valid, or two contradict each other.
    """
    if isinstance(value, World):
        return value
    if isinstance(value, Mapping) or not isinstance(value, Iterable):
        _refuse("world", f"one of {', '.join(WORLDS)}, a list of disturbances or a World", value)
    return (
        parse_world(value) if isinstance(value, str) else World(tuple(map(read_disturbance, value)))
    )


def read_disturbance(value: object) -> Disturbance:
    """Return a disturbance: of a text such as `limp:legs=1,4` or of a mapping, or itself.

    Raises:
        UnknownName, InvalidInput: if it is none.
    """
    if isinstance(value, Disturbance):
        return value
    if isinstance(value, str):
        if value in WORLDS:
            made_of = ", ".join(
                f'"{as_text(disturbance)}"' for disturbance in WORLDS[value].world.disturbances
            )
            raise InvalidInput(
                f'{value} is a world and no disturbance: write world="{value}", or [{made_of}]'
            )
        return parse_disturbance(value)
    if not isinstance(value, Mapping):
        raise InvalidInput(
            f'a disturbance is such as "limp:legs=1,4" or {{"kind": "limp", "legs": [1, 4]}}, '
            f"not {value!r}"
        )
    return disturbance_from(value)


def check_names(function: str, names: Iterable[str], valid: Iterable[str]) -> None:
    """Check the names of keyword arguments.

    Raises:
        UnknownName: for the first that is not valid; it names those that are.
    """
    valid_names = list(valid)
    for name in names:
        if name not in valid_names:
            raise UnknownName(f"argument of {function}", name, valid_names)
