"""Tournaments as a feature: their services, routes, page and tables."""

from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from fastapi import APIRouter
from sqlalchemy import Column
from starlette.routing import BaseRoute

from app.answer import Answer
from app.api.deps import Services
from app.api.option_answers import SettingOption
from app.api.pages import page_content
from app.feature import DeleteRuns, Feature
from app.features.tournaments import pages, routes
from app.features.tournaments.access import ENTER_TOURNAMENT, WATCH_TOURNAMENT
from app.features.tournaments.judge import Judge
from app.features.tournaments.request_bodies import tournament_fields
from app.features.tournaments.room_directory import RoomDirectory
from app.features.tournaments.tables import METADATA, TOURNAMENTS
from app.features.tournaments.tournament import TournamentEvent
from app.features.tournaments.tournaments import Tournaments
from app.features.tournaments.views import publish
from app.settings import Settings
from app.storage.database.store import RunStore
from hexapods.machine import cores
from hexapods.runs.catalogue import setting_option

_BACKUP = "put a backup of the database back; without one the server goes on, and leaves them out"


class TournamentFeature(Feature):
    """Tournaments on secret draws.

    Attributes:
        tournaments: of the server.
        judge: judges their entries.
    """

    name = "tournaments"
    uses = ("classroom",)
    tables = METADATA
    migrations = Path(__file__).with_name("migrations")
    robot_users: ClassVar[Mapping[str, Sequence[Column[Any]]]] = {
        "tournament": (TOURNAMENTS.c.rules,)
    }
    damage_advice: ClassVar[Mapping[str, str]] = {
        "tournaments": _BACKUP,
        "tournament_entries": f"{_BACKUP}; where a tournament is open, enter again",
        "tournament_judgements": f"{_BACKUP}; where a tournament has not ended, they are judged "
        "again",
        "tournament_tables": f"{_BACKUP}; an entry that is not judged yet fails",
    }
    state_events = ("tournament",)
    event_bodies: ClassVar[Mapping[str, type[Answer]]] = {"tournament": TournamentEvent}
    option_types: ClassVar[Mapping[str, Any]] = {"tournament_fields": dict[str, SettingOption]}

    def __init__(self, core: Services) -> None:
        super().__init__(core)
        classroom: Any = core.features.get("classroom")
        self.rooms = core.provide(RoomDirectory(classroom))
        self.tournaments = core.provide(Tournaments(core.store))
        self.tournaments.on_changed = partial(publish, core.stages[0], self.rooms)
        self.judge = Judge(self.tournaments, max(1, cores() // 2), _niceness(core.settings))
        if classroom is not None:
            classroom.rooms.has_entered = self.tournaments.has_entered
            for access in (WATCH_TOURNAMENT, ENTER_TOURNAMENT):
                classroom.access.share(
                    access, lambda params: self.tournaments.room_of(params["tournament_id"])
                )
            classroom.rooms.tournaments_of = self.tournaments.of_room

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        return routes.router, routes.entry_routes(agents)

    def pages(self) -> Sequence[BaseRoute]:
        return pages.routes(
            page_content("features/tournaments/tournament.html", self.core.page_files)
        )

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        del agents
        fields = tournament_fields()
        return {"tournament_fields": {name: setting_option(s) for name, s in fields.items()}}

    @classmethod
    def read_rows(cls, store: RunStore) -> None:
        Tournaments(store)

    @asynccontextmanager
    async def open(self) -> AsyncIterator[None]:
        self.judge.start()
        yield

    def close(self) -> None:
        self.judge.close()

    def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> tuple[()]:
        """Delete the tournaments that rooms have left behind: their entrants were in these.

        Without the classroom it is not known which rooms there are, and all tournaments stay.
        """
        del delete_runs
        if (codes := self.rooms.codes()) is not None:
            self.tournaments.delete_left_behind(time, codes)
        return ()


def _niceness(settings: Settings) -> int:
    """Return the lowest priority, as people wait for trainings; that of jobs if they have ours."""
    return 19 if settings.job_niceness else 0


FEATURE = TournamentFeature
