"""Clean-up of a demo: stops visitors' runs that take too long, deletes what was made a day ago."""

import logging
import time
from collections.abc import Callable, Collection, Iterable
from datetime import UTC, datetime
from typing import Protocol

from app.demo.visitors import Visitors
from app.jobs.jobs import Jobs
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.run import NOT_ENDED
from hexapods.domain.errors import HexapodError

EVERY_S = 5.0
"""Period of the clean-up [s]."""
_ATTEMPTS, _PAUSE_S = 20, 0.5
"""Of an operator who ends a visitor: how often, and after how long again [s]."""
_OVERLONG = "Stopped after {seconds:g} s, for which a run of this demo may compute."
_logger = logging.getLogger(__name__)


class RoomCleaner(Protocol):
    """Rooms of classes, of which ended and forgotten ones are deleted."""

    def codes(self) -> Collection[str]:
        """Return the codes of all rooms."""

    def last_used_before(self, time: datetime) -> list[str]:
        """Return the codes of the rooms in which nothing has happened since."""

    def runs_in(self, code: str) -> list[str]:
        """Return the ids of a room's runs, those that were asked for last, first."""

    def forget(self, code: str) -> None:
        """End a room, and delete all that is known of it."""


class TournamentCleaner(Protocol):
    """Tournaments, of which those that rooms have left behind are deleted."""

    def left_behind(self, time: datetime, codes: Collection[str]) -> list[str]:
        """Return the ids of those opened by then in rooms other than these."""

    def delete(self, tournament_id: str) -> None:
        """Delete a tournament with its entries."""


class Expiry:
    """Deletes what visitors of a demo have made once it is a day old, with all that belongs to it.

    A run that another needs stays only while that one waits in the queue: when it starts, it has
    loaded what it needs. What has ended has its own recordings and tables, and loses nothing.
    """

    def __init__(
        self,
        store: RunStore,
        jobs: Jobs,
        visitors: Visitors,
        rooms: RoomCleaner | None,
        tournaments: TournamentCleaner,
        *,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
        now_s: Callable[[], float] = time.monotonic,
    ) -> None:
        """Clean up what is of these.

        Args:
            store: store of the runs.
            jobs: stops and deletes runs.
            visitors: whose runs are whose, and for how long.
            rooms: rooms of classes that do not outlive a day either; None to keep them, and their
                tournaments.
            tournaments: tournaments, whose entries are of those who were in a room.
            now: the clock, with time zone.
            now_s: monotonic clock [s].
        """
        self._store, self._jobs, self._visitors, self._rooms = store, jobs, visitors, rooms
        self._tournaments = tournaments
        self._now, self._now_s = now, now_s
        self._running_since_s: dict[str, float] = {}

    def sweep(self) -> list[str]:
        """Clean up once, and return the codes of the rooms that are gone.

        What fails is logged, and tried again by the next one.
        """
        before = self._now() - self._visitors.allowance.lifetime
        old = self._visitors.made_before(before)
        self._visitors.forget(self._deleted(one.run_id for one in old))
        gone = [] if self._rooms is None else self._sweep_rooms(self._rooms, before)
        try:
            self._store.keys.delete_expired()
            self._stop_overlong()
        except HexapodError as error:
            _logger.warning("the clean-up goes on later: %s", error)
        return gone

    def end_visitor(self, visitor_id: str) -> None:
        """Stop and delete all runs of a visitor, and forget its key.

        Raises:
            NotFound: if there is no such visitor.
            Conflict: if a run is kept, as one of others waits for it.
        """
        runs = sorted(self._visitors.runs_of(visitor_id), key=lambda one: one.is_main, reverse=True)
        left = [one.run_id for one in runs]
        for _ in range(_ATTEMPTS):
            gone = self._deleted(left)
            self._visitors.forget(gone)
            left = [one for one in left if one not in gone]
            if not left:
                return
            # A training that is stopped with its race has not ended yet.
            time.sleep(_PAUSE_S)
        raise Conflict(
            f"{len(left)} runs of the visitor are kept, as others wait for them or they are still "
            "ending; try again later",
            "queued",
        )

    def _sweep_rooms(self, rooms: RoomCleaner, before: datetime) -> list[str]:
        gone = []
        for code in rooms.last_used_before(before):
            ids = rooms.runs_in(code)
            if len(self._deleted(ids)) < len(ids):
                continue
            try:
                rooms.forget(code)
            except HexapodError as error:
                _logger.warning("the room %s is deleted later: %s", code, error)
            else:
                gone.append(code)
        for one in self._tournaments.left_behind(before, rooms.codes()):
            try:
                self._tournaments.delete(one)
            except HexapodError as error:
                _logger.warning("the tournament %s is deleted later: %s", one, error)
        return gone

    def _deleted(self, run_ids: Iterable[str]) -> Collection[str]:
        """Stop and delete runs, and return the ids of those that are gone."""
        gone = []
        for run_id in run_ids:
            try:
                if self._store.find(run_id).state in NOT_ENDED:
                    self._jobs.stop(run_id)
                self._jobs.delete(run_id)
            except NotFound:
                pass
            except HexapodError as error:
                _logger.warning("a run is deleted later: %s", error, extra={"run_id": run_id})
                continue
            gone.append(run_id)
        return gone

    def _stop_overlong(self) -> None:
        now_s, running = self._now_s(), self._visitors.running()
        self._running_since_s = {one: self._running_since_s.get(one, now_s) for one in running}
        longest_s = self._visitors.allowance.seconds_per_run
        for run_id, since_s in self._running_since_s.items():
            if now_s - since_s < longest_s:
                continue
            try:
                notes = self._jobs.stop(run_id).notes
                told = _OVERLONG.format(seconds=longest_s)
                self._jobs.annotate(run_id, {"notes": f"{notes}\n{told}".strip()})
            except (NotFound, Conflict):
                pass  # it has ended meanwhile
