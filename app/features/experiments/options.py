"""What `GET /options` says of experiments: their fields, defaults, limits and help."""

from collections.abc import Collection, Mapping
from typing import Any

from app.api.option_texts import SIMULATOR_TEXTS
from app.features.experiments.start import MAX_SETTINGS
from hexapods.domain.records import to_json
from hexapods.experiments.config import (
    EXPERIMENTS,
    GRID,
    MAX_SEEDS,
    MAX_TRIALS,
    ExperimentName,
    compares,
    experiment_config,
    fields_of,
    settings_by_name,
)
from hexapods.experiments.names import TITLES

EXPERIMENT_TEXTS = {
    "table1": (
        "The paper’s Table 1: Q-learning after 500 and after 1000 steps beside greedy and "
        "two-step, in all four gaits, with the feet measured and with the commands remembered."
    ),
    "figure4": (
        "The paper’s Figure 4: practice in blocks of 250 steps up to 2000, the table saved and "
        "loaded in between, beside as many steps in one go, and greedy as the line to reach."
    ),
    "sweep": (
        "A grid of any values: every combination is tried over all seeds. The paper names tuning "
        "as future work."
    ),
    "league": (
        "Learners and searchers in several worlds, with robots that differ a little by seed: "
        "distance against practice, beside greedy and the best known walk."
    ),
    "recovery": (
        "Learners practise, then something happens to them, and they learn on: how far they walk "
        "at once, and how soon they walk well again."
    ),
    "groups": (
        "Pairs of legs beside two groups of three: fewer groups have fewer states, 25 instead of "
        "125, and Q-learning comes level with greedy after 250 steps."
    ),
    "bodies": (
        "Learners on robots with other bodies, each in the gait that suits it: how far they walk, "
        "and how soon."
    ),
}
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
    for name in EXPERIMENTS:
        defaults = to_json(experiment_config(name, {}))
        others = _simulator_defaults(name, defaults)
        defaults["robots"] = [robot["preset"] for robot in defaults["robots"]]
        fields = [*fields_of(name), *(settings if name == "sweep" else ())]
        options.append(
            {
                "name": name,
                "title": TITLES[name],
                "description": EXPERIMENT_TEXTS[name],
                "fields": fields,
                "grid": [field for field in (GRID[0], *settings, *GRID[1:]) if field in fields],
                "defaults": defaults,
                "simulator_defaults": others,
                "agents": [one for one in agents if "agents" in fields and compares(name, one)],
            }
        )
    return options


def _simulator_defaults(
    name: ExperimentName, defaults: Mapping[str, Any]
) -> dict[str, dict[str, Any]]:
    """Return the defaults of an experiment that are others in a simulator, by simulator."""
    return {
        simulator: {
            field: value
            for field, value in to_json(experiment_config(name, {"simulator": simulator})).items()
            if field != "simulator" and value != defaults[field]
        }
        for simulator in SIMULATOR_TEXTS
    }
