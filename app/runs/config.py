"""Configs of trainings and races: complete, checked, and immutable.

Fields that a person may choose are declared as settings (`app.domain.settings`).
"""

import logging
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Annotated, Any, Literal, get_args

from annotated_types import Ge, Le

from app.agents import registry
from app.domain.errors import HexapodError, InvalidInput, UnknownName
from app.domain.gait import Gait, GaitSpec, resolve
from app.domain.grid import MAX_DIVISIONS, MAX_SIDE_M, MIN_DIVISIONS, MIN_SIDE_M, FootGrid
from app.domain.observation import Observation, check_observation
from app.domain.robot import Robot, as_mapping, robot
from app.domain.settings import (
    DeclaredSetting,
    Setting,
    SettingValues,
    Value,
    complete,
    declared_fields,
)

_log = logging.getLogger(__name__)
SimulatorName = Literal["mujoco", "kinematic"]
SIMULATORS: tuple[SimulatorName, ...] = get_args(SimulatorName)
MAX_STEPS = 10_000_000
MAX_LANES = 6
RACE_STEPS = 50
"""Steps of a race, and of an evaluation (paper §5)."""
MAX_RACE_STEPS = 300_000
"""Of all lanes of a race together: every step is recorded, in about 3 kB."""

Divisions = Annotated[
    int,
    Ge(MIN_DIVISIONS),
    Le(MAX_DIVISIONS),
    Setting(
        title="Foot grid, divisions",
        phrase="{}\u00a0divisions",
        help="Points along each side of the foot grid: more choices, more to learn.",
        examples=(2, 3),
    ),
]
GridSide = Annotated[
    float,
    Ge(MIN_SIDE_M),
    Le(MAX_SIDE_M),
    Setting(
        title="Foot grid, side",
        phrase="grid\u00a0{}\u00a0m",
        unit="m",
        help="Side of the square in which each foot may be put; every leg must reach all of it.",
        examples=(0.03, 0.04),
    ),
]
Seed = Annotated[
    int,
    Ge(0),
    Setting(
        title="Seed",
        help="Everything that is random follows from this number: the same seed, the same run.",
    ),
]
_StepCount = Annotated[int, Ge(1), Le(MAX_STEPS)]
PracticeSteps = Annotated[
    _StepCount,
    Setting(
        title="Practice",
        phrase="{}\u00a0steps",
        unit="steps",
        help="How many steps it practises; the paper uses 500 and 1,000.",
        examples=(500, 1000),
    ),
]
StepsPerEpisode = Annotated[
    _StepCount,
    Setting(
        title="Steps per episode",
        phrase="{}\u00a0an\u00a0episode",
        help="The share of random steps falls after every so many steps.",
        examples=(25, 50),
    ),
]
EvaluateEvery = Annotated[
    int,
    Ge(0),
    Le(MAX_STEPS),
    Setting(
        title="Evaluate every",
        unit="steps",
        help="After every so many steps it shows what it can; 0 is never.",
    ),
]
PaceFactor = Annotated[float, Ge(0.01), Le(1000)]
Pace = Annotated[
    Literal["max"] | PaceFactor,
    Setting(
        title="Pace of practice",
        unit="times real time",
        help="How fast it practises: max, or a number of times real time.",
        live=True,
    ),
]
RaceSteps = Annotated[
    int,
    Ge(1),
    Le(MAX_RACE_STEPS),
    Setting(title="Steps of the race", help="How many steps each robot has in the race."),
]


@dataclass(frozen=True, kw_only=True)
class WalkingProblem:
    """Which robot walks how, on which foot grid, in which simulator."""

    gait: str | GaitSpec
    robot: Robot = field(default_factory=Robot)
    simulator: SimulatorName = "mujoco"
    divisions: Divisions = FootGrid.divisions
    grid_side_m: GridSide = FootGrid.side_m

    def __post_init__(self) -> None:
        if self.simulator not in SIMULATORS:
            raise UnknownName("simulator", self.simulator, SIMULATORS)
        own = declared_fields(type(self))  # type: ignore[arg-type]  # of a class, not of an instance
        for setting in own.values():
            setting.check(getattr(self, setting.name))
        resolve(self.gait, self.robot.azimuths_deg)
        FootGrid(self.grid_side_m, self.divisions)

    @property
    def grid(self) -> FootGrid:
        """The foot grid that was asked for."""
        return FootGrid(self.grid_side_m, self.divisions)

    @property
    def resolved_gait(self) -> Gait:
        """The gait as this robot walks it."""
        return resolve(self.gait, self.robot.azimuths_deg)


@dataclass(frozen=True, kw_only=True)
class TrainingConfig(WalkingProblem):
    """A training. The defaults are the paper's; `training_config` makes a complete one.

    Attributes:
        steps: number of learning steps.
        seed: of every generator of the run.
        observation: how the agent reads the state.
        settings: of the agent by name; it has its own default for one that is left out.
        steps_per_episode: exploration stays the same so long.
        evaluate_every: steps between two evaluations; 0 is never.
        pace: `max`, or how many times real time.
        agent: a registered name or `my.module:Agent`.
    """

    steps: PracticeSteps = 500
    seed: Seed = 0
    observation: Observation = "measured"
    settings: SettingValues[Value] = field(default_factory=SettingValues)
    steps_per_episode: StepsPerEpisode = 50
    evaluate_every: EvaluateEvery = 50
    pace: Pace = "max"
    agent: str = "q-learning"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_observation(self.observation)


_OWN_FIELDS = frozenset(one.name for one in fields(TrainingConfig))


_RESERVED = """
a agents b beats_greedy beats_greedy_total blocks changes continue_from distances_m elapsed_s
experiment failed finished from gaits greedy_m h half_side_m help high high_m iqm_m json key lanes
low low_m mean_m n name observations out points_m practice probability published reaches_greedy
relative relative_finished retry robots role run scheduler seeds start step table tls_ca tls_cert
tls_key total training training_id verdict walk walkers workers
"""
RESERVED = frozenset(_RESERVED.split())
"""Names that mean something else beside the settings in requests, answers, files or commands."""


def agent_settings(agent: str) -> Mapping[str, DeclaredSetting]:
    """The settings that an agent's constructor declares, without fields of a training.

    Raises:
        UnknownName, InvalidInput: if there is no such agent, or a setting's name is reserved.
    """
    found = registry.settings_of(registry.find(agent))
    for name in found:
        if name in RESERVED or name.startswith(("_", "model_")):
            raise InvalidInput(
                f"agent {agent} declares a setting named {name!r}, which means something else in "
                "requests and files; rename the parameter"
            )
    return {name: one for name, one in found.items() if name not in _OWN_FIELDS}


def usable_agents() -> tuple[str, ...]:
    """The registered agents; one whose settings cannot be offered is left out, and logged."""
    usable = []
    for agent in registry.registered():
        try:
            agent_settings(agent), changeable_settings(agent)
        except (HexapodError, TypeError, ValueError) as error:
            _log.warning("agent %s is left out: %s", agent, error)
        else:
            usable.append(agent)
    return tuple(usable)


def changeable_settings(agent: str) -> Mapping[str, DeclaredSetting]:
    """The settings of a training that may change while it runs.

    Raises:
        UnknownName, InvalidInput: if there is no such agent.
    """
    own = {name: one for name, one in declared_fields(TrainingConfig).items() if one.about.live}
    return own | dict(registry.live_settings_of(registry.find(agent)))


def training_config(agent: str = TrainingConfig.agent, **given: Any) -> TrainingConfig:
    """A training with the settings of its agent checked and complete.

    Args:
        agent: a registered name or `my.module:Agent`.
        given: fields of `TrainingConfig`, and settings of the agent by their names.

    Raises:
        UnknownName, InvalidInput: for an agent, a setting or a value that cannot be.
    """
    own = {name: value for name, value in given.items() if name in _OWN_FIELDS}
    settings = {name: value for name, value in given.items() if name not in _OWN_FIELDS}
    config = TrainingConfig(agent=agent, **own)
    return replace(config, settings=complete(agent_settings(agent), settings, agent))


@dataclass(frozen=True, kw_only=True)
class LaneConfig:
    """One lane of a race.

    Attributes:
        agent: a registered name or `my.module:Agent`.
        observation: how it reads the state: its table's reading, for who has learned.
    """

    agent: str
    observation: Observation = "measured"

    def __post_init__(self) -> None:
        check_observation(self.observation)


@dataclass(frozen=True, kw_only=True)
class RaceConfig(WalkingProblem):
    """A race of one to six lanes, 50 steps each by default."""

    lanes: tuple[LaneConfig, ...]
    steps: RaceSteps = RACE_STEPS
    seed: Seed = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1 <= len(self.lanes) <= MAX_LANES:
            raise InvalidInput(f"a race has 1 to {MAX_LANES} lanes, not {len(self.lanes)}")
        if self.steps * len(self.lanes) > MAX_RACE_STEPS:
            raise InvalidInput(
                f"a race records every step, so steps times lanes must be at most "
                f"{MAX_RACE_STEPS:,}, not {self.steps * len(self.lanes):,}"
            )


def as_json(config: WalkingProblem) -> dict[str, Any]:
    """A config in plain types, as the API shows it and files keep it."""
    shown: dict[str, Any] = {}
    for one in fields(config):
        value = getattr(config, one.name)
        shown |= value if isinstance(value, SettingValues) else {one.name: value}
    shown["robot"] = as_mapping(config.robot)
    if isinstance(config.gait, GaitSpec):
        shown["gait"] = {k: v for k, v in asdict(config.gait).items() if v is not None}
    if isinstance(config, RaceConfig):
        shown["lanes"] = [asdict(lane) for lane in config.lanes]
    return shown


def config_from_json(shown: Mapping[str, Any]) -> TrainingConfig | RaceConfig:
    """The config that `as_json` wrote; only a race has lanes.

    Fields that no training has are settings of its agent, which is not looked for.

    Raises:
        InvalidInput: if a value cannot be.
        KeyError, TypeError, ValueError: if `as_json` did not write it.
    """
    values = {**shown, "gait": gait_from_json(shown["gait"]), "robot": robot(shown["robot"])}
    if "lanes" in values:
        lanes = tuple(LaneConfig(**lane) for lane in values.pop("lanes"))
        return RaceConfig(**values, lanes=lanes)
    settings = {name: values.pop(name) for name in list(values) if name not in _OWN_FIELDS}
    return TrainingConfig(**values, settings=SettingValues(settings))


def gait_from_json(value: str | Mapping[str, Any]) -> str | GaitSpec:
    """The gait that `as_json` wrote."""
    if isinstance(value, str):
        return value
    parts = dict(value)
    if "pairs" in parts:
        parts["pairs"] = tuple((int(a), int(b)) for a, b in parts["pairs"])
    return GaitSpec(**parts)


def check_whole(name: str, value: int, low: int, high: int | None) -> None:
    """Raise `InvalidInput` unless value is a whole number in these limits."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise InvalidInput(f"{name} must be a whole number, not {value!r}")
    if value < low or (high is not None and value > high):
        limits = f"at least {low}" if high is None else f"from {low} to {high:,}"
        raise InvalidInput(f"{name} must be {limits}, not {value:,}")
