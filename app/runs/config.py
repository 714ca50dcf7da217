"""What a user asks for: a training or a race, complete and checked."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, get_args

from app.domain.errors import InvalidInput, UnknownName
from app.domain.gait import Gait, GaitSpec, resolve
from app.domain.grid import FootGrid
from app.domain.observation import Observation, check_observation
from app.domain.robot import Robot, as_mapping, robot

SimulatorName = Literal["mujoco", "kinematic"]
SIMULATORS: tuple[SimulatorName, ...] = get_args(SimulatorName)
MAX_STEPS = 10_000_000
MAX_LANES = 6
RACE_STEPS = 50
"""Steps of a race, and of an evaluation (paper §5)."""


@dataclass(frozen=True, kw_only=True)
class WalkingProblem:
    """Which robot walks how, on which foot grid, in which simulator."""

    gait: str | GaitSpec
    robot: Robot = field(default_factory=Robot)
    simulator: SimulatorName = "mujoco"
    divisions: int = 2
    grid_side_m: float = 0.04

    def __post_init__(self) -> None:
        if self.simulator not in SIMULATORS:
            raise UnknownName("simulator", self.simulator, SIMULATORS)
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
    """A training. The defaults are the paper's.

    Attributes:
        steps: how many steps to learn for.
        seed: of every generator of the run.
        observation: how the agent reads the state.
        alpha, gamma: learning rate in (0, 1] and discount in [0, 1).
        epsilon_start, epsilon_end: exploration falls linearly over the episodes.
        steps_per_episode: exploration stays the same so long.
        evaluate_every: steps between two evaluations; 0 is never.
        pace: `max`, or how many times real time.
        agent: a registered name or `my.module:Agent`.
    """

    steps: int = 500
    seed: int = 0
    observation: Observation = "measured"
    alpha: float = 0.3
    gamma: float = 0.9
    epsilon_start: float = 1.0
    epsilon_end: float = 0.0
    steps_per_episode: int = 50
    evaluate_every: int = 50
    pace: float | Literal["max"] = "max"
    agent: str = "q-learning"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_observation(self.observation)
        check_whole("steps", self.steps, 1, MAX_STEPS)
        check_whole("seed", self.seed, 0, None)
        check_whole("steps_per_episode", self.steps_per_episode, 1, MAX_STEPS)
        check_whole("evaluate_every", self.evaluate_every, 0, MAX_STEPS)
        check_rates(self.alpha, self.gamma, self.epsilon_start, self.epsilon_end)
        check_pace(self.pace)


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
    steps: int = RACE_STEPS
    seed: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_whole("steps", self.steps, 1, MAX_STEPS)
        check_whole("seed", self.seed, 0, None)
        if not 1 <= len(self.lanes) <= MAX_LANES:
            raise InvalidInput(f"a race has 1 to {MAX_LANES} lanes, not {len(self.lanes)}")


def check_rates(alpha: float, gamma: float, *epsilons: float) -> None:
    """Raise `InvalidInput` unless alpha is in (0, 1], gamma in [0, 1), each epsilon in [0, 1]."""
    if not 0 < alpha <= 1:
        raise InvalidInput(f"alpha must be over 0 and at most 1, not {alpha}")
    if not 0 <= gamma < 1:
        raise InvalidInput(f"gamma must be at least 0 and under 1, not {gamma}")
    for epsilon in epsilons:
        if not 0 <= epsilon <= 1:
            raise InvalidInput(f"epsilon must be from 0 to 1, not {epsilon}")


def check_pace(pace: float | str) -> None:
    """Raise `InvalidInput` unless pace is `max` or a positive number of times real time."""
    if pace == "max":
        return
    if not isinstance(pace, int | float) or not math.isfinite(pace) or not 0.01 <= pace <= 1000:
        raise InvalidInput(f"pace must be max, or from 0.01 to 1000 times real time, not {pace}")


def as_json(config: WalkingProblem) -> dict[str, Any]:
    """A config in plain types, as the API shows it and files keep it."""
    shown = asdict(config)
    shown["robot"] = as_mapping(config.robot)
    if isinstance(config.gait, GaitSpec):
        shown["gait"] = {k: v for k, v in asdict(config.gait).items() if v is not None}
    return shown


def config_from_json(shown: Mapping[str, Any]) -> TrainingConfig | RaceConfig:
    """The config that `as_json` wrote; only a race has lanes.

    Raises:
        InvalidInput: if a value cannot be.
        KeyError, TypeError, ValueError: if `as_json` did not write it.
    """
    fields = {**shown, "gait": gait_from_json(shown["gait"]), "robot": robot(shown["robot"])}
    if "lanes" not in fields:
        return TrainingConfig(**fields)
    lanes = tuple(LaneConfig(**lane) for lane in fields.pop("lanes"))
    return RaceConfig(**fields, lanes=lanes)


def gait_from_json(value: str | Mapping[str, Any]) -> str | GaitSpec:
    """The gait that `as_json` wrote."""
    if isinstance(value, str):
        return value
    fields = dict(value)
    if "pairs" in fields:
        fields["pairs"] = tuple((int(a), int(b)) for a, b in fields["pairs"])
    return GaitSpec(**fields)


def check_whole(name: str, value: int, low: int, high: int | None) -> None:
    """Raise `InvalidInput` unless value is a whole number in these limits."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise InvalidInput(f"{name} must be a whole number, not {value!r}")
    if value < low or (high is not None and value > high):
        limits = f"at least {low}" if high is None else f"from {low} to {high:,}"
        raise InvalidInput(f"{name} must be {limits}, not {value:,}")
