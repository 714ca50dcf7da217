"""The visitors of a demo: starts runs within their allowance, and stores the runs' visitors.

All is written to the database before it counts. Addresses are in memory alone.
"""

import hashlib
import secrets
import threading
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from typing import NamedTuple

from app.features.demo.allowance import HOUR, Allowance
from app.features.demo.rows import VisitorRows, VisitorRun
from app.jobs.linked_start import LinkedStart
from app.jobs.queue import Owner
from app.jobs.submissions import Start
from app.limits.token_bucket import RateLimiter
from app.storage.database.store import RunStore
from app.storage.errors import Forbidden, NotFound
from app.storage.run import INTERRUPTED, NOT_ENDED, RUNNING, Run
from hexapods.domain.errors import HexapodError
from hexapods.runs.race_config import RaceConfig

ID_LENGTH = 12
"""Letters of the hash by which operators call a visitor."""
MIN_SECRET = 16
"""Minimum length of an idempotency key that counts as a secret, which proves who owns a run."""
_MAX_CLOCK_LEAD = timedelta(days=1)
"""A run made later than so long from now has a damaged time, or the clock was set back."""


class Use(NamedTuple):
    """Steps and runs that a visitor has used of the allowance.

    Attributes:
        steps: steps of the starts within the last hour.
        unended: starts that wait or go on.
        kept: ids of the runs that are kept, oldest first.
        oldest: time at which the oldest of them was made; None without one.
    """

    steps: int = 0
    unended: int = 0
    kept: tuple[str, ...] = ()
    oldest: datetime | None = None


class Started(NamedTuple):
    """A run that was started, and the key of its visitor, for the cookie."""

    run: Run
    key: str


class Visitors:
    """All visitors of a demo. Thread-safe; `owner_of` takes no lock, as the queue calls it."""

    def __init__(
        self,
        store: RunStore,
        allowance: Allowance,
        *,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        """Load the runs of all visitors.

        Args:
            store: store of the runs, in whose database the visitors are.
            allowance: limits of each visitor.
            now: the clock, with time zone.

        Raises:
            StorageFailed: if they cannot be read.
        """
        self.allowance = allowance
        self.is_hidden: Callable[[str | None], bool] = lambda run_id: False  # noqa: ARG005
        """Whether a run of others is hidden, so that nothing may be started from it."""
        self._store, self._rows, self._now = store, VisitorRows(store.database), now
        self._lock = threading.RLock()
        self._runs: dict[str, VisitorRun] = {}
        self._by_visitor: defaultdict[str, dict[str, VisitorRun]] = defaultdict(dict)
        for run in self._rows.all():
            self._add(run)
        self._addresses: dict[str, str] = {}
        """Newest address of each visitor since the server started."""
        per_hour = allowance.steps_per_hour_of_address
        self._of_address = RateLimiter(
            per_hour, per_hour / HOUR.total_seconds(), lambda: now().timestamp()
        )

    # ---- owners of runs

    def is_known(self, key: str) -> bool:
        """Whether a key is that of a visitor with runs that are kept or counted."""
        return bool(key) and _sha256(key) in self._by_visitor

    def owner_of(self, run_id: str) -> Owner | None:
        """Return the visitor who started a run, as its owner in the queue; None if none did."""
        run = self._runs.get(run_id)
        if run is None:
            return None
        group = self._addresses.get(run.visitor, run.visitor)
        return Owner(run.visitor, group, is_guest=True)

    def owns(self, key: str, run_id: str) -> bool:
        """Whether a run is of the visitor with a key; also if it was deleted."""
        run = self._runs.get(run_id)
        return bool(key) and run is not None and run.visitor == _sha256(key)

    def by_visitor(self) -> dict[str, list[VisitorRun]]:
        """Return the runs by visitor, by the beginning of its hash, oldest first."""
        with self._lock:
            return {
                visitor[:ID_LENGTH]: list(runs.values())
                for visitor, runs in self._by_visitor.items()
            }

    def runs_of(self, visitor_id: str) -> list[VisitorRun]:
        """Return the runs of a visitor, by the beginning of its hash.

        Raises:
            NotFound: if there is no such visitor.
        """
        runs = self.by_visitor().get(visitor_id)
        if runs is None:
            raise NotFound(
                f"there is no visitor {visitor_id[:20]!r}; GET /api/v1/visitors lists all"
            )
        return runs

    @property
    def count(self) -> int:
        """Number of visitors with runs that are kept or counted."""
        return len(self._by_visitor)

    # ---- starting

    def use(self, key: str) -> Use:
        """Return the steps and runs that a visitor has used; none if no visitor has the key."""
        return self._use(_sha256(key)) if self.is_known(key) else Use()

    def start(
        self,
        key: str,
        address: str,
        start: Start,
        queue: Callable[[Start], Run],
        request_key: str | None = None,
    ) -> Started:
        """Queue a start of a visitor; one who is not known by the key is a new one.

        The key of a new one follows from the idempotency key, if that is a secret: else nobody
        could show to be the visitor whose first answer was lost, and with it the cookie.

        Args:
            key: key of the cookie; "" without one.
            address: address of the client, which is not stored.
            start: makes the runs.
            queue: queues them.
            request_key: idempotency key of the request; None without one.

        Raises:
            Busy: if the allowance is used up; it says when it is not any more.
            Forbidden, InvalidInput: if a visitor may not start this.
        """
        with self._lock:
            if not self.is_known(key):
                key = _key_of(request_key) or secrets.token_urlsafe(32)
            visitor = _sha256(key)
            linked = LinkedStart(start, lambda runs: self._link(visitor, address, runs))
            try:
                run = queue(linked)
            except BaseException:
                self.forget(linked.links)
                raise
            self._of_address.charge(
                address, sum(self._runs[linked_id].steps for linked_id in linked.links)
            )
        return Started(run, key)

    def claim(self, key: str, request_key: str | None, run_id: str) -> str:
        """Return the key of the visitor who repeats a start, if the run is theirs; else "".

        A run of a first start is of who repeats it with its idempotency key. One who has become
        another visitor meanwhile, as the cookie of that start was lost, is given it.

        Args:
            key: key of the cookie; "" without one.
            request_key: idempotency key of the request; None without one.
            run_id: id of the run that was made by the first of these requests.
        """
        requested = _key_of(request_key)
        with self._lock:
            if self.owns(key, run_id):
                return key
            if not self.owns(requested, run_id):
                return ""
            if not self.is_known(key):
                return requested
            made_at, visitor = self._runs[run_id].created_at, _sha256(key)
            of_start = [
                run
                for run in self._by_visitor[_sha256(requested)].values()
                if run.created_at == made_at
            ]
            self._rows.give([run.run_id for run in of_start], visitor)
            for run in of_start:
                self._drop(run.run_id)
                self._add(run._replace(visitor=visitor))
        return key

    def _link(self, visitor: str, address: str, runs: Sequence[Run]) -> None:
        """Check the allowance, and store the visitor of runs before the runs are stored."""
        allowance, used, now = self.allowance, self._use(visitor), self._now()
        allowance.check_start(runs)
        if any(map(self.is_hidden, _used_by(runs))):
            raise Forbidden("this rests on a run of a class, which is shown after the reveal")
        allowance.check_unended(used.unended, self._unended_at(address))
        ends_s = 0.0
        if used.oldest is not None:
            ends_s = (used.oldest + allowance.lifetime - now).total_seconds()
        allowance.check_kept(len(used.kept), len(runs), ends_s)
        cost = allowance.cost(runs)
        if used.steps + cost > allowance.steps_per_hour:
            left = max(0, allowance.steps_per_hour - used.steps)
            raise allowance.used_up(cost, left, self._wait_s(visitor, cost))
        if (wait_s := self._of_address.debt_s(address)) > 0:
            raise allowance.address_used_up(wait_s)
        # The least that a start counts is added to what was asked for.
        extra = cost - sum(run.total for run in runs)
        links = [
            VisitorRun(
                run_id=run.id,
                visitor=visitor,
                steps=run.total + (extra if run is runs[-1] else 0),
                is_main=run is runs[-1],
                created_at=now,
            )
            for run in runs
        ]
        self._rows.add(links)
        self._addresses[visitor] = address
        for link in links:
            self._add(link)

    def _use(self, visitor: str) -> Use:
        states = self._rows.states(visitor=visitor)
        runs = list(self._by_visitor.get(visitor, {}).values())
        since = self._now() - HOUR
        stored = [run for run in runs if run.run_id in states]
        return Use(
            steps=sum(run.steps for run in runs if run.created_at > since),
            unended=sum(run.is_main and states[run.run_id] in NOT_ENDED for run in stored),
            kept=tuple(run.run_id for run in stored),
            oldest=min((run.created_at for run in stored), default=None),
        )

    def _unended_at(self, address: str) -> int:
        """Return the number of unended starts of all visitors of an address."""
        unended = (
            self._runs[run_id] for run_id in self._rows.states(NOT_ENDED) if run_id in self._runs
        )
        return sum(run.is_main and self._addresses.get(run.visitor) == address for run in unended)

    def _wait_s(self, visitor: str, cost: int) -> float:
        """Return the time until a visitor has so many steps left [s]."""
        now, since = self._now(), self._now() - HOUR
        counted = sorted(
            (run.created_at, run.steps)
            for run in self._by_visitor.get(visitor, {}).values()
            if run.created_at > since
        )
        used = sum(steps for _, steps in counted)
        for made_at, steps in counted:
            used -= steps
            if used + cost <= self.allowance.steps_per_hour:
                return max(1.0, (made_at + HOUR - now).total_seconds())
        return HOUR.total_seconds()

    # ---- afterwards

    def unfinished(self) -> list[str]:
        """Return the ids of interrupted runs, without trainings that races need."""
        interrupted = self._rows.states(INTERRUPTED)
        return [
            run.run_id
            for run in list(self._runs.values())
            if run.is_main and run.run_id in interrupted
        ]

    def running(self) -> list[str]:
        """Return the ids of the runs that compute."""
        return list(self._rows.states(RUNNING))

    def made_before(self, time: datetime) -> list[VisitorRun]:
        """Return the runs that were made before a time, races before the trainings they need.

        A time that is further ahead than a clock may have been set back is damaged: such a run is
        returned too, as its age is not known.
        """
        latest = self._now() + _MAX_CLOCK_LEAD
        runs = list(self._runs.values())
        expired = [run for run in runs if run.created_at <= time or run.created_at > latest]
        return sorted(expired, key=lambda run: (run.created_at, run.is_main), reverse=True)

    def forget(self, run_ids: Collection[str]) -> None:
        """Delete the rows of runs, and forget visitors without any other run."""
        with self._lock:
            if not run_ids:
                return
            with suppress(HexapodError):  # the next clean-up finds them again
                self._rows.remove(run_ids)
                for run_id in run_ids:
                    self._drop(run_id)

    def _add(self, run: VisitorRun) -> None:
        self._runs[run.run_id] = self._by_visitor[run.visitor][run.run_id] = run

    def _drop(self, run_id: str) -> None:
        run = self._runs.pop(run_id, None)
        if run is None:
            return
        of_visitor = self._by_visitor[run.visitor]
        of_visitor.pop(run_id, None)
        if not of_visitor:
            del self._by_visitor[run.visitor]
            self._addresses.pop(run.visitor, None)


def _used_by(runs: Sequence[Run]) -> Iterator[str | None]:
    """Yield the ids of the trainings and races from which runs continue or branch off."""
    for run in runs:
        yield from (run.continued_from, *run.lane_training_ids)
        if isinstance(run.config, RaceConfig) and run.config.branch_from is not None:
            yield run.config.branch_from.race_id


def _key_of(request_key: str | None) -> str:
    """Return the key of a new visitor, by the idempotency key of the first start.

    Returns:
        "" if that could be guessed, or is none.
    """
    if request_key is None or len(request_key) < MIN_SECRET:
        return ""
    return _sha256(f"visitor {request_key}")


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()
