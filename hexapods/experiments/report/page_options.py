"""Names, titles and colours that the report's page needs, as the dashboard's options have them."""

from collections.abc import Mapping
from typing import Any

from hexapods.agents.appearance import colors_of, title_of
from hexapods.agents.registry import BUILT_IN, is_loaded
from hexapods.domain.creatures import CREATURES
from hexapods.domain.gait import GAIT_TITLES
from hexapods.domain.robot import as_mapping
from hexapods.experiments.presets import PRESETS, Preset
from hexapods.experiments.published import GAITS
from hexapods.runs.best_known import COVERAGE, DEFINITION
from hexapods.runs.catalogue import (
    FIELD_TITLES,
    all_settings,
    disturbance_options,
    observation_options,
    setting_option,
    simulator_options,
    world_options,
)
from hexapods.runs.config import RACE_STEPS


def page_options(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of `GET /options` that the report's components use."""
    tried = (setting["agent"] for setting in summary["settings"])
    agents = list(dict.fromkeys((*BUILT_IN, *tried)))
    return {
        "agents": [
            {"name": name, "title": title_of(name), "color": color}
            for name, color in zip(agents, colors_of(agents), strict=True)
        ],
        "gaits": [{"name": name, "title": title} for name, title in GAIT_TITLES.items()],
        "robots": [
            {
                "name": creature.robot.name,
                "title": creature.title,
                "description": creature.description,
                "robot": as_mapping(creature.robot),
            }
            for creature in CREATURES.values()
        ],
        "observations": observation_options(),
        "simulators": simulator_options(),
        "worlds": world_options(),
        "disturbances": disturbance_options(),
        "settings": {
            name: setting_option(setting)
            for name, setting in all_settings([name for name in agents if is_loaded(name)]).items()
        },
        "experiments": [
            {"name": name, **result_options(preset)} for name, preset in PRESETS.items()
        ],
        "titles": FIELD_TITLES,
        "limits": {},
        "help": {"best_known": DEFINITION, "best_known_where": COVERAGE},
        "defaults": {"race": {"steps": RACE_STEPS}},
    }


def result_options(preset: Preset) -> dict[str, Any]:
    """Return the properties of a preset with which the components show its result."""
    return {
        "title": preset.title,
        "measure": preset.measure,
        "references": list(preset.references),
        "is_published": preset.is_published,
        "takes_settings": preset.takes_settings,
        "earning_steps": preset.earning_steps,
        "paper_gaits": dict(GAITS) if preset.is_published else {},
    }
