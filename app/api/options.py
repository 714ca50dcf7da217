"""Route of the options: names, defaults, limits and help texts of all forms."""

import logging
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from app.answer import extended
from app.api.compression import CompressedContent
from app.api.deps import ServicesDep
from app.api.descriptions import MAX_RUN_IDS
from app.api.memory_limit import MAX_FILE_BYTES
from app.api.option_answers import DefaultsView, OptionsView
from app.api.option_texts import (
    CLOCK_TEXTS,
    FIELD_HELP,
)
from app.api.policy import ANY_PAGE, api_router, policy
from app.api.robot_options import built_in_options, gait_options, stored_options
from app.feature import Feature
from app.storage.database.robots import RobotStore
from app.storage.stored_robot import StoredRobot
from hexapods.agents.registry import learns
from hexapods.domain.creatures import CREATURES
from hexapods.domain.gait import NAMED_GAITS
from hexapods.domain.records import to_json
from hexapods.domain.robot import MAX_LEGS, MIN_LEGS, Robot
from hexapods.domain.settings import DeclaredSetting
from hexapods.domain.text import MAX_NAME, MAX_NOTES, MAX_TAG, MAX_TAGS
from hexapods.domain.world import MAX_DISTURBANCES
from hexapods.runs.catalogue import (
    FIELD_TITLES,
    agent_options,
    all_settings,
    described,
    disturbance_options,
    observation_options,
    setting_option,
    simulator_options,
    world_options,
)
from hexapods.runs.clocks import CLOCK_TITLES
from hexapods.runs.config import RACE_STEPS, training_config
from hexapods.runs.race_config import MAX_LANES
from hexapods.shows.scene_spec import PAPERS_LANES
from hexapods.version import __version__

_DEFAULTS = "defaults."

_logger = logging.getLogger(__name__)


def options_view(features: Iterable[type[Feature]]) -> type[OptionsView]:
    """Return the model of the options, with what features add to them."""
    types = [item for feature in features for item in feature.option_types.items()]
    defaults = {name: kind for name, kind in types if name.startswith(_DEFAULTS)}
    added = {name: kind for name, kind in types if name not in defaults}
    in_defaults = {name.removeprefix(_DEFAULTS): kind for name, kind in defaults.items()}
    return extended(OptionsView, {**added, "defaults": extended(DefaultsView, in_defaults)})


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


def catalogue(
    agents: Collection[str], robots: Iterable[StoredRobot] = (), robots_version: int = 0
) -> dict[str, Any]:
    """Return all options, defaults and limits, in plain types.

    Args:
        agents: names of the agents that were registered at server start.
        robots: those that are stored.
        robots_version: of the list of these.
    """
    settings = all_settings(agents)
    return {
        "version": __version__,
        "robots_version": robots_version,
        "gaits": [gait_options(name) for name in NAMED_GAITS],
        "robots": [*map(built_in_options, CREATURES.values()), *map(stored_options, robots)],
        "agents": agent_options(agents),
        "worlds": world_options(),
        "disturbances": disturbance_options(),
        "simulators": simulator_options(),
        "observations": observation_options(),
        "clocks": described(CLOCK_TEXTS, CLOCK_TITLES),
        "defaults": {"training": _training_defaults(), "race": _race_defaults()},
        "settings": {name: setting_option(setting) for name, setting in settings.items()},
        "limits": _limits(settings),
        "help": {name: setting.about.help for name, setting in settings.items()} | FIELD_HELP,
        "titles": FIELD_TITLES,
    }


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
