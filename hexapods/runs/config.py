"""Walking problems and configs of trainings: complete, validated and immutable.

Fields that a user may choose are declared as settings (`hexapods.domain.settings`).
"""

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal, get_args

from annotated_types import Ge, Le

from hexapods.agents import registry
from hexapods.agents.protocol import Problem
from hexapods.domain import disturbances
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import DEFAULT_GAIT, AnyGait, Gait, resolve
from hexapods.domain.grid import MAX_DIVISIONS, MAX_SIDE_M, MIN_DIVISIONS, MIN_SIDE_M, FootGrid
from hexapods.domain.observation import Observation, check_observation
from hexapods.domain.records import Record
from hexapods.domain.robot import AnyRobot, Robot
from hexapods.domain.settings import (
    DeclaredSetting,
    Setting,
    SettingValues,
    Value,
    complete,
    declared_fields,
)
from hexapods.domain.short_repr import short_repr
from hexapods.domain.simulator import RewardKind
from hexapods.domain.tolerance import MAX_TOLERANCE, build_tolerance
from hexapods.domain.world import UNDISTURBED, AnyWorld
from hexapods.runs.seeding import BUILDING, generator

_log = logging.getLogger(__name__)
SimulatorName = Literal["mujoco", "kinematic"]
SIMULATORS: tuple[SimulatorName, ...] = get_args(SimulatorName)
MAX_STEPS = disturbances.MAX_STEP
RACE_STEPS = 50
"""Default number of steps of a race, and number of steps of an evaluation (paper §5)."""

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
REWARD_TITLES: Mapping[RewardKind, str] = {
    "forward": "along its own heading",
    "track": "along the track",
}
Reward = Annotated[
    RewardKind,
    Setting(
        title="Reward",
        phrase="reward\u00a0{}",
        help="Displacement that a step's reward is: along the robot's own heading (default), or "
        "along the track, so that a robot that turns earns no more than it advances.",
        choice_titles=tuple(REWARD_TITLES.values()),
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
        title="Evaluate every",
        unit="steps",
        help="Evaluates the policy after every so many steps; 0: never.",
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


@dataclass(frozen=True, kw_only=True)
class WalkingProblem(Record):
    """Walking problem: a robot, its gait and foot grid, and the simulator.

    Attributes:
        gait: a named gait, or a gait given by its groups of legs.
        robot: geometry and actuators.
        simulator: `mujoco` (physics) or `kinematic` (ideal, no slip).
        divisions: points along each side of the foot grid.
        grid_side_m: side of the foot grid [m].
        world: what happens to the robot and the ground, by step.
        tolerance: how far the robot that the run's seed draws differs from `robot`, as a share.
        reward: displacement that a step's reward is, `forward` or `track`.

    Raises:
        UnknownName: if the gait or the simulator is unknown.
        InvalidInput: if a value is out of its limits, or gait or world do not fit the robot.
    """

    __repr__ = short_repr

    json_names: ClassVar[Mapping[str, str]] = MappingProxyType({"world": "disturbances"})

    gait: AnyGait = DEFAULT_GAIT
    robot: AnyRobot = field(default_factory=Robot)
    simulator: SimulatorName = "mujoco"
    divisions: Divisions = FootGrid.divisions
    grid_side_m: GridSide = FootGrid.side_m
    world: AnyWorld = UNDISTURBED
    tolerance: Tolerance = 0.0
    reward: Reward = "forward"

    def __post_init__(self) -> None:
        if self.simulator not in SIMULATORS:
            raise UnknownName("simulator", self.simulator, SIMULATORS)
        declared = declared_fields(type(self))  # type: ignore[arg-type]  # of a class, not of an instance
        for setting in declared.values():
            setting.check(getattr(self, setting.name))
        resolve(self.gait, self.robot.azimuths_deg)
        FootGrid(self.grid_side_m, self.divisions)
        if self.tolerance and self.simulator == "kinematic":
            raise InvalidInput(
                "the kinematic simulator knows no build tolerance; choose the simulator mujoco, or "
                "tolerance 0"
            )
        self.world.check(self.robot, self.simulator, getattr(self, "steps", None))

    def walk(self) -> "WalkingProblem":
        """Return the walking problem alone, without the fields of a training or race."""
        names = (field.name for field in fields(WalkingProblem))
        return WalkingProblem(**{name: getattr(self, name) for name in names})

    @property
    def grid(self) -> FootGrid:
        """The foot grid of this config."""
        return FootGrid(self.grid_side_m, self.divisions)

    @property
    def resolved_gait(self) -> Gait:
        """The gait with its groups of legs for this robot."""
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
    gait = walk.resolved_gait
    return Problem(gait.groups, walk.grid.cells, gait.azimuths_deg)


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

    __repr__ = short_repr

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


TRAINING_FIELDS = frozenset(field.name for field in fields(TrainingConfig))
"""Names of the fields of a training; all other names are settings of its agent."""


_RESERVED = """
a agents as_json b beats_greedy beats_greedy_total best_known_m best_known_relative blocks
checkpoint data disturb elapsed_s execution experiment failed finished from gaits greedy_m h
half_side_m help high high_m iqm_m is_deterministic json keep keeping key low low_m mean_m n name
observations of_best_known out points_m probability published reaches_greedy relative
relative_finished resume retry robots role scheduler seed_numbers seeds table tls_ca tls_cert
tls_key total trials verdict walk walkers workers worlds
"""
RESERVED = frozenset(_RESERVED.split())
"""Names that mean something else beside the settings on the command line or in summaries."""


def agent_settings(agent: str) -> Mapping[str, DeclaredSetting]:
    """The settings that an agent's constructor declares, without fields of a training.

    Raises:
        UnknownName, InvalidInput: if there is no such agent, or a setting's name is reserved.
    """
    settings = registry.settings_of(registry.find(agent))
    for name in settings:
        if name in RESERVED or name.startswith(("_", "model_")):
            raise InvalidInput(
                f"agent {agent} declares a setting named {name!r}, which means something else in "
                "commands and summaries; rename the parameter"
            )
    return {name: setting for name, setting in settings.items() if name not in TRAINING_FIELDS}


def usable_agents() -> tuple[str, ...]:
    """The registered agents; one whose settings cannot be offered is left out, and logged."""
    usable = []
    for agent in registry.registered():
        try:
            agent_settings(agent), changeable_settings(agent)
        except (TypeError, ValueError) as error:
            _log.warning("agent %s is left out: %s", agent, error)
        else:
            usable.append(agent)
    return tuple(usable)


def changeable_settings(agent: str) -> Mapping[str, DeclaredSetting]:
    """Return the settings of a training that may change while it runs.

    Raises:
        UnknownName, InvalidInput: if there is no such agent.
    """
    live_fields = {
        name: setting
        for name, setting in declared_fields(TrainingConfig).items()
        if setting.about.live
    }
    return live_fields | dict(registry.live_settings_of(registry.find(agent)))


def training_config(
    agent: str = TrainingConfig.agent, **fields_and_settings: Any
) -> TrainingConfig:
    """Create the config of a training, with its agent's settings validated and completed.

    Args:
        agent: a registered name or `my.module:Agent`.
        fields_and_settings: fields of `TrainingConfig`, and the agent's settings by name.

    Raises:
        UnknownName, InvalidInput: if the agent, a setting or a value is invalid.
    """
    training_fields = {
        name: value for name, value in fields_and_settings.items() if name in TRAINING_FIELDS
    }
    settings = {
        name: value for name, value in fields_and_settings.items() if name not in TRAINING_FIELDS
    }
    config = TrainingConfig(agent=agent, **training_fields)
    return replace(config, settings=complete(agent_settings(agent), settings, agent))
