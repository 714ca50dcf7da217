"""Validate what a user asks of an experiment, and build the run to be queued."""

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from app.jobs.submissions import check_walk
from app.storage.database.store import RunStore
from app.storage.run import Run
from hexapods.domain.errors import InvalidInput
from hexapods.experiments.config import ExperimentConfig
from hexapods.experiments.names import experiment_name
from hexapods.experiments.plan import Plan
from hexapods.experiments.presets import GRID
from hexapods.runs.config import RACE_STEPS, TrainingConfig

MAX_SETTINGS = 2_000
"""All of them are summarised again and again while trials come in, and drawn in one report."""


@dataclass(frozen=True)
class ExperimentStart:
    """Request to start an experiment.

    Attributes:
        config: the experiment.
        name: None for a generated name.
        workers: trials at once; None is one per core.
    """

    config: ExperimentConfig
    name: str | None = None
    workers: int | None = None

    def runs(self, store: RunStore, new_id: Callable[[], str]) -> list[Run]:  # noqa: ARG002
        """See `Start`."""
        config, workers = self.config, self.workers
        plan = plan_of(config)
        cores = os.cpu_count() or 1
        if workers is not None and workers > cores:
            raise InvalidInput(f"workers must be from 1 to {cores}, the cores of this machine")
        experiment = Run(
            id=new_id(),
            kind="experiment",
            name=self.name or experiment_name(config),
            config=config,
            workers=workers,
            total=plan.total,
        )
        return [experiment]

    def practices(self) -> Iterator[tuple[TrainingConfig, int]]:
        """See `app.jobs.submissions.ManyPractices`."""
        plan = plan_of(self.config)
        for setting in plan.settings:
            trial, count = setting.trial, plan.count(setting)
            practised = trial.blocks * trial.training.steps
            walks = len(trial.evaluations) or max(trial.blocks, 1)
            yield trial.training, count * (practised + walks * RACE_STEPS)

    def at_once(self, cores: int) -> int:
        """See `app.jobs.submissions.ManyPractices`."""
        return max(1, min(self.workers or cores, plan_of(self.config).total))


def plan_of(config: ExperimentConfig) -> Plan:
    """Return the plan of an experiment, whose settings are all checked.

    Raises:
        InvalidInput, UnknownName, Unreachable: if a setting is invalid, or there are too many.
    """
    # Before it is laid out: a few long lists make a grid that fits into no memory.
    settings = _settings(config)
    if settings > MAX_SETTINGS:
        raise InvalidInput(
            f"the grid has {settings:,} settings, a server takes up to {MAX_SETTINGS:,}; choose "
            "fewer values, or use `hexapods sweep`"
        )
    plan = Plan(config)
    for walk in {setting.training.walk() for setting in plan.settings}:
        check_walk(walk)
    return plan


def _settings(config: ExperimentConfig) -> int:
    """Return the number of combinations of values, without those of look-ahead agents."""
    names = ("gaits", "observations", "robots", "worlds", "agents", *GRID)
    lists = [*(getattr(config, name) for name in names), *config.settings.values()]
    return math.prod(map(len, lists))
