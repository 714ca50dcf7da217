"""Clean-up of a demo: stops visitors' runs that take too long, and deletes runs of a day ago."""

import logging
import time
from collections.abc import Callable, Collection, Iterable, Sequence
from datetime import UTC, datetime
from typing import Protocol

from app.feature import DeleteRuns
from app.features.demo.visitors import Visitors
from app.jobs.jobs import Jobs
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound
from app.storage.run import NOT_ENDED
from hexapods.domain.errors import HexapodError

EVERY_S = 5.0
"""Period of the clean-up [s]."""
_ATTEMPTS, _PAUSE_S = 20, 0.5
"""Attempts to end a visitor for an operator, and the pause between them [s]."""
_OVERLONG = "Stopped after {seconds:g} s, for which a run of this demo may compute."
_logger = logging.getLogger(__name__)


class Cleaner(Protocol):
    """Deletes its own data once they are old, as a feature does."""

    def delete_before(self, time: datetime, delete_runs: DeleteRuns) -> Iterable[str]:
        """Delete data that was not used since a time; see `Feature.delete_before`."""


class Expiry:
    """Deletes the runs of visitors of a demo once they are a day old, with all of their data.

    A run that another needs stays only while that one waits in the queue: when it starts, it has
    loaded what it needs. What has ended has its own recordings and tables, and loses nothing.
    """

    def __init__(
        self,
        store: RunStore,
        jobs: Jobs,
        visitors: Visitors,
        cleaners: Sequence[Cleaner] = (),
        *,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
        now_s: Callable[[], float] = time.monotonic,
    ) -> None:
        """Use the services whose data are cleaned up.

        Args:
            store: store of the runs.
            jobs: stops and deletes runs.
            visitors: the visitors, with their runs and their allowance.
            cleaners: delete other data that are kept for as long.
            now: the clock, with time zone.
            now_s: monotonic clock [s].
        """
        self._store, self._jobs, self._visitors = store, jobs, visitors
        self._cleaners = cleaners
        self._now, self._now_s = now, now_s
        self._running_since_s: dict[str, float] = {}

    def sweep(self) -> list[list[str]]:
        """Clean up once; return for each cleaner the names of the things that it has deleted.

        Failures are logged; the next sweep tries again.
        """
        before = self._now() - self._visitors.allowance.lifetime
        old = self._visitors.made_before(before)
        self._visitors.forget(self._deleted(run.run_id for run in old))
        gone = [self._deleted_of(other, before) for other in self._cleaners]
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
            Conflict: if a run is kept, as a run of another visitor waits for it.
        """
        runs = sorted(self._visitors.runs_of(visitor_id), key=lambda run: run.is_main, reverse=True)
        left = [run.run_id for run in runs]
        for _ in range(_ATTEMPTS):
            gone = self._deleted(left)
            self._visitors.forget(gone)
            left = [run_id for run_id in left if run_id not in gone]
            if not left:
                return
            # A training that is stopped with its race has not ended yet.
            time.sleep(_PAUSE_S)
        raise Conflict(
            f"{len(left)} runs of the visitor are kept, as others wait for them or they are still "
            "ending; try again later",
            "queued",
        )

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

    def _deleted_of(self, other: Cleaner, before: datetime) -> list[str]:
        """Return the names of the things that a cleaner has deleted; none if it fails."""
        try:
            return list(other.delete_before(before, self._deleted))
        except Exception:  # runs of visitors are to be stopped all the same
            _logger.exception("%s deletes nothing now", type(other).__name__)
            return []

    def _stop_overlong(self) -> None:
        now_s, running = self._now_s(), self._visitors.running()
        self._running_since_s = {
            run_id: self._running_since_s.get(run_id, now_s) for run_id in running
        }
        longest_s = self._visitors.allowance.seconds_per_run
        for run_id, since_s in self._running_since_s.items():
            if now_s - since_s < longest_s:
                continue
            try:
                notes = self._jobs.stop(run_id).notes
                note = _OVERLONG.format(seconds=longest_s)
                self._jobs.annotate(run_id, {"notes": f"{notes}\n{note}".strip()})
            except (NotFound, Conflict):
                pass  # it has ended meanwhile
