"""The gait analysis as a feature: a route, and a limit among the options."""

from collections.abc import Mapping, Sequence
from typing import Any

from fastapi import APIRouter

from app.feature import Feature
from app.features.gait_analysis import routes
from hexapods.runs.gait_analysis import MAX_WINDOW_S


class GaitAnalysisFeature(Feature):
    """The gait analysis of races and trainings."""

    name = "gait_analysis"

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router,)

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        del agents
        about = "How much of a walk is analysed at once, in seconds of robot time."
        return {
            "limits": {"gait_window_s": [0, MAX_WINDOW_S]},
            "help": {"gait_window_s": about},
        }


FEATURE = GaitAnalysisFeature
