"""Configs of experiments: a grid of settings, each over many seeds."""

import contextlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Literal, get_args

from app.domain.errors import InvalidInput, UnknownName
from app.domain.gait import NAMED_GAITS, GaitSpec
from app.domain.observation import OBSERVATIONS, Observation
from app.domain.robot import Robot, as_mapping, robot
from app.domain.settings import REQUIRED, DeclaredSetting, SettingValues, Value
from app.runs.config import (
    SimulatorName,
    TrainingConfig,
    agent_settings,
    check_whole,
    gait_from_json,
)

ExperimentName = Literal["table1", "figure4", "sweep"]
EXPERIMENTS: tuple[ExperimentName, ...] = get_args(ExperimentName)
MAX_SEEDS = 10_000
MAX_TRIALS = 200_000
FIGURE4_BLOCKS = 8

GRID = ("steps", "steps_per_episode", "divisions", "grid_side_m")
"""Fields that a sweep varies beside agent, gait, observation, robot and the agents' settings;
table1 and figure4 keep them at the paper's values."""


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
        steps, steps_per_episode, divisions, grid_side_m: of the practice; every combination is a
            setting.
        settings: values of the agents' settings by name; every combination is a setting of the
            agents that have them, and others are left at an agent's default.
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
    settings: SettingValues[tuple[Value, ...]] = field(default_factory=SettingValues)
    steps_per_episode: tuple[int, ...] = (TrainingConfig.steps_per_episode,)
    divisions: tuple[int, ...] = (TrainingConfig.divisions,)
    grid_side_m: tuple[float, ...] = (TrainingConfig.grid_side_m,)
    blocks: int = 1

    def __post_init__(self) -> None:
        if self.experiment not in EXPERIMENTS:
            raise UnknownName("experiment", self.experiment, EXPERIMENTS)
        check_whole("seeds", self.seeds, 1, MAX_SEEDS)
        check_whole("seed", self.seed, 0, None)
        lists = {name: getattr(self, name) for name in (*_PLACES, *GRID)} | dict(self.settings)
        for name, values in lists.items():
            if not values:
                raise InvalidInput(f"{name} must name at least one")
            if any(value in values[:place] for place, value in enumerate(values)):
                raise InvalidInput(f"{name} names something twice")


_PLACES = ("agents", "gaits", "observations", "robots")
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
    """Return the fields that an experiment accepts; a sweep also takes its agents' settings."""
    return _MAY_SAY[experiment]


def settings_of(agents: Iterable[str]) -> Mapping[str, Sequence[DeclaredSetting]]:
    """The settings of some agents by name, each as the agents that have it declare it.

    Raises:
        UnknownName, InvalidInput: if there is no such agent.
    """
    found: dict[str, list[DeclaredSetting]] = {}
    for agent in agents:
        for name, setting in agent_settings(agent).items():
            found.setdefault(name, []).append(setting)
    return found


def experiment_config(experiment: str, given: Mapping[str, Any]) -> ExperimentConfig:
    """An experiment with what is given, and its own defaults for the rest.

    Args:
        experiment: its name.
        given: by attribute of `ExperimentConfig`, and values of the agents' settings by their
            names; None counts as not given.

    Raises:
        UnknownName: for an experiment, or a field, that there is not.
        InvalidInput: for a value that cannot be.
    """
    if experiment not in EXPERIMENTS:
        raise UnknownName("experiment", experiment, EXPERIMENTS)
    said = {name: value for name, value in given.items() if value is not None}
    declared = settings_of(said.get("agents", ExperimentConfig.agents))
    valid = [*_MAY_SAY[experiment], *(declared if experiment == "sweep" else ())]
    for name in said:
        if name not in valid:
            raise UnknownName(f"field of {experiment}", name, valid)
    settings = {
        name: tuple(_normalized(value, own) for value in said[name]) if name in said else default
        for name, own in declared.items()
        for default in [tuple(dict.fromkeys(setting.default for setting in own))]
        # Agents of different defaults each keep their own.
        if name in said or (len(default) == 1 and default[0] is not REQUIRED)
    }
    own_fields = {name: value for name, value in said.items() if name not in declared}
    return ExperimentConfig(
        experiment=experiment,
        **{**_OWN[experiment], **own_fields},
        settings=SettingValues(settings),
    )


def _normalized(value: Value, own: Sequence[DeclaredSetting]) -> Value:
    """A value as one of the agents that have the setting takes it; as the last of them refuses."""
    for setting in own[:-1]:
        with contextlib.suppress(InvalidInput):
            return setting.normalized(value)  # type: ignore[no-any-return]
    return own[-1].normalized(value)  # type: ignore[no-any-return]


def as_json(config: ExperimentConfig) -> dict[str, Any]:
    """In plain types, as the API shows it and files keep it."""
    shown: dict[str, Any] = {}
    for one in fields(config):
        value = getattr(config, one.name)
        shown |= value if isinstance(value, SettingValues) else {one.name: value}
    shown["robots"] = [as_mapping(one) for one in config.robots]
    shown["gaits"] = [
        {k: v for k, v in asdict(gait).items() if v is not None}
        if isinstance(gait, GaitSpec)
        else gait
        for gait in config.gaits
    ]
    return {k: list(v) if isinstance(v, tuple) else v for k, v in shown.items()}


def from_json(shown: Mapping[str, Any]) -> ExperimentConfig:
    """The config that `as_json` wrote; fields that no experiment has are settings of its agents.

    Raises:
        InvalidInput: if a value cannot be.
        KeyError, TypeError, ValueError: if `as_json` did not write it.
    """
    values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in shown.items()}
    values["robots"] = tuple(robot(one) for one in shown["robots"])
    values["gaits"] = tuple(gait_from_json(one) for one in shown["gaits"])
    own = {one.name for one in fields(ExperimentConfig)}
    settings = {name: values.pop(name) for name in list(values) if name not in own}
    if single := [name for name, value in settings.items() if not isinstance(value, tuple)]:
        raise InvalidInput(f"{single[0]} must be a list of values")
    return ExperimentConfig(**values, settings=SettingValues(settings))
