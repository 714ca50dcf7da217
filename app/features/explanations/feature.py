"""Explanations as a feature: their service and routes."""

from collections.abc import Sequence

from fastapi import APIRouter

from app.api.deps import Services
from app.feature import Feature
from app.features.explanations import routes
from app.features.explanations.service import Explanations


class ExplanationFeature(Feature):
    """Explanations of steps, tables of any moment, and why a learner loses."""

    name = "explanations"

    def __init__(self, core: Services) -> None:
        super().__init__(core)
        service = Explanations(core.store, core.recordings, core.stopping)
        self._service = core.provide(service)

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return routes.runs, routes.trainings, routes.races

    def close(self) -> None:
        self._service.close()


FEATURE = ExplanationFeature
