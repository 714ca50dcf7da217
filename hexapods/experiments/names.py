"""Names of experiments, settings and trials, made of the parameters that differ."""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.domain.settings import declared_fields
from hexapods.domain.text import MAX_NAME, counted
from hexapods.experiments.config import (
    ExperimentConfig,
    default_agents,
    settings_by_name,
)
from hexapods.experiments.labels import (
    OBSERVATION_LABELS,
    gait_name,
    parameter_text,
    robot_name,
    world_name,
)
from hexapods.experiments.plan import Plan
from hexapods.experiments.presets import GRID
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import PLANNING_MODEL_TITLES, PlanningModel

_PLACE = ("gait", "world", "observation", "robot")
_MAX_VALUES = 6
_MAX_TITLES = 3


def experiment_name(config: ExperimentConfig) -> str:
    """Return a name by what is varied: `α 0.1, 0.3 · 8 seeds`, `League: Q-learning · 8 seeds`."""
    seeds = f" · {counted(config.seeds, 'seed')}"
    axes, title = _axes_in_words(config), config.preset.title
    parts = [axes] if config.preset.takes_settings else [title, *filter(None, [axes])]
    name = ": ".join(parts)
    return name[: MAX_NAME - len(seeds)] + seeds


def _axes_in_words(config: ExperimentConfig) -> str:
    """Return the varied axes of an experiment in words; empty where its title names them."""
    if config.preset.takes_settings:
        agents = [_agents(config)] if len(config.agents) > 1 else []
        return " × ".join([*agents, *_swept(config)]) or title_of(config.agents[0])
    has_own = tuple(config.agents) != default_agents(config.preset)
    worlds = [] if tuple(config.worlds) == ("flat",) else [world_name(x) for x in config.worlds]
    parts = [
        *([_agents(config)] if has_own else []),
        *([_some(worlds, "worlds")] if worlds else []),
    ]
    return " · ".join(parts)


def _agents(config: ExperimentConfig) -> str:
    return _some([title_of(agent) for agent in config.agents], "agents")


def _some(titles: Sequence[str], noun: str) -> str:
    """Return titles in words, or their number if there are many."""
    return ", ".join(titles) if len(titles) <= _MAX_TITLES else f"{len(titles)} {noun}"


def _swept(config: ExperimentConfig) -> list[str]:
    """Return the settings of which a sweep tries several values: `α 0.1, 0.3`."""
    lists = {**config.settings, **{name: getattr(config, name) for name in GRID}}
    return [_values_name(name, tried, config) for name, tried in lists.items() if len(tried) > 1]


def _values_name(name: str, tried: Sequence[Any], config: ExperimentConfig) -> str:
    declared = declared_fields(TrainingConfig)
    about = (declared[name] if name in GRID else settings_by_name(config.agents)[name][0]).about
    title = about.title
    if about.symbol:
        title = title.replace(about.quantity or title, about.symbol)
    texts = [format(value, "g" if isinstance(value, float) else "") for value in tried]
    if len(texts) > _MAX_VALUES:
        values = f"in {len(texts)} values from {texts[0]} to {texts[-1]}"
    else:
        values = ", ".join(texts)
    return " ".join(filter(None, (title, values, about.unit)))


def setting_names(
    settings: Sequence[Mapping[str, Any]],
    parameters: Iterable[str],
    models: Mapping[str, PlanningModel | None] = MappingProxyType({}),
) -> dict[str, str]:
    """Return the name of each setting by its key: `Q-learning, 500 steps, Left-right, opposite`.

    Args:
        settings: entries of a summary's settings.
        parameters: the summary's names of what may vary except place and agent.
        models: models that searches plan with, by the key of their setting; named if they differ.
    """
    differing = models if len(set(models.values()) - {None}) > 1 else {}
    varied = _varied(settings, (*parameters, *_PLACE))
    return {
        setting["key"]: _name(setting, varied, differing.get(setting["key"]))
        for setting in settings
    }


def trial_names(plan: Plan, keys: Iterable[str]) -> dict[str, str]:
    """Return the name of each trial of a plan by its key; a trial that it lacks keeps its key.

    Unlike a setting's, it says where the trial walks even if all walk there:
    `Q-learning, α 0.3, Left-right, opposite, feet measured, stiff robot, seed 12`.
    """
    settings = [setting.fields for setting in plan.settings]
    varied = _varied(settings, tuple(plan.settings[0].parameters))
    names = {
        setting.key: _name(fields, (*varied, *_PLACE), setting.trial.plans_with)
        + (", timed alone" if setting.role == "timed" else "")
        for setting, fields in zip(plan.settings, settings, strict=True)
    }
    return {
        key: f"{names[setting]}, seed {number}" if setting in names else key
        for key in keys
        for setting, _, number in (key.rpartition("#"),)
    }


def _varied(settings: Sequence[Mapping[str, Any]], names: Iterable[str]) -> list[str]:
    """Return the names in which settings differ; what an agent does not have is None there."""
    return [name for name in names if len({setting[name] for setting in settings} - {None}) > 1]


def _name(setting: Mapping[str, Any], fields: Iterable[str], model: PlanningModel | None) -> str:
    parts = [title_of(setting["agent"]), *([] if model is None else [PLANNING_MODEL_TITLES[model]])]
    return ", ".join([*parts, *filter(None, (_value_name(setting, name) for name in fields))])


def _value_name(setting: Mapping[str, Any], name: str) -> str:
    """Return a value in words; empty for a value that is not named."""
    value = setting[name]
    if value is None or (name, value) in (("world", "flat"), ("steps", 0)):
        return ""
    if name == "gait":
        return gait_name(value)
    if name == "world":
        return world_name(value)
    if name == "observation":
        return OBSERVATION_LABELS.get(value, value)
    if name == "robot":
        return robot_name(value)
    return parameter_text(name, value, setting["agent"])
