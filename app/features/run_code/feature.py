"""Runs as code as a feature: a route."""

from collections.abc import Sequence

from fastapi import APIRouter

from app.feature import Feature
from app.features.run_code import routes


class RunCode(Feature):
    """Runs as commands for a shell, and as Python programs."""

    name = "run_code"

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router,)


FEATURE = RunCode
