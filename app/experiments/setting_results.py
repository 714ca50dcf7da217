"""The settings of an experiment with the results that there are."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from app.experiments.config import GRID
from app.experiments.measures import Reference, Stratum
from app.experiments.plan import Plan, Setting
from app.experiments.statistics import Points
from app.experiments.trial import TrialResult

_LEAST_WALK = 0.5
"""Of half a grid side: a greedy agent that does not come so far in 50 steps is no yardstick."""


class SettingResults(NamedTuple):
    """A setting and the results that there are, by seed number."""

    setting: Setting
    results: Mapping[int, TrialResult]

    @property
    def good(self) -> list[TrialResult]:
        """Those that did not fail, by seed number."""
        return [self.results[n] for n in sorted(self.results) if not self.results[n].failure]

    @property
    def place(self) -> tuple[Any, ...]:
        """Where it is compared with others: (gait, observation, robot, divisions, side)."""
        at = self.setting.training
        return (
            self.setting.gait,
            at.observation,
            self.setting.robot,
            at.divisions,
            at.grid_side_m,
        )

    @property
    def rates(self) -> tuple[Any, ...]:
        """All of the practice but agent and place."""
        return (self.setting.trial.blocks, *(getattr(self.setting.training, n) for n in GRID))

    @property
    def total_m(self) -> Points:
        """How far each seed comes, after the last block."""
        return tuple(one.distances_m[-1] for one in self.good if one.distances_m)

    @property
    def finished_m(self) -> Points:
        """Where each seed is when the first agent has taken its 50 steps."""
        found = (one.finished_distance_m for one in self.good)
        return tuple(metres for metres in found if metres is not None)


def sorted_out(plan: Plan, results: Mapping[str, TrialResult]) -> list[SettingResults]:
    """Every setting of a plan with its results; those of other plans are left out."""
    found: dict[str, dict[int, TrialResult]] = {setting.key: {} for setting in plan.settings}
    for key, result in results.items():
        setting, _, number = key.rpartition("#")
        if setting in found and int(number) < plan.config.seeds:
            found[setting][int(number)] = result
    return [SettingResults(setting, found[setting.key]) for setting in plan.settings]


def yardsticks_of(seen: Sequence[SettingResults]) -> dict[Any, Reference]:
    """How far greedy comes, by place."""
    return {
        one.place: _yardstick(one)
        for one in seen
        if one.setting.role == "reference" and one.setting.training.agent == "greedy"
    }


def stratum(one: SettingResults, yardsticks: Mapping[Any, Reference]) -> Stratum:
    """A setting's seeds beside greedy."""
    return Stratum(one.total_m, one.finished_m, yardsticks.get(one.place, Reference()))


def _yardstick(greedy: SettingResults) -> Reference:
    least_m = _LEAST_WALK * greedy.setting.training.grid_side_m / 2
    total = next((metres for metres in greedy.total_m if metres > least_m), None)
    finished = next((metres for metres in greedy.finished_m if metres > least_m), None)
    return Reference(total, finished)


def named(one: SettingResults) -> dict[str, Any]:
    """What tells a setting from the others; an agent that looks ahead has no rates."""
    at = one.setting.training
    practises = one.setting.role == "learner"
    rates = {name: getattr(at, name) if practises else None for name in GRID}
    return {
        "gait": one.setting.gait,
        "observation": at.observation,
        "robot": one.setting.robot,
        "agent": at.agent,
        **rates,
        "steps": at.steps if practises else 0,
        "blocks": one.setting.trial.blocks,
        "divisions": at.divisions,
        "grid_side_m": at.grid_side_m,
        "half_side_m": at.grid_side_m / 2,
    }
