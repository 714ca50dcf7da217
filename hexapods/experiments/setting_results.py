"""Group an experiment's trial results by setting, with greedy's results as references."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from hexapods.experiments.plan import Plan, TrialSetting
from hexapods.experiments.statistics import Points, iqm
from hexapods.experiments.trial import TrialResult
from hexapods.runs.best_known import best_known_m

_MIN_WALK = 0.5
"""In half grid sides: a greedy agent that covers less in 50 steps is not used as a reference."""


class ReferenceDistance(NamedTuple):
    """Greedy's distances under the same conditions, and the best known one [m].

    Attributes:
        total_m: greedy's after its 50 steps; None if there is no result, or greedy hardly moved.
        finished_m: greedy's at time-out, when the first lane has used its 50 steps; None likewise.
        best_known_m: the best known distance of 50 steps; None where none was computed.
    """

    total_m: float | None = None
    finished_m: float | None = None
    best_known_m: float | None = None


class SettingResults(NamedTuple):
    """A setting, its results so far by seed number, and the reference distances."""

    setting: TrialSetting
    results: Mapping[int, TrialResult]
    reference: ReferenceDistance = ReferenceDistance()

    @property
    def succeeded(self) -> list[TrialResult]:
        """The results without a failure, ordered by seed number."""
        return [self.results[n] for n in sorted(self.results) if not self.results[n].failure]

    @property
    def conditions(self) -> tuple[Any, ...]:
        """The conditions under which agents are compared.

        (gait, observation, robot, divisions, grid side, world)
        """
        at = self.setting.training
        return (
            self.setting.gait,
            at.observation,
            self.setting.robot,
            at.divisions,
            at.grid_side_m,
            self.setting.world,
        )

    @property
    def parameters(self) -> tuple[Any, ...]:
        """The training parameters other than agent and conditions."""
        trial = self.setting.trial
        return (trial.blocks, trial.plans_with, self.setting.parameters)

    @property
    def best_known_m(self) -> float | None:
        """The best known distance in the world after the practice [m]; None if not computed."""
        training = self.setting.training
        return best_known_m(training, training.world.as_of(training.steps))

    @property
    def total_m(self) -> Points:
        """Each seed's distance over 50 steps, after the last block of practice [m]."""
        return tuple(result.distances_m[-1] for result in self.succeeded if result.distances_m)

    @property
    def seed_numbers(self) -> tuple[int, ...]:
        """Numbers of the seeds that have a distance, in the order of `total_m`."""
        return tuple(
            number
            for number in sorted(self.results)
            if not self.results[number].failure and self.results[number].distances_m
        )

    @property
    def finished_m(self) -> Points:
        """Each seed's distance at time-out, when the first lane has used its 50 steps [m]."""
        distances = (result.finished_distance_m for result in self.succeeded)
        return tuple(metres for metres in distances if metres is not None)


def group_by_setting(plan: Plan, results: Mapping[str, TrialResult]) -> list[SettingResults]:
    """Return every setting of the plan with its results and reference, in the plan's order.

    Results whose key is not in the plan are ignored.

    Args:
        plan: the experiment's settings.
        results: results of trials by trial key, `<setting key>#<seed number>`.
    """
    by_setting: dict[str, dict[int, TrialResult]] = {setting.key: {} for setting in plan.settings}
    for key, result in results.items():
        setting, _, number = key.rpartition("#")
        if setting in by_setting and int(number) < plan.config.seeds:
            by_setting[setting][int(number)] = result
    grouped = [SettingResults(setting, by_setting[setting.key]) for setting in plan.settings]
    references = {
        group.conditions: _reference(group)
        for group in grouped
        if group.setting.role == "reference"
        and group.setting.training.agent == "greedy"
        and group.setting.trial.plans_with is None
    }
    none = ReferenceDistance()
    return [group._replace(reference=references.get(group.conditions, none)) for group in grouped]


def _reference(greedy: SettingResults) -> ReferenceDistance:
    min_walk_m = _MIN_WALK * greedy.setting.training.grid_side_m / 2
    total, finished = (
        float(iqm(np.array(points))) if points else 0.0
        for points in (greedy.total_m, greedy.finished_m)
    )
    return ReferenceDistance(
        total if total > min_walk_m else None,
        finished if finished > min_walk_m else None,
        greedy.best_known_m,
    )


def setting_fields(results: SettingResults) -> dict[str, Any]:
    """Return the fields that identify a setting in a summary."""
    half_side_m = results.setting.training.grid_side_m / 2
    blocks = results.setting.trial.blocks
    return {**results.setting.fields, "blocks": blocks, "half_side_m": half_side_m}
