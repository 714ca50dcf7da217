"""Titles, descriptions and limits of names and settings, collected from the registries.

The dashboard's options and the report of an experiment are made of these entries, all of plain
types.
"""

from collections.abc import Collection, Mapping
from dataclasses import MISSING, fields
from typing import Annotated, Any

from annotated_types import Ge, Le

from hexapods.agents.appearance import colors_of, description_of, title_of
from hexapods.agents.registry import (
    BUILT_IN,
    find,
    keeps_learning,
    learns,
    needs_practice,
    searches,
)
from hexapods.domain import disturbances
from hexapods.domain.disturbance_documents import SHORT_NAMES, as_mapping
from hexapods.domain.robot import MAX_LEGS
from hexapods.domain.settings import REQUIRED, DeclaredSetting, declare, declared_fields
from hexapods.domain.world import WORLDS, is_simulated
from hexapods.runs.config import (
    RACE_STEPS,
    TrainingConfig,
    agent_settings,
    changeable_settings,
)
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import MAX_LANES, MAX_RACE_STEPS, RaceConfig

OBSERVATION_TEXTS = {
    "measured": "Where the feet are, by the joint angles.",
    "commanded": "Where the feet were last sent; the body's drift is not seen.",
    "planned": "Where the feet would be if nothing had slipped, reckoned from the commands.",
}
SIMULATOR_TEXTS = {
    "mujoco": "Real physics: servos, contacts, friction.",
    "kinematic": "The law of a step without slip: exact, and very quick.",
}
SIMULATOR_TITLES = {"mujoco": "MuJoCo physics", "kinematic": "ideal (no slip)"}
FIELD_TITLES = {
    "gait": "Gait",
    "robot": "Robot",
    "robots": "Robots",
    "simulator": "Simulator",
    "agent": "Learner",
    "lanes": "Lanes",
    "name": "Name",
    "world": "World",
    "worlds": "Worlds",
    "disturb": "Disturbances",
    "tags": "Tags",
    "notes": "Notes",
}
"""Titles of the form fields that are no declared settings, by name."""
# The limit of a race with the maximum number of lanes.
_LANE_STEPS = Annotated[
    int, Ge(1), Le(MAX_RACE_STEPS // MAX_LANES), declared_fields(RaceConfig)["steps"].about
]
_SETTINGS = {
    **declared_fields(TrainingConfig),
    "race_steps": declare("race_steps", _LANE_STEPS, RACE_STEPS),
    **declared_fields(LaneConfig),
}
"""Declared settings that belong to no agent, by form field."""
_LEGS = declare("legs", Annotated[int, Ge(1), Le(MAX_LEGS), disturbances.LEGS], REQUIRED)
"""A leg in the list of those to which something happens."""


def all_settings(agents: Collection[str]) -> dict[str, DeclaredSetting]:
    """Return every setting by name, as the first agent that has it declares it."""
    settings = dict(_SETTINGS)
    for agent in agents:
        for name, setting in {**agent_settings(agent), **changeable_settings(agent)}.items():
            settings.setdefault(name, setting)
    return settings


def agent_options(names: Collection[str]) -> list[dict[str, Any]]:
    """Return agents with their settings, those that are built in first."""
    built_in = [name for name in BUILT_IN if name in names]
    ordered = [*built_in, *(name for name in names if name not in built_in)]
    return [
        {
            "name": name,
            "title": title_of(name),
            "description": description_of(name),
            "learns": learns(name),
            "searches": searches(name),
            "needs_practice": needs_practice(name),
            "keeps_learning": keeps_learning(name),
            "steps_ahead": getattr(find(name), "steps_ahead", None),
            "color": color,
            "settings": {n: setting_option(setting) for n, setting in agent_settings(name).items()},
            "live_settings": {
                n: setting_option(setting)
                for n, setting in changeable_settings(name).items()
                if n not in _SETTINGS
            },
        }
        for name, color in zip(ordered, colors_of(ordered), strict=True)
    ]


def world_options() -> list[dict[str, Any]]:
    """Return the named worlds."""
    return [
        {
            "name": name,
            "title": named.title,
            "description": named.help,
            "disturbances": [as_mapping(each) for each in named.world.disturbances],
        }
        for name, named in WORLDS.items()
    ]


def disturbance_options() -> list[dict[str, Any]]:
    """Return the kinds of disturbances with their fields."""
    return [
        {
            "name": name,
            "title": kind.title,
            "description": kind.help,
            "fields": _fields_of(kind),
            "size": kind.size,
            "nothing": kind.nothing,
            "lasts": kind.lasts,
            "identified_by": kind.identified_by,
            "part": kind.part,
            "repairs": kind.repairs,
            "adjective": kind.adjective or name,
            "simulators": [
                simulator for simulator in SIMULATOR_TEXTS if is_simulated(name, simulator)
            ],
        }
        for name, kind in disturbances.KINDS.items()
    ]


def _usual_choices(kind: type[disturbances.Disturbance], field: str) -> dict[str, Any]:
    """Return choices of a field on which limits depend: the joints of robots that are built in."""
    of_field = [usual.ranges for usual in kind.ranges.values() if usual.field == field]
    return {"choices": [*of_field[0]], "choice_titles": [*of_field[0]]} if of_field else {}


def _fields_of(kind: type[disturbances.Disturbance]) -> dict[str, dict[str, Any]]:
    """Return the fields of a kind of disturbance, its own before the steps."""
    declared = declared_fields(kind)  # type: ignore[arg-type]  # of a class, not of an instance
    options = {}
    short = {field: name for name, field in SHORT_NAMES.items()}
    for item in sorted(fields(kind), key=lambda field: field.name in ("at_step", "until_step")):
        setting = declared.get(item.name, _LEGS)
        is_list, is_required = setting is _LEGS, item.default is MISSING
        ranges = kind.ranges.get(item.name)
        options[item.name] = {
            **setting_option(setting),
            **_usual_choices(kind, item.name),
            "short": short.get(item.name, item.name),
            "is_list": is_list,
            "is_required": is_required,
            "ranges": None if ranges is None else ranges._asdict(),
        }
    return options


def simulator_options() -> list[dict[str, str]]:
    """Return the simulators."""
    return described(SIMULATOR_TEXTS, SIMULATOR_TITLES)


def observation_options() -> list[dict[str, str]]:
    """Return the observations."""
    setting = _SETTINGS["observation"]
    titles = dict(zip(setting.choices, setting.about.choice_titles, strict=True))
    return described(OBSERVATION_TEXTS, titles)


def described(sentences: Mapping[str, str], titles: Mapping[Any, str]) -> list[dict[str, str]]:
    """Return entries of name, title and description."""
    return [
        {"name": name, "title": titles[name], "description": sentence}
        for name, sentence in sentences.items()
    ]


def setting_option(setting: DeclaredSetting) -> dict[str, Any]:
    """Return a declared setting as the options have it."""
    about = setting.about
    return {
        "title": about.title,
        "symbol": about.symbol,
        "quantity": about.quantity,
        "unit": about.unit,
        "help": about.help,
        "valid": setting.valid,
        "minimum": setting.low,
        "maximum": setting.high,
        "excludes_minimum": setting.excludes_low,
        "excludes_maximum": setting.excludes_high,
        "is_number": setting.is_number,
        "is_boolean": bool in setting.kinds,
        "is_whole": setting.is_whole,
        "choices": setting.choices,
        "choice_titles": about.choice_titles or setting.choices,
        "default": None if setting.default is REQUIRED else setting.default,
        "is_live": about.live,
    }
