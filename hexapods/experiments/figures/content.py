"""The numbers of a figure: its settings with every seed, and what is drawn of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hexapods.domain.errors import InvalidInput
from hexapods.experiments.comparison import Comparison, Group
from hexapods.experiments.figures.config import MAX_PROFILES, MAX_ROWS, FigureConfig
from hexapods.experiments.profiles import Profile, profile_of
from hexapods.experiments.setting_comparison import (
    compare_settings,
    find_setting,
    group_of,
    names_of,
    seed_numbers,
)
from hexapods.experiments.statistics import Interval, iqm_interval

UNIT_SIGNS: Mapping[str, str] = {"m": "m", "h": "half grid sides", "greedy": "share of greedy’s"}


@dataclass(frozen=True)
class Row:
    """A setting of a figure.

    Attributes:
        entry: its entry in the summary.
        group: its seeds in the figure's unit, named by what differs among the settings.
        numbers: of the seeds; None where the summary does not have them.
        typical: interquartile mean with its interval.
    """

    entry: Mapping[str, Any]
    group: Group
    numbers: tuple[int, ...] | None
    typical: Interval


@dataclass(frozen=True)
class FigureContent:
    """What a figure shows of an experiment.

    Attributes:
        summary: of the experiment.
        config: of the figure.
        rows: its settings.
        comparison: of the two settings of a comparison; None else.
    """

    summary: Mapping[str, Any]
    config: FigureConfig
    rows: Sequence[Row]
    comparison: Comparison | None

    @property
    def axis_title(self) -> str:
        """Name and unit of the axis of distances."""
        when = "at time-out" if self.config.distance == "finished" else "in 50 steps"
        return f"Distance {when} ({UNIT_SIGNS[self.config.unit]})"

    @property
    def profiles(self) -> list[Profile]:
        """Performance profiles of the settings."""
        return [profile_of(row.group) for row in self.rows]

    @property
    def best_known(self) -> float | None:
        """The best known distance, if it is the same for all settings and in metres."""
        distances = {row.entry.get("best_known_m") for row in self.rows}
        is_shown = self.config.unit == "m" and self.config.distance == "total"
        return distances.pop() if is_shown and len(distances) == 1 else None


def content_of(summary: Mapping[str, Any], config: FigureConfig) -> FigureContent:
    """Return what a figure shows.

    Raises:
        UnknownName, InvalidInput: if a setting is unknown, named twice or without a distance, or
            there are too many settings.
    """
    entries = _entries(summary, config)
    names = names_of(summary, entries)
    rows = []
    for entry in entries:
        group = group_of(summary, entry, config.distance, config.unit, names[entry["key"]])
        typical = iqm_interval((group.points,), summary["config"]["seed"])
        rows.append(Row(entry, group, seed_numbers(summary, entry), typical))
    comparison = None
    if config.kind == "comparison":
        a, b = (entry["key"] for entry in entries)
        comparison = compare_settings(
            summary,
            a,
            b,
            distance=config.distance,
            unit=config.unit,
            rng=np.random.default_rng(summary["config"]["seed"]),
        )
    return FigureContent(summary, config, rows, comparison)


def _entries(summary: Mapping[str, Any], config: FigureConfig) -> list[Mapping[str, Any]]:
    if config.settings:
        entries = [find_setting(summary, text) for text in config.settings]
    else:
        entries = [entry for entry in summary["settings"] if entry[config.distance] is not None]
    keys = [entry["key"] for entry in entries]
    twice = next((key for place, key in enumerate(keys) if key in keys[:place]), None)
    if twice is not None:
        raise InvalidInput(f"the setting {twice} is named twice", field="settings")
    if not entries:
        raise InvalidInput("no setting of the experiment has a distance yet", field="settings")
    most = MAX_PROFILES if config.kind == "profile" else MAX_ROWS
    if len(entries) > most:
        raise InvalidInput(
            f"a figure of {'profiles' if config.kind == 'profile' else 'seeds'} shows at most "
            f"{most} settings, not {len(entries)}: name some of {', '.join(keys)}",
            field="settings",
        )
    return entries
