"""The journal as a feature."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar

from fastapi import APIRouter

from app.feature import Feature
from hexapods_journal import routes
from hexapods_journal.tables import METADATA

_FOLDER = Path(__file__).parent


class Journal(Feature):
    """A lab journal beside the stage."""

    name = "journal"
    tables = METADATA
    migrations = _FOLDER / "migrations"
    page = _FOLDER / "page"
    damage_advice: ClassVar[Mapping[str, str]] = {
        "journal_entries": "put a backup of the database back"
    }

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        """Return the routes of the journal."""
        del agents
        return (routes.router,)
