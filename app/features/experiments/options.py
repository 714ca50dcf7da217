"""What `GET /options` says of experiments: their fields, defaults, limits and help."""

from collections.abc import Collection, Mapping
from typing import Any

from app.features.experiments.start import MAX_SETTINGS
from hexapods.domain.records import to_json
from hexapods.experiments.config import (
    MAX_SEEDS,
    MAX_TRIALS,
    compares,
    experiment_config,
    settings_by_name,
)
from hexapods.experiments.presets import GRID, PRESETS
from hexapods.experiments.report.page_options import result_options
from hexapods.runs.catalogue import SIMULATOR_TEXTS

LIMITS = {"seeds": [1, MAX_SEEDS], "trials": [1, MAX_TRIALS], "settings": [1, MAX_SETTINGS]}
FIELD_HELP = {
    "seeds": "How often each setting is tried, each time with other random numbers.",
    "gaits": "Which gaits are tried.",
    "robots": "Which robots are tried.",
    "observations": "Which observations are tried.",
    "worlds": "Which worlds are tried.",
    "agents": "Which agents learn or search, and are compared with each other.",
    "settings": "Combinations of values; each is tried over all seeds.",
    "trials": "Settings times seeds; agents that look ahead are tried once.",
    "workers": "How many trials are computed at once; by default one for each core.",
}
FIELD_TITLES = {
    "gaits": "Gaits",
    "observations": "Observation",
    "agents": "Agents",
    "experiment": "Experiment",
    "seeds": "Seeds",
}


def experiment_options(agents: Collection[str]) -> list[dict[str, Any]]:
    """Return the experiments, each with title, description, defaults and fields."""
    settings = settings_by_name(agents)
    options = []
    for name, preset in PRESETS.items():
        defaults = to_json(experiment_config(name, {}))
        simulator_defaults = _simulator_defaults(name, defaults)
        defaults["robots"] = [robot["preset"] for robot in defaults["robots"]]
        fields = [*preset.fields, *(settings if preset.takes_settings else ())]
        options.append(
            {
                "name": name,
                "description": preset.description,
                "fields": fields,
                "grid": [field for field in (GRID[0], *settings, *GRID[1:]) if field in fields],
                "defaults": defaults,
                "simulator_defaults": simulator_defaults,
                "agents": [a for a in agents if "agents" in fields and compares(preset, a)],
                "about": preset.about or preset.description,
                "is_timed": preset.is_timed,
                **result_options(preset),
            }
        )
    return options


def _simulator_defaults(name: str, defaults: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the defaults of an experiment that are others in a simulator, by simulator."""
    return {
        simulator: {
            field: value
            for field, value in to_json(experiment_config(name, {"simulator": simulator})).items()
            if field != "simulator" and value != defaults[field]
        }
        for simulator in SIMULATOR_TEXTS
    }
