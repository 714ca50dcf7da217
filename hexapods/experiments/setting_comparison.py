"""Settings of an experiment compared, by its summary alone."""

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any, Literal, get_args

import numpy as np

from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.text import counted
from hexapods.experiments.comparing import compare
from hexapods.experiments.comparison import Comparison, Group, Unit
from hexapods.experiments.names import setting_names
from hexapods.experiments.presets import preset_of
from hexapods.experiments.profiles import Profile, profile_of

Distance = Literal["total", "finished"]
"""`total`: after 50 steps of its own; `finished`: at time-out, when the first lane has used its."""
_MAX_LISTED = 24
"""Most settings that a message lists; of more those that are spelled most alike."""
_CONDITIONS = ("gait", "observation", "robot", "world", "divisions", "grid_side_m")


def compare_settings(
    summary: Mapping[str, Any],
    a: str,
    b: str,
    *,
    distance: Distance = "total",
    unit: Unit = "m",
    rng: np.random.Generator | None = None,
) -> Comparison:
    """Compare two settings of an experiment; settings whose seeds are the same are paired.

    Args:
        summary: of the experiment.
        a: key or name of the first setting, or a part of it that no other has.
        b: of the second setting.
        distance: which distance is compared.
        unit: of the distances.
        rng: generator of the resampling; that of the experiment's seed if there is none.

    Raises:
        UnknownName: if there is no such setting, distance or unit.
        InvalidInput: if the settings are one, or one of them has no such distance.
    """
    entries = [find_setting(summary, text) for text in (a, b)]
    if entries[0]["key"] == entries[1]["key"]:
        raise InvalidInput(f"a setting compared with itself, {entries[0]['key']}: name another one")
    names = names_of(summary, entries)
    first, second = (
        group_of(summary, entry, distance, unit, names[entry["key"]]) for entry in entries
    )
    return compare(
        first,
        second,
        rng or np.random.default_rng(summary["config"]["seed"]),
        unit=unit,
        is_at_time_out=distance == "finished",
    )


def profiles_of(
    summary: Mapping[str, Any],
    settings: Sequence[str] = (),
    *,
    distance: Distance = "total",
    unit: Unit = "m",
) -> tuple[Profile, ...]:
    """Return the performance profiles of some settings, or of all that have a distance.

    Raises:
        UnknownName, InvalidInput: as `compare_settings`.
    """
    entries = [find_setting(summary, text) for text in settings] or [
        entry for entry in summary["settings"] if entry[distance] is not None
    ]
    names = names_of(summary, entries)
    return tuple(
        profile_of(group_of(summary, entry, distance, unit, names[entry["key"]]))
        for entry in entries
    )


def find_setting(summary: Mapping[str, Any], text: str) -> Mapping[str, Any]:
    """Return the setting of a summary that a text means: its key or name, or a part of one.

    Raises:
        UnknownName: if there is none; the message lists keys.
        InvalidInput: if several have the part.
    """
    entries: Sequence[Mapping[str, Any]] = summary["settings"]
    names = names_of(summary)
    wanted = _plain(text)
    texts = [(entry, _plain(entry["key"]), _plain(names[entry["key"]])) for entry in entries]
    words = set(wanted.split(", "))
    for matching in (
        [entry for entry, key, name in texts if wanted in (key, name)],
        [entry for entry, key, name in texts if words <= {*key.split("/"), *name.split(", ")}],
        [entry for entry, key, name in texts if wanted and (wanted in key or wanted in name)],
    ):
        if len(matching) == 1:
            return matching[0]
        if matching:
            some = [entry["key"] for entry in matching[:_MAX_LISTED]]
            more = ", …" if len(matching) > len(some) else ""
            raise InvalidInput(
                f"{text!r} is a part of several settings: {', '.join(some)}{more}; name one of them"
            )
    keys = [entry["key"] for entry in entries]
    if len(keys) > _MAX_LISTED:
        keys = get_close_matches(text, keys, _MAX_LISTED, cutoff=0)
    raise UnknownName("setting", text, keys)


def _plain(text: str) -> str:
    """Return a text with plain spaces, in lower case."""
    return " ".join(text.split()).casefold()


def names_of(
    summary: Mapping[str, Any], entries: Sequence[Mapping[str, Any]] | None = None
) -> dict[str, str]:
    """Return the names of settings by key: the agent, and what differs among these settings.

    Args:
        summary: of the experiment.
        entries: the settings; all of the summary if there are none.
    """
    models = {entry["key"]: entry["plans_with"] for entry in summary.get("worlds", ())}
    chosen = summary["settings"] if entries is None else entries
    names = setting_names(
        chosen, summary["parameters"], {entry["key"]: models.get(entry["key"]) for entry in chosen}
    )
    return {key: name.replace("\u00a0", " ") for key, name in names.items()}


def group_of(
    summary: Mapping[str, Any], entry: Mapping[str, Any], distance: Distance, unit: Unit, name: str
) -> Group:
    """Return the seeds of a setting in a unit, with their numbers if other settings have the same.

    Raises:
        UnknownName: if there is no such distance or unit.
        InvalidInput: if the setting has no such distance yet, or no greedy to compare it with.
    """
    if distance not in get_args(Distance):
        raise UnknownName("distance", distance, get_args(Distance))
    distances = entry[distance]
    if distances is None:
        raise InvalidInput(_why_none(entry, distance))
    length = _length_of(summary, entry, unit, distance)
    points = tuple(float(point_m) / length for point_m in distances["points_m"])
    is_deterministic = _is_deterministic(entry)
    has_same_seeds = preset_of(summary["experiment"]).has_worlds and not is_deterministic
    numbers = seed_numbers(summary, entry) if has_same_seeds else None
    return Group(name, points, numbers, is_deterministic)


def _why_none(entry: Mapping[str, Any], distance: Distance) -> str:
    if entry["total"] is None:
        failed = f": {counted(entry['failed'], 'trial')} failed" if entry["failed"] else " yet"
        return f"no seed of {entry['key']} has a distance{failed}"
    return f"{entry['key']} has no distance {distance}, as it has no race; valid: total"


def _is_deterministic(entry: Mapping[str, Any]) -> bool:
    """Whether a setting comes equally far with every seed; summaries of old do not say so."""
    stored = entry.get("is_deterministic")
    return entry["role"] == "reference" and entry["n"] == 1 if stored is None else bool(stored)


def seed_numbers(summary: Mapping[str, Any], entry: Mapping[str, Any]) -> tuple[int, ...] | None:
    """Return the numbers of a setting's seeds; a summary of old has them if no seed is missing."""
    stored = entry.get("seed_numbers")
    if stored is not None:
        return tuple(stored)
    return tuple(range(entry["n"])) if entry["n"] == summary["config"]["seeds"] else None


def _length_of(
    summary: Mapping[str, Any], entry: Mapping[str, Any], unit: Unit, distance: Distance
) -> float:
    """Return the length of a unit [m]."""
    if unit == "m":
        return 1.0
    if unit == "h":
        return float(entry["half_side_m"])
    if unit != "greedy":
        raise UnknownName("unit", unit, get_args(Unit))
    greedy = next(
        (
            other
            for other in summary["settings"]
            if other["role"] == "reference"
            and other["agent"] == "greedy"
            and not other["key"].endswith("/nominal")
            and all(other.get(name) == entry.get(name) for name in _CONDITIONS)
        ),
        None,
    )
    metres = None if greedy is None or greedy[distance] is None else greedy[distance]["iqm_m"]
    if metres is None or metres <= 0:
        raise InvalidInput(
            f"greedy has not walked, or hardly moved, under the conditions of {entry['key']}; "
            "valid units: m, h"
        )
    return float(metres)
