"""The shell command that repeats an experiment."""

import json
import shlex
from collections.abc import Mapping
from typing import Any

from hexapods.domain.records import to_json
from hexapods.experiments.config import (
    ExperimentConfig,
    by_option,
    default_agents,
    experiment_config,
)
from hexapods.experiments.presets import PRESETS

_FIRST = (
    "agents",
    "gaits",
    "observations",
    "robots",
    "seeds",
    "seed",
    "simulator",
    "worlds",
    "tolerance",
    "reward",
)
"""Fields whose options come first in a command, in order."""


def command(config: Mapping[str, Any]) -> str:
    """Return the shell command of an experiment: its seeds and all options other than defaults."""
    name, chosen = config["experiment"], by_option(config)
    options: dict[str, Any] = {"simulator": config["simulator"]}
    if "agents" in PRESETS[name].fields:
        options["agents"] = tuple(config["agents"])
    usual = {"agents": list(default_agents(PRESETS[name])), "simulator": ExperimentConfig.simulator}
    defaults = by_option(to_json(experiment_config(name, options))) | usual
    arguments = ["hexapods", *PRESETS[name].command.split()]
    for field in dict.fromkeys((*_FIRST, *chosen)):
        if field in chosen and (field in ("seeds", "seed") or chosen[field] != defaults.get(field)):
            option = ExperimentConfig.option_of(field)
            arguments += [part for text in option_values(chosen[field]) for part in (option, text)]
    return shlex.join(arguments)


def option_values(value: Any) -> list[str]:
    """Return an option's arguments: one comma-separated list, or each alone if one is JSON."""
    values = value if isinstance(value, list) else [value]
    plain = [_as_word(value) for value in values]
    if None not in plain:
        return [",".join(map(str, plain))]
    return [word or json.dumps(value) for word, value in zip(plain, values, strict=True)]


def _as_word(value: Any) -> str | None:
    """Return a value as a plain word, or None if it can only be written as JSON."""
    if isinstance(value, Mapping):
        return str(value["preset"]) if set(value) == {"preset"} else None
    return str(value)
