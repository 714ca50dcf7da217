"""What experiments there are, with what each may be told, for people and forms."""

from typing import Any

from app.experiments.config import (
    EXPERIMENTS,
    GRID,
    MAX_SEEDS,
    MAX_TRIALS,
    as_json,
    experiment_config,
    fields_of,
)
from app.services.experiment_entry import MAX_SETTINGS, TITLES

_SAID = {
    "table1": (
        "The paper's Table 1: Q-learning after 500 and after 1,000 steps beside greedy and "
        "two-step, in all four gaits, for both readings of the state."
    ),
    "figure4": (
        "The paper's Figure 4: practice in blocks of 250 steps up to 2,000, the table saved and "
        "loaded in between, and greedy as the line to reach."
    ),
    "sweep": (
        "A grid of any values: every combination is tried over all seeds. The paper names tuning "
        "as future work."
    ),
}
HELP = {
    "seeds": "How often each setting is tried, each time with other random numbers.",
    "gaits": "Which gaits are tried.",
    "robots": "Which robots are tried.",
    "observations": "Which readings of the state are tried.",
    "agents": "Who learns, or looks ahead, and is compared with the others.",
    "settings": "Combinations of values; each is tried over all seeds.",
    "trials": "Settings times seeds; agents that look ahead are tried once.",
    "workers": "How many trials are computed at once; one for each core if nothing is said.",
}


def experiments() -> list[dict[str, Any]]:
    """Each with its name, title, a sentence, its defaults, and the fields that it takes."""
    shown = []
    for name in EXPERIMENTS:
        defaults = as_json(experiment_config(name, {}))
        defaults["robots"] = [robot["preset"] for robot in defaults["robots"]]
        fields = fields_of(name)
        shown.append(
            {
                "name": name,
                "title": TITLES[name],
                "description": _SAID[name],
                "fields": list(fields),
                "grid": [field for field in GRID if field in fields],
                "defaults": defaults,
            }
        )
    return shown


def experiment_limits() -> dict[str, list[float | None]]:
    """From and to, of what only experiments have."""
    return {"seeds": [1, MAX_SEEDS], "trials": [1, MAX_TRIALS], "settings": [1, MAX_SETTINGS]}
