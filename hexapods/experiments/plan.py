"""Plan of an experiment: expands its config to settings and trials, in execution order."""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain, product
from typing import Any, Literal, NamedTuple

import numpy as np

from hexapods.agents.registry import check_problem, learns
from hexapods.domain.creatures import own_gait
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.kinematics import check_reach
from hexapods.domain.observation import Observation
from hexapods.domain.robot import Robot
from hexapods.domain.settings import SettingValues, Value
from hexapods.domain.world import parse_world
from hexapods.experiments.config import MAX_TRIALS, ExperimentConfig
from hexapods.experiments.presets import EARNING_STEPS, GRID
from hexapods.experiments.trial import TrialConfig
from hexapods.runs.config import (
    TrainingConfig,
    WalkingProblem,
    agent_settings,
    problem_of,
    training_config,
)

Role = Literal["learner", "reference", "timed"]
"""`learner`: one trial per seed; `reference`: a deterministic look-ahead agent, one trial, or one
per seed where robots or sensors differ by seed; `timed`: one trial that runs alone, for wall-clock
times."""

RIVALS = ("greedy", "two-step")
_GRID_FIELDS = ("divisions", "grid_side_m")
LEAGUE_STEPS = (25, 50, 100, 150, 250, 500, 1000, 1500, 2000, 3000, 5000, 10_000)
"""Steps after which learners are evaluated along their practice; and at its end."""
RECOVERY_STEPS = (0, 1, 25, 50, 100, 150)
"""Steps after something happened at which learners are evaluated that recover from it."""


@dataclass(frozen=True, kw_only=True)
class TrialSetting:
    """Everything that determines a trial's result except its seed.

    Attributes:
        key: unique name in files, tables and on the page.
        role: purpose in the plan.
        robot: label of the robot in this experiment.
        world: the world as the experiment names it; in a recovery it begins after the practice.
        trial: config of its trials, with seed 0.
        parameters: values by name of everything that the plan varies except scenario and agent;
            None for a setting that the agent does not have.
    """

    key: str
    role: Role
    robot: str
    trial: TrialConfig
    world: str = "flat"
    parameters: SettingValues[Value] = field(default_factory=SettingValues)

    @property
    def training(self) -> TrainingConfig:
        """Training config of the trials."""
        return self.trial.training

    @property
    def practised_steps(self) -> int:
        """Steps of practice in a block; in a recovery until something happens; 0 without any."""
        if self.role == "reference":
            return 0
        return self.trial.evaluations[0] if self.trial.earning_steps else self.training.steps

    @property
    def walks_after(self) -> Sequence[int]:
        """Steps of practice after which a learner walks: its evaluations, or the ends of blocks."""
        blocks = (self.training.steps * (1 + number) for number in range(self.trial.blocks))
        return self.trial.evaluations or tuple(blocks)

    @property
    def gait(self) -> str:
        """Name of the gait."""
        return self.training.resolved_gait.name

    @property
    def fields(self) -> dict[str, Any]:
        """Fields that identify the setting, by name; search agents have no training parameters."""
        return {
            "gait": self.gait,
            "observation": self.training.observation,
            "robot": self.robot,
            "world": self.world,
            "agent": self.training.agent,
            **self.parameters,
        }


@dataclass(frozen=True)
class Trial:
    """One trial of a plan.

    Attributes:
        key: key of the setting and number of the seed: `…#12`.
        setting: its setting.
        seed_number: counted from 0.
        seed: of its training.
    """

    key: str
    setting: TrialSetting
    seed_number: int
    seed: int

    @cached_property
    def config(self) -> TrialConfig:
        """Config of the trial; made when it is first read, since it is all checked again."""
        training = replace(self.setting.training, seed=self.seed)
        return replace(self.setting.trial, training=training)


def is_deterministic(setting: TrialSetting) -> bool:
    """Whether a setting's trials come out equal with every seed.

    Those of an agent that looks ahead do, unless robots or sensors differ by seed.
    """
    training = setting.training
    varies = training.tolerance > 0 or training.world.one_of(SensorNoise) is not None
    return setting.role == "reference" and not varies


class Plan:
    """The settings of an experiment, and their trials."""

    def __init__(self, config: ExperimentConfig, more: Sequence[TrialSetting] = ()) -> None:
        """Expand the config; nothing is run.

        Args:
            config: the experiment.
            more: settings beside those of the config.

        Raises:
            InvalidInput, UnknownName, Unreachable: if a setting is invalid, or there are too many
                trials.
        """
        self.config = config
        self.settings: Sequence[TrialSetting] = [*_settings(config), *more]
        self.total = sum(self.count(setting) for setting in self.settings)  # whole numbers
        if self.total > MAX_TRIALS:
            raise InvalidInput(
                f"the grid has {self.total:,} trials, the most is {MAX_TRIALS:,}; choose fewer "
                "values or fewer seeds"
            )

    def count(self, setting: TrialSetting) -> int:
        """Return the number of trials of a setting."""
        return 1 if setting.role == "timed" or is_deterministic(setting) else self.config.seeds

    def trials(self) -> Iterator[Trial]:
        """Iterate over all trials: references, then learners by seed, then timed trials."""
        for role in ("reference", "learner", "timed"):
            numbered = [(i, s) for i, s in enumerate(self.settings) if s.role == role]
            for seed_number in range(max((self.count(s) for _, s in numbered), default=0)):
                for index, setting in numbered:
                    if seed_number < self.count(setting):
                        yield self._trial(index, seed_number)

    def find(self, key: str) -> Trial | None:
        """Return the trial with a key; None if there is none."""
        setting_key, _, number = key.rpartition("#")
        index = self._indices.get(setting_key)
        # Longer ones are no number of a seed, and Python refuses to read very long ones.
        if index is None or not re.fullmatch("0|[1-9][0-9]{0,8}", number):
            return None
        has_it = int(number) < self.count(self.settings[index])
        return self._trial(index, int(number)) if has_it else None

    @cached_property
    def _indices(self) -> Mapping[str, int]:
        return {setting.key: index for index, setting in enumerate(self.settings)}

    def _trial(self, index: int, seed_number: int) -> Trial:
        # Where the seed draws the robot, all agents walk with the same ones.
        spawned = 0 if self.config.preset.has_worlds else index
        seed = trial_seed(self.config.seed, spawned, seed_number)
        setting = self.settings[index]
        return Trial(f"{setting.key}#{seed_number}", setting, seed_number, seed)


def trial_seed(seed: int, setting: int, seed_number: int) -> int:
    """Return the seed of a trial, as by `SeedSequence.spawn` per setting, then per seed number.

    It has 53 bits, so that JSON parsers with float numbers preserve it.
    """
    sequence = np.random.SeedSequence(seed, spawn_key=(setting, seed_number))
    return int(sequence.generate_state(1, np.uint64)[0] >> np.uint64(11))


def _settings(config: ExperimentConfig) -> list[TrialSetting]:
    preset = config.preset
    learners, references, in_one_go, timed = [], [], [], []
    declared = {agent: agent_settings(agent) for agent in (*config.agents, *RIVALS)}
    for name in config.settings:
        if not any(name in settings for settings in declared.values()):
            raise UnknownName(
                "setting", name, dict.fromkeys(chain.from_iterable(declared.values()))
            )
    lists = {"steps": config.steps, **config.settings}
    grid = _combinations({**lists, "steps_per_episode": config.steps_per_episode})
    reference_grid = _combinations(config.settings)
    for place in _scenarios(config):
        references += [
            _setting(place, agent, 0, values)
            for agent in _look_ahead_agents(config)
            for values in dict.fromkeys(
                _subset(combination, declared[agent]) for combination in reference_grid
            )
        ]
        practices = dict.fromkeys(
            (agent, _subset(values, (*declared[agent], "steps", "steps_per_episode")))
            for values in grid
            for agent in config.agents
            if learns(agent)
        )
        in_scenario = [_learner(place, agent, config, values) for agent, values in practices]
        if preset.has_worlds and (place.walk.world or place.walk.tolerance):
            references.append(_nominal(_setting(place, "greedy", 0, SettingValues())))
        learners += in_scenario
        if preset.measure == "blocks":
            in_one_go += [
                _in_one_go(place, in_blocks.trial, values)
                for (_, values), in_blocks in zip(practices, in_scenario, strict=True)
            ]
        if preset.is_timed:
            timed.append(_timed(in_scenario[0]))
    # After the blocks, whose seeds depend on their place in this list.
    settings = [*references, *learners, *in_one_go, *timed]
    key, count = Counter(setting.key for setting in settings).most_common(1)[0]
    if count > 1:
        raise InvalidInput(f"the setting {key} is there twice; name each value once")
    return _with_parameters(settings)


class _Scenario(NamedTuple):
    """Scenario in which agents are compared: walking problem and observation mode."""

    walk: WalkingProblem
    observation: Observation
    robot: str
    """Label of the robot."""
    world: str
    """Name of the world."""


def _scenarios(config: ExperimentConfig) -> Iterator[_Scenario]:
    for gait, observation, (label, robot), world, divisions, side_m in product(
        config.gaits or (None,),
        config.observations,
        _labelled_robots(config),
        config.worlds,
        config.divisions,
        config.grid_side_m,
    ):
        walk = WalkingProblem(
            gait=own_gait(robot) if gait is None else gait,
            robot=robot,
            simulator=config.simulator,
            divisions=divisions,
            grid_side_m=side_m,
            world=parse_world(world),
            tolerance=config.tolerance,
            reward=config.reward,
        )
        check_reach(robot, walk.resolved_gait, walk.grid)
        yield _Scenario(walk, observation, label, world)


def _labelled_robots(config: ExperimentConfig) -> list[tuple[str, Robot]]:
    """Return robots with unique labels: those derived from one preset are numbered."""
    names = [robot.name for robot in config.robots]
    return [
        (name if names.count(name) == 1 else f"{name} {1 + names[:place].count(name)}", robot)
        for place, (name, robot) in enumerate(zip(names, config.robots, strict=True))
    ]


def _look_ahead_agents(config: ExperimentConfig) -> list[str]:
    """Return the look-ahead agents: the references of the preset, then those of the config."""
    chosen = (agent for agent in config.agents if not learns(agent))
    return list(dict.fromkeys((*config.preset.references, *chosen)))


def _combinations(lists: Mapping[str, Sequence[Any]]) -> list[SettingValues[Value]]:
    return [
        SettingValues(dict(zip(lists, values, strict=True))) for values in product(*lists.values())
    ]


def _subset(values: Mapping[str, Any], names: Collection[str]) -> SettingValues[Any]:
    """Return the subset of values with these names."""
    return SettingValues({name: value for name, value in values.items() if name in names})


def _setting(
    place: _Scenario, agent: str, blocks: int, values: Mapping[str, Value]
) -> TrialSetting:
    training = training_config(
        **vars(place.walk), observation=place.observation, agent=agent, evaluate_every=0, **values
    )
    check_problem(agent, problem_of(training), training.settings)
    agent_defaults = {name: setting.default for name, setting in agent_settings(agent).items()}
    defaults = {name: getattr(TrainingConfig, name) for name in GRID} | agent_defaults
    words = [training.resolved_gait.name, place.observation, place.robot]
    if place.world != "flat":
        words.append(place.world)
    words += _non_default({name: getattr(training, name) for name in _GRID_FIELDS}, defaults)
    words.append(agent)
    if blocks:
        words.append(f"{blocks}x{training.steps}" if blocks > 1 else f"{training.steps}")
    words += _non_default({k: v for k, v in values.items() if k != "steps"}, defaults)
    role: Role = "learner" if blocks else "reference"
    trial = TrialConfig(training=training, blocks=blocks)
    key = "/".join(words)
    return TrialSetting(key=key, role=role, robot=place.robot, trial=trial, world=place.world)


def _learner(
    place: _Scenario, agent: str, config: ExperimentConfig, values: Mapping[str, Value]
) -> TrialSetting:
    """Return a setting of an agent that practises, as the experiment evaluates it."""
    setting = _setting(place, agent, config.blocks, values)
    training = setting.training
    if config.preset.measure == "practice":
        points = (*(step for step in LEAGUE_STEPS if step < training.steps), training.steps)
        return replace(setting, trial=replace(setting.trial, evaluations=points))
    if config.preset.measure == "recovery":
        happens = training.steps
        trial = TrialConfig(
            training=replace(
                training,
                steps=happens + RECOVERY_STEPS[-1] + EARNING_STEPS,
                world=training.world.later(happens),
            ),
            evaluations=tuple(happens + step for step in RECOVERY_STEPS),
            earning_steps=EARNING_STEPS,
        )
        return replace(setting, trial=trial)
    return setting


def _in_one_go(
    place: _Scenario, in_blocks: TrialConfig, values: Mapping[str, Value]
) -> TrialSetting:
    """Return a setting that practises the steps of all blocks in one go, so that ε falls once.

    Args:
        place: where the agent walks.
        in_blocks: trial of the setting in blocks, at whose ends this one is evaluated, too.
        values: values of the setting in blocks.
    """
    block = in_blocks.training
    steps = in_blocks.blocks * block.steps
    setting = _setting(place, block.agent, 1, {**values, "steps": steps})
    points = tuple(range(block.steps, steps + 1, block.steps))
    return replace(setting, trial=replace(setting.trial, evaluations=points))


def _nominal(greedy: TrialSetting) -> TrialSetting:
    """Return greedy's setting with the robot as designed, on flat ground, as its model."""
    trial = replace(greedy.trial, plans_with="nominal")
    return replace(greedy, key=f"{greedy.key}/nominal", trial=trial)


def _with_parameters(settings: Sequence[TrialSetting]) -> list[TrialSetting]:
    """Set the parameters of all settings: the same names in the same order."""
    names = dict.fromkeys(name for setting in settings for name in setting.training.settings)
    completed = []
    for setting in settings:
        training, practises = setting.training, setting.role != "reference"
        parameters: dict[str, Value] = {
            "steps": setting.practised_steps,
            **{name: training.settings.get(name) for name in names},
            "steps_per_episode": training.steps_per_episode if practises else None,
            **{name: getattr(training, name) for name in _GRID_FIELDS},
        }
        completed.append(replace(setting, parameters=SettingValues(parameters)))
    return completed


def _non_default(values: Mapping[str, Value], defaults: Mapping[str, Value]) -> list[str]:
    """Format the values that differ from the defaults, for a key."""
    return [
        f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}"
        for name, value in values.items()
        if value != defaults[name]
    ]


def _timed(setting: TrialSetting) -> TrialSetting:
    trial = replace(setting.trial, rivals=RIVALS)
    return replace(setting, key=f"{setting.key}/timed", role="timed", trial=trial)
