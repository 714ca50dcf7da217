"""Archives as a feature: routes, and what the options say of them."""

from collections.abc import Mapping, Sequence
from typing import Any

from fastapi import APIRouter

from app.api.starts import StartKind
from app.feature import Feature
from app.features.archives import routes
from app.features.archives.transfer import MAX_RUNS


class Archives(Feature):
    """Export and import of runs as archives."""

    name = "archives"

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router,)

    @classmethod
    def routers_of_start(cls, start: StartKind) -> Sequence[APIRouter]:
        return (routes.export_routes(start.kind),)

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        del agents
        return {
            "limits": {"archive_runs": [1, MAX_RUNS]},
            "help": {"archive_runs": "How many runs one archive holds."},
        }


FEATURE = Archives
