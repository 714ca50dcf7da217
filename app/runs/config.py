"""Configs of trainings and races: complete, validated and immutable.

Fields that a user may choose are declared as settings (`app.domain.settings`).
"""

import logging
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Annotated, Any, Literal, NamedTuple, get_args

from annotated_types import Ge, Le

from app.agents import registry
from app.agents.protocol import Problem
from app.domain import disturbances
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
from app.domain.tolerance import MAX_TOLERANCE, build_tolerance
from app.domain.world import UNDISTURBED, World, world
from app.runs.seeding import BUILDING, generator

_log = logging.getLogger(__name__)
SimulatorName = Literal["mujoco", "kinematic"]
SIMULATORS: tuple[SimulatorName, ...] = get_args(SimulatorName)
MAX_STEPS = disturbances.MAX_STEP
MAX_LANES = 6
MAX_ID = 64
"""Maximum length of a run's id."""
RACE_STEPS = 50
"""Default number of steps of a race, and number of steps of an evaluation (paper §5)."""
MAX_RACE_STEPS = 300_000
"""Maximum of steps, summed over a race's lanes: every step is recorded, in about 3 kB."""

Divisions = Annotated[
    int,
    Ge(MIN_DIVISIONS),
    Le(MAX_DIVISIONS),
    Setting(
        title="Grid divisions",
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
        title="Grid side",
        phrase="grid\u00a0{}\u00a0m",
        unit="m",
        help="Side of the square in which each foot may be put; every leg must reach all of it.",
        examples=(0.03, 0.04),
    ),
]
Tolerance = Annotated[
    float,
    Ge(0.0),
    Le(MAX_TOLERANCE),
    Setting(
        title="Build tolerance",
        phrase="tolerance\u00a0{}",
        help="How far the robot that the seed draws differs from its design, as a share.",
        examples=(0.03,),
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
        help="How many steps it practises; the paper uses 500 and 1000.",
        examples=(500, 1000),
    ),
]
StepsPerEpisode = Annotated[
    _StepCount,
    Setting(
        title="Steps per episode",
        phrase="{}\u00a0steps\u00a0per\u00a0episode",
        help="The share of random steps falls after every so many steps.",
        examples=(25, 50),
    ),
]
EvaluateEvery = Annotated[
    int,
    Ge(0),
    Le(MAX_STEPS),
    Setting(
        title="Test every",
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
PlansWith = Annotated[
    Literal["world", "nominal"],
    Setting(
        title="Plans with",
        help="The world as it is, or the robot and flat ground as if nothing had happened.",
    ),
]
KeepLearning = Annotated[
    bool,
    Setting(
        title="Keeps learning",
        help="Whether it learns from each step of the race too; without practice it begins there.",
    ),
]


@dataclass(frozen=True, kw_only=True)
class WalkingProblem:
    """Walking problem: a robot, its gait and foot grid, and the simulator.

    Attributes:
        gait: a named gait, or a gait given by its leg pairs.
        robot: geometry and actuators.
        simulator: `mujoco` (physics) or `kinematic` (ideal, no slip).
        divisions: points along each side of the foot grid.
        grid_side_m: side of the foot grid [m].
        world: what happens to the robot and the ground, by step.
        tolerance: how far the robot that the run's seed draws differs from `robot`, as a share.

    Raises:
        UnknownName: if the gait or the simulator is unknown.
        InvalidInput: if a value is out of its limits, or gait or world do not fit the robot.
    """

    gait: str | GaitSpec
    robot: Robot = field(default_factory=Robot)
    simulator: SimulatorName = "mujoco"
    divisions: Divisions = FootGrid.divisions
    grid_side_m: GridSide = FootGrid.side_m
    world: World = UNDISTURBED
    tolerance: Tolerance = 0.0

    def __post_init__(self) -> None:
        if self.simulator not in SIMULATORS:
            raise UnknownName("simulator", self.simulator, SIMULATORS)
        own = declared_fields(type(self))  # type: ignore[arg-type]  # of a class, not of an instance
        for setting in own.values():
            setting.check(getattr(self, setting.name))
        resolve(self.gait, self.robot.azimuths_deg)
        FootGrid(self.grid_side_m, self.divisions)
        if self.tolerance and self.simulator == "kinematic":
            raise InvalidInput(
                "the kinematic simulator knows no build tolerance; choose the simulator mujoco, or "
                "tolerance 0"
            )
        self.world.check(self.robot, self.simulator, getattr(self, "steps", None))

    @property
    def grid(self) -> FootGrid:
        """The foot grid of this config."""
        return FootGrid(self.grid_side_m, self.divisions)

    @property
    def resolved_gait(self) -> Gait:
        """The gait with its leg pairs for this robot."""
        return resolve(self.gait, self.robot.azimuths_deg)

    @property
    def built_robot(self) -> Robot:
        """The robot as it was built: drawn by the run's seed, the same for all who race with it.

        A walking problem without a seed is that of the robot as designed.
        """
        seed: int | None = getattr(self, "seed", None)
        if seed is None or not self.tolerance:
            return self.robot
        return build_tolerance(self.robot, self.tolerance, generator(seed, BUILDING))


def problem_of(walk: WalkingProblem) -> Problem:
    """Return the size and geometry of a walking problem, as agents know it."""
    return Problem(walk.resolved_gait.pairs, walk.grid.cells)


@dataclass(frozen=True, kw_only=True)
class TrainingConfig(WalkingProblem):
    """Config of a training. The defaults are the paper's; `training_config` adds agent settings.

    Attributes:
        steps: number of learning steps.
        seed: seed of all random generators of the run.
        observation: observation mode, `measured`, `commanded` or `planned`.
        settings: the agent's settings by name; the agent's default applies to a missing one.
        steps_per_episode: number of steps for which ε is constant.
        evaluate_every: steps between two evaluations; 0 for none.
        pace: `max`, or a multiple of real time.
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


_TRAINING_FIELDS = frozenset(one.name for one in fields(TrainingConfig))


_RESERVED = """
a agents b beats_greedy beats_greedy_total blocks branch_from changes continue_from distances_m
disturb disturbance disturbances elapsed_s experiment failed finished from gaits greedy_m h
half_side_m help high high_m iqm_m json keep_learning key lanes low low_m mean_m n name
observations out plans_with points_m practice probability published reaches_greedy relative
relative_finished retry robots role run scheduler seeds start step table tls_ca tls_cert tls_key
total training training_id verdict walk walkers workers worlds
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
    return {name: one for name, one in found.items() if name not in _TRAINING_FIELDS}


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
    """Return the settings of a training that may change while it runs.

    Raises:
        UnknownName, InvalidInput: if there is no such agent.
    """
    own = {name: one for name, one in declared_fields(TrainingConfig).items() if one.about.live}
    return own | dict(registry.live_settings_of(registry.find(agent)))


def training_config(agent: str = TrainingConfig.agent, **given: Any) -> TrainingConfig:
    """Create the config of a training, with its agent's settings validated and completed.

    Args:
        agent: a registered name or `my.module:Agent`.
        given: fields of `TrainingConfig`, and the agent's settings by name.

    Raises:
        UnknownName, InvalidInput: if the agent, a setting or a value is invalid.
    """
    own = {name: value for name, value in given.items() if name in _TRAINING_FIELDS}
    settings = {name: value for name, value in given.items() if name not in _TRAINING_FIELDS}
    config = TrainingConfig(agent=agent, **own)
    return replace(config, settings=complete(agent_settings(agent), settings, agent))


@dataclass(frozen=True, kw_only=True)
class LaneConfig:
    """Config of one lane of a race. `lane_config` adds the agent's defaults.

    Attributes:
        agent: a registered name or `my.module:Agent`.
        observation: observation mode; for a trained agent that of its table.
        keep_learning: whether the agent learns from each step of the race.
        plans_with: of a searcher, what it knows: `world` is the world as it is in each step,
            `nominal` the robot and flat ground as if nothing had happened; None is the world as it
            was at the start, since nobody tells a robot what happens later.
        settings: the agent's settings by name; none for a trained agent, which has those of its
            training.
    """

    agent: str
    observation: Observation = "measured"
    keep_learning: KeepLearning = False
    plans_with: PlansWith | None = None
    settings: SettingValues[Value] = field(default_factory=SettingValues)

    def __post_init__(self) -> None:
        check_observation(self.observation)
        for setting in declared_fields(LaneConfig).values():
            setting.check(getattr(self, setting.name))


_LANE_FIELDS = frozenset(one.name for one in fields(LaneConfig)) - {"settings"}


def lane_config(
    agent: str,
    *,
    observation: Observation = LaneConfig.observation,
    keep_learning: bool | None = None,
    plans_with: str | None = None,
    has_training: bool = False,
    **settings: Any,
) -> LaneConfig:
    """Create the config of a lane, with its agent's settings validated and completed.

    Args:
        agent: a registered name or `my.module:Agent`.
        observation: observation mode.
        keep_learning: whether the agent learns in the race; None for the agent's default.
        plans_with: what a searcher knows; see `LaneConfig`.
        has_training: whether the agent races with what it learned in a training.
        settings: the agent's settings by name.

    Raises:
        UnknownName, InvalidInput: if the agent, a setting or a value is invalid.
    """
    if keep_learning is None:
        keep_learning = registry.keeps_learning(agent)
    lane = LaneConfig(
        agent=agent,
        observation=observation,
        keep_learning=keep_learning,
        plans_with=plans_with,  # type: ignore[arg-type]  # it is checked
        settings=SettingValues(settings),
    )
    check_lane(lane, has_training)
    if has_training:
        return lane
    return replace(lane, settings=complete(agent_settings(agent), settings, agent))


def check_lane(lane: LaneConfig, has_training: bool) -> None:
    """Check a lane against its agent, which is imported.

    Raises:
        UnknownName, InvalidInput: if the agent does not exist, does not learn but should, or does
            not have these settings.
    """
    if lane.keep_learning and not registry.learns(lane.agent):
        raise InvalidInput(
            f"{lane.agent} does not learn, so it cannot keep learning; leave out keep_learning"
        )
    if lane.plans_with is not None and not registry.searches(lane.agent):
        raise InvalidInput(f"{lane.agent} plans with no simulator; leave out plans_with")
    if has_training and lane.settings:
        raise InvalidInput(
            "a lane with training takes its settings from there; leave out "
            + ", ".join(lane.settings)
        )
    if not has_training:
        complete(agent_settings(lane.agent), lane.settings, lane.agent)


class Branch(NamedTuple):
    """The moment of another race at which a race branches off; until then both are the same."""

    race_id: str
    step: int
    """Number of steps that they share."""


@dataclass(frozen=True, kw_only=True)
class RaceConfig(WalkingProblem):
    """Config of a race of one to six lanes, 50 steps each by default.

    Attributes:
        lanes: in order.
        steps: of each lane.
        seed: seed of all random generators of the run.
        branch_from: the race whose first steps this one repeats, if any.

    Raises:
        InvalidInput: if there are no or too many lanes, or too many steps in all.
    """

    lanes: tuple[LaneConfig, ...]
    steps: RaceSteps = RACE_STEPS
    seed: Seed = 0
    branch_from: Branch | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.branch_from is not None:
            race_id: Any = self.branch_from.race_id  # it may be from a file
            step = self.branch_from.step
            if not isinstance(race_id, str) or not race_id.isalnum() or len(race_id) > MAX_ID:
                raise InvalidInput(f"branch_from.race_id must be the id of a race, not {race_id!r}")
            check_whole("branch_from.step", step, 0, self.steps - 1)
        if not 1 <= len(self.lanes) <= MAX_LANES:
            raise InvalidInput(f"a race has 1 to {MAX_LANES} lanes, not {len(self.lanes)}")
        if self.steps * len(self.lanes) > MAX_RACE_STEPS:
            raise InvalidInput(
                f"a race records every step, so steps times lanes must be at most "
                f"{MAX_RACE_STEPS:,}, not {self.steps * len(self.lanes):,}"
            )


def as_json(config: WalkingProblem) -> dict[str, Any]:
    """Convert a config to plain types, as in API responses and in files."""
    data: dict[str, Any] = {}
    for one in fields(config):
        value = getattr(config, one.name)
        data |= value if isinstance(value, SettingValues) else {one.name: value}
    data["robot"] = as_mapping(config.robot)
    del data["world"]
    data["disturbances"] = [disturbances.as_mapping(one) for one in config.world.disturbances]
    if isinstance(config.gait, GaitSpec):
        data["gait"] = {k: v for k, v in asdict(config.gait).items() if v is not None}
    if isinstance(config, RaceConfig):
        data["lanes"] = [_lane_as_json(lane) for lane in config.lanes]
        branch = config.branch_from
        data["branch_from"] = None if branch is None else branch._asdict()
    return data


def _lane_as_json(lane: LaneConfig) -> dict[str, Any]:
    return {name: getattr(lane, name) for name in sorted(_LANE_FIELDS)} | dict(lane.settings)


def _lane_from_json(data: Mapping[str, Any]) -> LaneConfig:
    own = {name: value for name, value in data.items() if name in _LANE_FIELDS}
    settings = {name: value for name, value in data.items() if name not in _LANE_FIELDS}
    return LaneConfig(**own, settings=SettingValues(settings))


def config_from_json(data: Mapping[str, Any]) -> TrainingConfig | RaceConfig:
    """Parse the output of `as_json`; a config with lanes is that of a race.

    Keys that are no field of a training, or of a lane, are its agent's settings; the agent is not
    imported.

    Raises:
        InvalidInput: if a value is invalid.
        KeyError, TypeError, ValueError: if it is not the output of `as_json`.
    """
    values = {**data, "gait": gait_from_json(data["gait"]), "robot": robot(data["robot"])}
    values["world"] = world(values.pop("disturbances", ()))  # earlier versions had none
    if "lanes" in values:
        lanes = tuple(_lane_from_json(lane) for lane in values.pop("lanes"))
        branch = values.pop("branch_from", None)  # earlier versions had none
        branch_from = None if branch is None else Branch(branch["race_id"], branch["step"])
        return RaceConfig(**values, lanes=lanes, branch_from=branch_from)
    settings = {name: values.pop(name) for name in list(values) if name not in _TRAINING_FIELDS}
    return TrainingConfig(**values, settings=SettingValues(settings))


def gait_from_json(value: str | Mapping[str, Any]) -> str | GaitSpec:
    """Parse a gait from the output of `as_json`."""
    if isinstance(value, str):
        return value
    parts = dict(value)
    if "pairs" in parts:
        parts["pairs"] = tuple((int(a), int(b)) for a, b in parts["pairs"])
    return GaitSpec(**parts)


def check_whole(name: str, value: int, low: int, high: int | None) -> None:
    """Check that a value is an integer from `low` to `high`; `high` None is no upper limit.

    Raises:
        InvalidInput: if it is not.
    """
    if isinstance(value, bool) or not isinstance(value, int):
        raise InvalidInput(f"{name} must be a whole number, not {value!r}")
    if value < low or (high is not None and value > high):
        limits = f"at least {low}" if high is None else f"from {low} to {high:,}"
        raise InvalidInput(f"{name} must be {limits}, not {value:,}")
