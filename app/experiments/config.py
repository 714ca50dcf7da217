"""Configs of experiments: a grid of settings, each over many seeds."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, get_args

from app.domain.errors import InvalidInput, UnknownName
from app.domain.gait import NAMED_GAITS, GaitSpec
from app.domain.observation import OBSERVATIONS, Observation
from app.domain.robot import Robot, as_mapping, robot
from app.runs.config import SimulatorName, TrainingConfig, check_whole, gait_from_json

ExperimentName = Literal["table1", "figure4", "sweep"]
EXPERIMENTS: tuple[ExperimentName, ...] = get_args(ExperimentName)
MAX_SEEDS = 10_000
MAX_TRIALS = 200_000
FIGURE4_BLOCKS = 8

GRID = (
    "steps",
    "alpha",
    "gamma",
    "epsilon_start",
    "epsilon_end",
    "steps_per_episode",
    "divisions",
    "grid_side_m",
)
"""Parameters that a sweep varies beside agent, gait, observation and robot; table1 and figure4 keep
them at the paper's values."""


@dataclass(frozen=True, kw_only=True)
class ExperimentConfig:
    """An experiment. `experiment_config` fills in what is not given.

    Attributes:
        experiment: `table1`: the paper's Table 1; `figure4`: its Figure 4; `sweep`: any grid.
        seeds: how many times each setting of an agent that learns is tried.
        seed: from which the seeds of all trials are spawned.
        agents: who learns; in a sweep also who looks ahead. Table 1 has its own.
        gaits, observations, robots: every combination is a setting.
        simulator: of all trials.
        steps, alpha, gamma, epsilon_start, epsilon_end, steps_per_episode, divisions,
            grid_side_m: of the practice; every combination is a setting.
        blocks: in how many blocks of `steps` is practised, the table saved and loaded in between.
    """

    experiment: ExperimentName
    seeds: int = 30
    seed: int = 0
    agents: tuple[str, ...] = ("q-learning",)
    gaits: tuple[str | GaitSpec, ...] = tuple(NAMED_GAITS)
    observations: tuple[Observation, ...] = OBSERVATIONS
    robots: tuple[Robot, ...] = (Robot(),)
    simulator: SimulatorName = "mujoco"
    steps: tuple[int, ...] = (TrainingConfig.steps,)
    alpha: tuple[float, ...] = (TrainingConfig.alpha,)
    gamma: tuple[float, ...] = (TrainingConfig.gamma,)
    epsilon_start: tuple[float, ...] = (TrainingConfig.epsilon_start,)
    epsilon_end: tuple[float, ...] = (TrainingConfig.epsilon_end,)
    steps_per_episode: tuple[int, ...] = (TrainingConfig.steps_per_episode,)
    divisions: tuple[int, ...] = (TrainingConfig.divisions,)
    grid_side_m: tuple[float, ...] = (TrainingConfig.grid_side_m,)
    blocks: int = 1

    def __post_init__(self) -> None:
        if self.experiment not in EXPERIMENTS:
            raise UnknownName("experiment", self.experiment, EXPERIMENTS)
        check_whole("seeds", self.seeds, 1, MAX_SEEDS)
        check_whole("seed", self.seed, 0, None)
        for name in ("agents", "gaits", "observations", "robots", *GRID):
            values = getattr(self, name)
            if not values:
                raise InvalidInput(f"{name} must name at least one")
            if any(value in values[:place] for place, value in enumerate(values)):
                raise InvalidInput(f"{name} names something twice")


_OWN: Mapping[str, Mapping[str, Any]] = {
    "table1": {"steps": (500, 1000), "robots": (robot("stiff"), robot("compliant"))},
    "figure4": {"steps": (250,), "blocks": FIGURE4_BLOCKS},
    "sweep": {"observations": ("measured",)},
}
_COMMON = ("seeds", "seed", "gaits", "observations", "robots", "simulator")
_MAY_SAY: Mapping[str, tuple[str, ...]] = {
    "table1": _COMMON,
    "figure4": (*_COMMON, "agents"),
    "sweep": (*_COMMON, "agents", *GRID),
}


def fields_of(experiment: ExperimentName) -> tuple[str, ...]:
    """Return the fields that an experiment accepts."""
    return _MAY_SAY[experiment]


def experiment_config(experiment: str, given: Mapping[str, Any]) -> ExperimentConfig:
    """An experiment with what is given, and its own defaults for the rest.

    Args:
        experiment: its name.
        given: by attribute of `ExperimentConfig`; None counts as not given.

    Raises:
        UnknownName: for an experiment, or a field, that there is not.
        InvalidInput: for a value that cannot be.
    """
    if experiment not in EXPERIMENTS:
        raise UnknownName("experiment", experiment, EXPERIMENTS)
    said = {name: value for name, value in given.items() if value is not None}
    for name in said:
        if name not in _MAY_SAY[experiment]:
            raise UnknownName(f"field of {experiment}", name, _MAY_SAY[experiment])
    return ExperimentConfig(experiment=experiment, **{**_OWN[experiment], **said})


def as_json(config: ExperimentConfig) -> dict[str, Any]:
    """In plain types, as the API shows it and files keep it."""
    shown = asdict(config)
    shown["robots"] = [as_mapping(one) for one in config.robots]
    shown["gaits"] = [
        {k: v for k, v in asdict(gait).items() if v is not None}
        if isinstance(gait, GaitSpec)
        else gait
        for gait in config.gaits
    ]
    return {k: list(v) if isinstance(v, tuple) else v for k, v in shown.items()}


def from_json(shown: Mapping[str, Any]) -> ExperimentConfig:
    """The config that `as_json` wrote.

    Raises:
        InvalidInput: if a value cannot be.
        KeyError, TypeError, ValueError: if `as_json` did not write it.
    """
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in shown.items()}
    values["robots"] = tuple(robot(one) for one in shown["robots"])
    values["gaits"] = tuple(gait_from_json(one) for one in shown["gaits"])
    return ExperimentConfig(**values)
