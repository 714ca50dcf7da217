"""From an experiment that a user asks for to a run that can be queued."""

import json
import math
import os
from collections.abc import Callable
from dataclasses import dataclass

from app.domain.errors import DamagedFile, InvalidInput
from app.experiments.config import GRID, ExperimentConfig
from app.experiments.plan import Plan
from app.runs.config import Walk
from app.services.entries import Entry, check_walk
from app.services.orders import ExperimentOrder
from app.services.store import SUMMARY, Run, RunStore

TITLES = {"table1": "Table 1", "figure4": "Figure 4", "sweep": "Sweep"}
MAX_WORKERS = 512
MAX_SETTINGS = 2_000
"""All of them are summarised again and again while trials come in, and drawn in one report."""


@dataclass(frozen=True)
class ExperimentStart:
    """An experiment as it was asked for.

    Attributes:
        config: the experiment.
        name: None lets one be found.
        workers: how many trials at once; None is one for each core.
    """

    config: ExperimentConfig
    name: str | None = None
    workers: int | None = None


def experiment_entry(start: ExperimentStart, new_id: Callable[[], str]) -> Entry:
    """An experiment, ready to be queued.

    Raises:
        InvalidInput, UnknownName, Unreachable: if it cannot be.
    """
    config, workers = start.config, start.workers
    plan = plan_of(config)
    cores = os.cpu_count() or 1
    if workers is not None and workers > cores:
        raise InvalidInput(f"workers must be from 1 to {cores}, the cores of this machine")
    seeds = "1 seed" if config.seeds == 1 else f"{config.seeds:,} seeds"
    run = Run(
        id=new_id(),
        kind="experiment",
        name=start.name or f"{TITLES[config.experiment]}, {seeds}",
        config=config,
        workers=workers,
        total=plan.total,
    )
    return Entry(run, lambda: ExperimentOrder(config, workers), set())


def plan_of(config: ExperimentConfig) -> Plan:
    """The settings of an experiment, all of which can be.

    Raises:
        InvalidInput, UnknownName, Unreachable: if one cannot be, or they are too many.
    """
    # Before it is laid out: a few long lists make a grid that fits into no memory.
    settings = _settings(config)
    if settings > MAX_SETTINGS:
        raise InvalidInput(
            f"the grid has {settings:,} settings, a server takes up to {MAX_SETTINGS:,}; choose "
            "fewer values, or use `hexapods sweep`"
        )
    plan = Plan(config)
    for walk in {_walk(setting.training) for setting in plan.settings}:
        check_walk(walk)
    return plan


def wall_s_of(store: RunStore, run_id: str) -> float:
    """How long an experiment has run by its newest summary.

    Raises:
        DamagedFile: if that does not say.
    """
    summary = store.artifact(run_id, SUMMARY)
    try:
        cost = None if summary is None else json.loads(summary).get("cost")
        return float(cost["wall_s"]) if cost else 0.0
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DamagedFile(f"{SUMMARY} of run {run_id} is no summary ({error!r})") from error


def _settings(config: ExperimentConfig) -> int:
    """How many combinations of values it has, those of agents that look ahead left out."""
    lists = ("gaits", "observations", "robots", "agents", *GRID)
    return math.prod(len(getattr(config, name)) for name in lists)


def _walk(walk: Walk) -> Walk:
    return Walk(**{name: getattr(walk, name) for name in Walk.__dataclass_fields__})
