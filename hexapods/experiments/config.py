"""Configs of experiments: a grid of settings, each repeated over many seeds."""

import contextlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

from annotated_types import Ge, Le

from hexapods.agents.registry import learns
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import NAMED_GAITS, PAPER_GAITS, AnyGait
from hexapods.domain.observation import OBSERVATIONS, PAPER_OBSERVATIONS, Observation
from hexapods.domain.records import Record
from hexapods.domain.robot import PRESETS, AnyRobot, Robot
from hexapods.domain.settings import (
    REQUIRED,
    DeclaredSetting,
    Setting,
    SettingValues,
    Value,
    declared_fields,
)
from hexapods.domain.short_repr import short_repr
from hexapods.domain.world import WORLDS, lasting_world
from hexapods.experiments.presets import GRID, Preset, preset_of
from hexapods.runs.config import (
    Divisions,
    GridSide,
    PracticeSteps,
    Reward,
    Seed,
    SimulatorName,
    StepsPerEpisode,
    Tolerance,
    TrainingConfig,
    agent_settings,
    usable_agents,
)

MAX_SEEDS = 10_000
MAX_TRIALS = 200_000
MAX_WORKERS = 512

SUMMARY = "summary.json"
"""File of a report: statistics and claims computed from the trials so far."""
SUMMARY_FORMAT = 2
REPORT = "report.html"
"""The report as one self-contained page."""
TRIALS_TABLE = "trials.csv"
"""Every trial, with its result."""


@dataclass(frozen=True, kw_only=True)
class ExperimentConfig(Record):
    """Config of an experiment. `experiment_config` adds the defaults of the experiment.

    Attributes:
        experiment: name of its preset, see `presets`.
        seeds: number of seeds for each setting of an agent that learns.
        seed: root seed, from which the seeds of all trials are spawned.
        agents: the learners, and look-ahead agents beside those that are always tried.
        gaits, observations, robots: every combination is a setting; without gaits, each
            robot has the gait that suits it.
        simulator: simulator of all trials.
        steps, steps_per_episode, divisions, grid_side_m: values of these fields of a training;
            every combination is a setting.
        settings: values of the agents' settings by name; every combination is a setting of the
            agents that have them; the agent's default applies to others.
        blocks: number of blocks of `steps` of practice; between blocks the table is saved and
            loaded.
        worlds: names of worlds, or disturbances as on the command line; every one is a setting.
        tolerance: build tolerance of the robots, of which each seed draws one.
        reward: displacement that a step's reward is, in all trials.

    Raises:
        UnknownName, InvalidInput: if a value is invalid, empty or repeated.
    """

    __repr__ = short_repr

    kind: ClassVar[str] = "experiment"
    """Name of the experiment in a results folder."""
    options: ClassVar[Mapping[str, str]] = {
        "agents": "--agent",
        "gaits": "--gait",
        "observations": "--observation",
        "robots": "--robot",
        "worlds": "--world",
    }
    """Options of the command line, by field; see `option_of`."""

    experiment: str
    seeds: Annotated[
        int,
        Ge(1),
        Le(MAX_SEEDS),
        Setting(
            title="Seeds",
            help="How often each setting is tried, each time with other random numbers.",
        ),
    ] = 30
    seed: Seed = 0
    agents: tuple[str, ...] = ("q-learning",)
    gaits: tuple[AnyGait, ...] = tuple(PAPER_GAITS)
    observations: tuple[Observation, ...] = PAPER_OBSERVATIONS
    robots: tuple[AnyRobot, ...] = (Robot(),)
    simulator: SimulatorName = "mujoco"
    steps: tuple[PracticeSteps, ...] = (TrainingConfig.steps,)
    settings: SettingValues[tuple[Value, ...]] = field(default_factory=SettingValues)
    steps_per_episode: tuple[StepsPerEpisode, ...] = (TrainingConfig.steps_per_episode,)
    divisions: tuple[Divisions, ...] = (TrainingConfig.divisions,)
    grid_side_m: tuple[GridSide, ...] = (TrainingConfig.grid_side_m,)
    blocks: int = 1
    worlds: tuple[str, ...] = ("flat",)
    tolerance: Tolerance = 0.0
    reward: Reward = TrainingConfig.reward

    def __post_init__(self) -> None:
        preset = self.preset
        for setting in declared_fields(type(self)).values():  # type: ignore[arg-type]  # mypy: no hash
            setting.check(getattr(self, setting.name))
        for world in self.worlds:
            lasting_world(world)
        lists = {name: getattr(self, name) for name in (*_LIST_FIELDS, *GRID)} | dict(self.settings)
        for name, values in lists.items():
            if not values and not (name == "gaits" and preset.has_own_gaits):
                raise InvalidInput(f"{name} must name at least one; valid: {self._valid(name)}")
            if any(value in values[:place] for place, value in enumerate(values)):
                raise InvalidInput(f"{name} names something twice")

    def _valid(self, name: str) -> str:
        """Return in words which values a list, a field of the grid or an agent's setting takes."""
        names: Mapping[str, Iterable[str]] = {
            "agents": [agent for agent in usable_agents() if compares(self.preset, agent)],
            "gaits": NAMED_GAITS,
            "observations": OBSERVATIONS,
            "robots": PRESETS,
            "worlds": WORLDS,
        }
        if name in names:
            return ", ".join(names[name])
        grid = declared_fields(TrainingConfig)
        return grid[name].valid if name in grid else settings_by_name(self.agents)[name][0].valid

    @property
    def preset(self) -> Preset:
        """Preset of the experiment."""
        return preset_of(self.experiment)

    @classmethod
    def option_of(cls, field: str) -> str:
        """Return the option of a field, or of a setting of an agent: `--grid-side-m`."""
        return cls.options.get(field, f"--{field.replace('_', '-')}")


_LIST_FIELDS = ("agents", "gaits", "observations", "robots", "worlds")


def default_agents(preset: Preset) -> tuple[str, ...]:
    """Return the agents of an experiment if none are given."""
    return tuple(preset.defaults.get("agents", ExperimentConfig.agents))


def compares(preset: Preset, agent: str) -> bool:
    """Whether an experiment compares an agent."""
    return learns(agent) or not preset.is_for_learners


def settings_by_name(agents: Iterable[str]) -> Mapping[str, Sequence[DeclaredSetting]]:
    """Return the settings of some agents by name, each with the declarations of its agents.

    Raises:
        UnknownName, InvalidInput: if there is no such agent.
    """
    declarations: dict[str, list[DeclaredSetting]] = {}
    for agent in agents:
        for name, setting in agent_settings(agent).items():
            declarations.setdefault(name, []).append(setting)
    return declarations


def experiment_config(experiment: str, values: Mapping[str, Any]) -> ExperimentConfig:
    """Create the config of an experiment from values and the experiment's defaults.

    Args:
        experiment: name of the experiment's preset.
        values: values by attribute of `ExperimentConfig`, and lists of values of the agents'
            settings by name; None stands for the default.

    Raises:
        UnknownName: if the experiment or a field does not exist.
        InvalidInput: if a value is invalid.
    """
    preset = preset_of(experiment)
    specified = {name: value for name, value in values.items() if value is not None}
    defaults = preset.defaults
    if specified.get("simulator") == "kinematic":
        defaults = {**defaults, **preset.ideal_defaults}
    agents = specified.get("agents", default_agents(preset))
    declared = settings_by_name(agents)
    valid = [*preset.fields, *(declared if preset.takes_settings else ())]
    for name in specified:
        if name not in valid:
            raise UnknownName(f"field of {experiment}", name, valid)
    for agent in agents:
        if not compares(preset, agent):
            raise InvalidInput(
                f"{agent} does not learn, so it does not recover; greedy is there as a "
                "reference anyway"
            )
    settings = {
        name: tuple(_normalized(value, declarations) for value in specified[name])
        if name in specified
        else default
        for name, declarations in declared.items()
        for default in [tuple(dict.fromkeys(setting.default for setting in declarations))]
        # Agents of different defaults each keep their own.
        if name in specified or (len(default) == 1 and default[0] is not REQUIRED)
    }
    own_fields = {name: value for name, value in specified.items() if name not in declared}
    return ExperimentConfig(
        experiment=experiment,
        **{**defaults, **own_fields},
        settings=SettingValues(settings),
    )


def _normalized(value: Value, declarations: Sequence[DeclaredSetting]) -> Value:
    """Normalise a value by the first declaration that accepts it; else raise the last error."""
    for setting in declarations[:-1]:
        with contextlib.suppress(InvalidInput):
            return setting.normalized(value)  # type: ignore[no-any-return]
    return declarations[-1].normalized(value)  # type: ignore[no-any-return]


def by_option(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields and settings side by side, as options and Python's arguments have them.

    Args:
        data: a config as JSON.
    """
    return {**{k: v for k, v in data.items() if k != "settings"}, **data["settings"]}
