"""Route of the options: names, defaults, limits and help texts of all forms."""

import logging
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import MISSING, fields
from functools import lru_cache
from typing import Annotated, Any, TypeVar

from annotated_types import Ge, Le
from fastapi import APIRouter, Request
from pydantic import create_model
from starlette.responses import JSONResponse, Response

from app.api.answers import Answer
from app.api.compression import CompressedContent
from app.api.deps import ServicesDep
from app.api.descriptions import MAX_RUN_IDS
from app.api.memory_limit import MAX_FILE_BYTES
from app.api.option_answers import DefaultsView, OptionsView
from app.api.option_texts import (
    CLOCK_TEXTS,
    FIELD_HELP,
    FIELD_TITLES,
    OBSERVATION_TEXTS,
    SIMULATOR_TEXTS,
    SIMULATOR_TITLES,
)
from app.api.policy import ANY_PAGE, api_router, policy
from app.api.robot_options import built_in_options, gait_options, stored_options
from app.feature import Feature
from app.storage.database.robots import RobotStore
from app.storage.stored_robot import StoredRobot
from hexapods import __version__
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
from hexapods.domain.creatures import CREATURES
from hexapods.domain.disturbance_documents import SHORT_NAMES, as_mapping
from hexapods.domain.gait import NAMED_GAITS
from hexapods.domain.records import to_json
from hexapods.domain.robot import MAX_LEGS, MIN_LEGS, Robot
from hexapods.domain.settings import REQUIRED, DeclaredSetting, declare, declared_fields
from hexapods.domain.text import MAX_NAME, MAX_NOTES, MAX_TAG, MAX_TAGS
from hexapods.domain.world import MAX_DISTURBANCES, WORLDS, is_simulated
from hexapods.runs.clocks import CLOCK_TITLES
from hexapods.runs.config import (
    RACE_STEPS,
    TrainingConfig,
    agent_settings,
    changeable_settings,
    training_config,
)
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import MAX_LANES, MAX_RACE_STEPS, RaceConfig
from hexapods.shows.scene_spec import PAPERS_LANES

A = TypeVar("A", bound=Answer)
_DEFAULTS = "defaults."

_logger = logging.getLogger(__name__)


def options_view(features: Iterable[type[Feature]]) -> type[OptionsView]:
    """Return the model of the options, with what features add to them."""
    types = [item for feature in features for item in feature.option_types.items()]
    defaults = [(name, kind) for name, kind in types if name.startswith(_DEFAULTS)]
    added = [item for item in types if item not in defaults]
    in_defaults = [(name.removeprefix(_DEFAULTS), kind) for name, kind in defaults]
    return _extended(OptionsView, [*added, ("defaults", _extended(DefaultsView, in_defaults))])


def _extended(model: type[A], members: Iterable[tuple[str, Any]]) -> type[A]:
    """Return a model of the same name with further members."""
    fields: dict[str, Any] = {name: (kind, ...) for name, kind in members}
    return create_model(model.__name__, __base__=model, __doc__=model.__doc__, **fields)


def option_routes(features: Sequence[type[Feature]]) -> APIRouter:
    """Return the route of the options, with what features add to them."""
    router = api_router(prefix="/options", tags=["options"])
    view = options_view(features)

    @router.get(
        "",
        response_model=view,
        summary="List gaits, robots, agents and clocks; defaults, limits and help",
    )
    @policy(access=ANY_PAGE)
    def get_options(services: ServicesDep, request: Request) -> Response:
        """Return the options, defaults, limits and help texts of all forms."""
        robots, features = services.store.robots, services.features.classes
        content = _content(services.agents, features, robots, robots.version)
        return content.response(request.scope)

    return router


@lru_cache(maxsize=2)
def _content(
    agents: tuple[str, ...],
    features: tuple[type[Feature], ...],
    robots: RobotStore,
    version: int,
) -> CompressedContent:
    """Return the answer compressed: it is most of what a first visit transfers, and no secret.

    Args:
        agents: names of the agents that were registered at server start.
        features: those of the server.
        robots: the stored ones.
        version: of their list.
    """
    answer = catalogue(agents, robots.readable(hidden=True), version)
    for feature in features:
        try:
            options = feature.options(agents)
            # Limits and texts of a feature stand with those of the core.
            answer |= {
                name: {**answer[name], **added} if name in answer else added
                for name, added in options.items()
            }
        except Exception:  # every page needs the others
            _logger.exception("the feature %s has no options", feature.name)
    return CompressedContent(bytes(JSONResponse(answer).body), "application/json")


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


def catalogue(
    agents: Collection[str], robots: Iterable[StoredRobot] = (), robots_version: int = 0
) -> dict[str, Any]:
    """Return all options, defaults and limits, in plain types.

    Args:
        agents: names of the agents that were registered at server start.
        robots: those that are stored.
        robots_version: of the list of these.
    """
    settings = _all_settings(agents)
    return {
        "version": __version__,
        "robots_version": robots_version,
        "gaits": [gait_options(name) for name in NAMED_GAITS],
        "robots": [*map(built_in_options, CREATURES.values()), *map(stored_options, robots)],
        "agents": _agents(agents),
        "worlds": _worlds(),
        "disturbances": _disturbances(),
        "simulators": _described(SIMULATOR_TEXTS, SIMULATOR_TITLES),
        "observations": _described(OBSERVATION_TEXTS, _choice_titles("observation")),
        "clocks": _described(CLOCK_TEXTS, CLOCK_TITLES),
        "defaults": {"training": _training_defaults(), "race": _race_defaults()},
        "settings": {name: setting_option(setting) for name, setting in settings.items()},
        "limits": _limits(settings),
        "help": {name: setting.about.help for name, setting in settings.items()} | FIELD_HELP,
        "titles": FIELD_TITLES,
    }


def _all_settings(agents: Collection[str]) -> dict[str, DeclaredSetting]:
    """Return every setting by name, as the first agent that has it declares it."""
    settings = dict(_SETTINGS)
    for agent in agents:
        for name, setting in {**agent_settings(agent), **changeable_settings(agent)}.items():
            settings.setdefault(name, setting)
    return settings


def _agents(names: Collection[str]) -> list[dict[str, Any]]:
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


def _worlds() -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            "title": named.title,
            "description": named.help,
            "disturbances": [as_mapping(each) for each in named.world.disturbances],
        }
        for name, named in WORLDS.items()
    ]


def _disturbances() -> list[dict[str, Any]]:
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


def _described(sentences: Mapping[str, str], titles: Mapping[Any, str]) -> list[dict[str, str]]:
    return [
        {"name": name, "title": titles[name], "description": sentence}
        for name, sentence in sentences.items()
    ]


def _choice_titles(field: str) -> dict[str, str]:
    setting = _SETTINGS[field]
    return dict(zip(setting.choices, setting.about.choice_titles, strict=True))


def _training_defaults() -> dict[str, Any]:
    config = to_json(training_config(gait=next(iter(NAMED_GAITS))))
    return {**config, "robot": Robot().name}


def _race_defaults() -> dict[str, Any]:
    lanes = [{"agent": name, **({"training": {}} if learns(name) else {})} for name in PAPERS_LANES]
    return {"steps": RACE_STEPS, "seed": 0, "lanes": lanes}


def _limits(settings: Mapping[str, DeclaredSetting]) -> dict[str, list[float | None]]:
    return {
        **{
            name: [setting.low, setting.high]
            for name, setting in settings.items()
            if setting.is_number
        },
        "lanes": [1, MAX_LANES],
        "legs": [MIN_LEGS, MAX_LEGS],
        "disturbances": [0, MAX_DISTURBANCES],
        "name": [0, MAX_NAME],
        "tag": [1, MAX_TAG],
        "tags": [0, MAX_TAGS],
        "notes": [0, MAX_NOTES],
        "import_bytes": [1, MAX_FILE_BYTES],
        "run_ids": [1, MAX_RUN_IDS],
    }


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
