"""Names of settings and trials in words: the agent, and all in which the settings differ."""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from hexapods.agents.appearance import title_of
from hexapods.experiments.labels import (
    OBSERVATION_LABELS,
    gait_name,
    parameter_text,
    robot_name,
    world_name,
)
from hexapods.experiments.plan import Plan
from hexapods.runs.lane import PLANNING_MODEL_TITLES, PlanningModel

_PLACE = ("gait", "world", "observation", "robot")


def setting_names(
    settings: Sequence[Mapping[str, Any]],
    parameters: Iterable[str],
    models: Mapping[str, PlanningModel | None] = MappingProxyType({}),
) -> dict[str, str]:
    """Return the name of each setting by its key: `Q-learning, 500 steps, Left-right, opposite`.

    Args:
        settings: entries of a summary's settings.
        parameters: the summary's names of what may vary except place and agent.
        models: models that searches plan with, by the key of their setting; told if they differ.
    """
    differing = models if len(set(models.values()) - {None}) > 1 else {}
    varied = _varied(settings, (*parameters, *_PLACE))
    return {one["key"]: _name(one, varied, differing.get(one["key"])) for one in settings}


def trial_names(plan: Plan, keys: Iterable[str]) -> dict[str, str]:
    """Return the name of each trial of a plan by its key; a trial that it lacks keeps its key.

    Unlike a setting's, it says where the trial walks even if all walk there:
    `Q-learning, α 0.3, Left-right, opposite, feet measured, stiff robot, seed 12`.
    """
    settings = [one.fields for one in plan.settings]
    varied = _varied(settings, tuple(plan.settings[0].parameters))
    names = {
        one.key: _name(fields, (*varied, *_PLACE), one.trial.plans_with)
        + (", timed alone" if one.role == "timed" else "")
        for one, fields in zip(plan.settings, settings, strict=True)
    }
    return {
        key: f"{names[setting]}, seed {number}" if setting in names else key
        for key in keys
        for setting, _, number in (key.rpartition("#"),)
    }


def _varied(settings: Sequence[Mapping[str, Any]], names: Iterable[str]) -> list[str]:
    """Return the names in which settings differ; what an agent does not have is None there."""
    return [name for name in names if len({one[name] for one in settings} - {None}) > 1]


def _name(one: Mapping[str, Any], named: Iterable[str], model: PlanningModel | None) -> str:
    parts = [title_of(one["agent"]), *([] if model is None else [PLANNING_MODEL_TITLES[model]])]
    return ", ".join([*parts, *filter(None, (_value_name(one, name) for name in named))])


def _value_name(one: Mapping[str, Any], name: str) -> str:
    """Return a value in words; empty where there is nothing to tell."""
    value = one[name]
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
    return parameter_text(name, value, one["agent"])
