"""The gait analysis as a feature: a route."""

from collections.abc import Sequence

from fastapi import APIRouter

from app.feature import Feature
from app.features.gait_analysis import routes


class GaitAnalysisFeature(Feature):
    """The gait analysis of races and trainings."""

    name = "gait_analysis"

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router,)


FEATURE = GaitAnalysisFeature
