"""Reads what versions before 0.2 wrote: an agent's settings beside the fields of a config.

They are a member of their own, `settings`, since. The names of the fields are those of that time,
so that fields of later versions change nothing here.
"""

from collections.abc import Collection, Mapping
from typing import Any

_WALK = ("gait", "robot", "simulator", "divisions", "grid_side_m", "tolerance", "disturbances")
_TRAINING = (
    *_WALK,
    *("steps", "seed", "observation", "steps_per_episode", "evaluate_every", "pace", "agent"),
)
_LANE = ("agent", "observation", "keep_learning", "plans_with")
_EXPERIMENT = (
    *("experiment", "seeds", "seed", "agents", "gaits", "observations", "robots", "simulator"),
    *("steps", "steps_per_episode", "divisions", "grid_side_m", "blocks", "worlds", "tolerance"),
    # Of a tuning.
    *("candidates", "search_seeds", "objective", "ranges"),
)
_CHANGE = ("step", "pace", "disturbance")


def nested_config(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return the config of a training, a race or an experiment with its settings as a member."""
    if "lanes" in config:
        return {**config, "lanes": [_nested(lane, _LANE) for lane in config["lanes"]]}
    return _nested(config, _EXPERIMENT if "experiment" in config else _TRAINING)


def nested_change(change: Mapping[str, Any]) -> dict[str, Any]:
    """Return a change of a training that ran with the settings as a member, if it has any."""
    nested = _nested(change, _CHANGE)
    return nested if nested["settings"] else {k: v for k, v in nested.items() if k != "settings"}


def _nested(data: Mapping[str, Any], fields: Collection[str]) -> dict[str, Any]:
    own = {name: value for name, value in data.items() if name in fields}
    return {**own, "settings": {k: v for k, v in data.items() if k not in fields}}
