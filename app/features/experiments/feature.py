"""Experiments as a feature: a kind of run, its routes, table and options."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from fastapi import APIRouter

from app.answer import Answer
from app.api.policy import OPERATOR
from app.api.starts import StartKind
from app.feature import Feature
from app.features.experiments import comparison_routes, routes
from app.features.experiments.options import (
    FIELD_HELP,
    FIELD_TITLES,
    LIMITS,
    experiment_options,
)
from app.features.experiments.request_bodies import experiment_body
from app.features.experiments.response_models import (
    ExperimentOption,
    ExperimentView,
    SummaryEvent,
)
from app.features.experiments.tables import METADATA


class ExperimentFeature(Feature):
    """Experiments over many seeds. Operators alone start them, as they take all cores."""

    name = "experiments"
    tables = METADATA
    migrations = Path(__file__).with_name("migrations")
    damage_advice: ClassVar[Mapping[str, str]] = {
        "trials": "delete these experiments, or put a backup back"
    }
    event_bodies: ClassVar[Mapping[str, type[Answer]]] = {"summary": SummaryEvent}
    option_types: ClassVar[Mapping[str, Any]] = {"experiments": list[ExperimentOption]}

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router, comparison_routes.router)

    @classmethod
    def start_kinds(cls, agents: tuple[str, ...]) -> Sequence[StartKind]:
        experiment = StartKind(
            "experiment",
            experiment_body(agents),
            "an experiment over many seeds",
            "Queue an experiment, and return its run.",
            ExperimentView,
            OPERATOR,
        )
        return (experiment,)

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        return {
            "experiments": experiment_options(agents),
            "limits": LIMITS,
            "help": FIELD_HELP,
            "titles": FIELD_TITLES,
        }


FEATURE = ExperimentFeature
