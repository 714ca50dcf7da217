"""Changes of a training while it practises: live settings, disturbances, and presses."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from hexapods.arguments import check_names, plain, read_disturbance
from hexapods.domain.checks import check_whole
from hexapods.domain.disturbance_documents import as_mapping
from hexapods.domain.errors import InvalidInput
from hexapods.runs.config import TrainingConfig, changeable_settings
from hexapods.runs.presses import read_presses

LATER = "later_changes"
"""Field of a checkpoint's metadata: changes that are still to be made."""
_CHANGE = '{"step": 20, "settings": {"alpha": 0.1}}'


def read_changes(changes: Iterable[object], config: TrainingConfig) -> list[dict[str, Any]]:
    """Return changes that happen while a training runs, checked.

    Raises:
        InvalidInput: if one is none, or could not happen to this robot in this simulator.
    """
    if isinstance(changes, str | Mapping) or not isinstance(changes, Iterable):
        raise InvalidInput(f"changes is a list, such as [{_CHANGE}], not {changes!r}")
    live = {k: v for k, v in changeable_settings(config.agent).items() if k != "pace"}
    read: list[dict[str, Any]] = []
    world = config.world
    for change in changes:
        if not isinstance(change, Mapping) or "step" not in change:
            raise InvalidInput(f"a change is a mapping such as {_CHANGE}, not {change!r}")
        values = plain(change)
        check_names("a change", values, ("step", "settings", "disturbance", "presses"))
        settings = values.setdefault("settings", {})
        if not isinstance(settings, Mapping):
            raise InvalidInput(f"settings of a change are a mapping, as in {_CHANGE}")
        if settings and not live:
            raise InvalidInput(f"{config.agent} has no settings that change in practice")
        check_names(f"a change of {config.agent}", settings, live)
        check_whole(
            "step of a change", values["step"], read[-1]["step"] if read else 0, config.steps
        )
        if "disturbance" in values:
            values["disturbance"] = read_disturbance(values["disturbance"])
            # Also in `Learner.disturb`, but then what was practised before would be lost.
            world = world.then(replace(values["disturbance"], at_step=values["step"]))
            world.check(config.robot, config.simulator)
        if "presses" in values:
            values["presses"] = read_presses(values["presses"], config.agent)
        values["settings"] = {k: live[k].normalized(v) for k, v in plain(settings).items()}
        read.append(values)
    return read


def change_as_json(change: Mapping[str, Any]) -> dict[str, Any]:
    """Return a change in plain types; the inverse of `read_changes`."""
    if "disturbance" not in change:
        return dict(change)
    return {**change, "disturbance": as_mapping(change["disturbance"])}
