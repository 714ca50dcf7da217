"""Judges the entries of tournaments on their draws, in processes of the lowest priority.

Each judgement is stored at once, so that a server that is killed goes on with what is missing. A
judgement follows from rules, entry and draw alone: whichever process computes it, and whenever.
"""

import base64
import itertools
import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

from app.features.tournaments.tournament import OUTCOME, Tournament, TournamentEntry
from app.features.tournaments.tournaments import Tournaments
from app.jobs.process_pool import OutOfProcessorTime, ProcessPool, TookTooLong
from app.storage.errors import Busy, NotFound
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.records import to_json
from hexapods.domain.text import message
from hexapods.runs.tables import from_bytes
from hexapods.tournaments import judging
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.rules import DEFAULT_TRANSITIONS, Draw, TournamentRules
from hexapods.tournaments.tournament_file import JudgedEntry, standings_of, tournament_file

LIMIT_S = 120.0
"""Processor time for one draw of an entry [s]; one that takes longer has failed on it. It is more
where a search may simulate more than by default."""
_WALL_LIMIT_S = 1_800.0
"""After this time a draw begins again: its process gets no processor time, or waits."""
MAX_DEATHS = 3
"""Processes that end while they judge a draw, after which the entry has failed on it."""
_RETRY_S = 5.0
_CLOSE_S = 3.0
_logger = logging.getLogger(__name__)


class JudgingTask(NamedTuple):
    """Arguments of the judging of one entry on one draw, sent to a process.

    Attributes:
        rules: rules of the tournament.
        entry: entry that is judged.
        draw: seed and world.
        table: file of the table with which it enters; None without one.
    """

    rules: TournamentRules
    entry: EntryConfig
    draw: Draw
    table: bytes | None


class _Draw(NamedTuple):
    """A draw of an entry that is to be judged."""

    tournament: Tournament
    entry: TournamentEntry
    number: int

    @property
    def key(self) -> tuple[str, int, int]:
        return self.tournament.id, self.entry.number, self.number


class _GivenUp(Exception):
    """The judging of a draw was cancelled: its entry or tournament is gone or withdrawn."""


@dataclass
class _Work:
    """State shared by the threads of a judge, guarded by the tournaments' lock.

    Attributes:
        draws: draws that are being judged, as (tournament, entry, draw).
        ranked: ids of tournaments that are being ranked or finished.
        served: number of the turn in which a draw of a tournament was taken last, by its id.
        deaths: number of processes that ended while they judged a draw, by draw.
    """

    draws: set[tuple[str, int, int]] = field(default_factory=set)
    ranked: set[str] = field(default_factory=set)
    served: dict[str, int] = field(default_factory=dict)
    deaths: dict[tuple[str, int, int], int] = field(default_factory=dict)


class Judge:
    """Judges the waiting entries of tournaments, by threads that each have a process."""

    def __init__(
        self,
        tournaments: Tournaments,
        count: int,
        niceness: int,
        *,
        limit_s: float = LIMIT_S,
    ) -> None:
        """Create the process pools; `start` starts the threads.

        Args:
            tournaments: tournaments of the server.
            count: number of processes.
            niceness: niceness of the processes.
            limit_s: processor time for a draw [s].
        """
        self._tournaments, self._limit_s = tournaments, limit_s
        self._changed = tournaments.changed
        self._work, self._turns = _Work(), itertools.count()
        self._stopping = threading.Event()
        self._pools = [
            ProcessPool(1, timeout_s=_WALL_LIMIT_S, name="judge", niceness=niceness)
            for _ in range(count)
        ]
        self._threads: list[threading.Thread] = []

    def start(self) -> None:
        """Begin to judge, in threads."""
        for pool in self._pools:
            thread = threading.Thread(target=self._serve, args=(pool,), name="judge", daemon=True)
            self._threads.append(thread)
            thread.start()

    @property
    def pids(self) -> list[int]:
        """Process ids of the running processes."""
        return [pid for pool in self._pools for pid in pool.pids]

    def close(self) -> None:
        """Stop at once; draws that are being judged are judged anew after the next start."""
        self._stopping.set()
        with self._changed:
            self._changed.notify_all()
        for pool in self._pools:
            pool.close()
        for thread in self._threads:
            # One may wait for a database that does not answer.
            thread.join(_CLOSE_S)

    def _serve(self, pool: ProcessPool) -> None:
        while (work := self._next(pool)) is not None:
            try:
                work()
            except HexapodError as error:
                # The database or a process fails: what is not stored is done again.
                if not self._stopping.wait(_RETRY_S):
                    _logger.warning("the judge tries again: %s", error)

    # ---- scheduling

    def _next(self, pool: ProcessPool) -> Callable[[], None] | None:
        """Wait for a tournament to rank or a draw to judge; None once the judge stops."""
        with self._changed:
            while not self._stopping.is_set():
                for tournament in self._tournaments.all():
                    if self._is_to_be_ranked(tournament):
                        self._work.ranked.add(tournament.id)
                        return lambda tournament=tournament: self._rank(pool, tournament)  # type: ignore[misc]
                draw = self._next_draw()
                if draw is not None:
                    self._work.draws.add(draw.key)
                    self._work.served[draw.tournament.id] = next(self._turns)
                    return lambda draw=draw: self._judge(pool, draw)  # type: ignore[misc]
                self._changed.wait()
        return None

    def _is_to_be_ranked(self, tournament: Tournament) -> bool:
        if tournament.state == "ended" or tournament.id in self._work.ranked:
            return False
        is_last = tournament.state == "ending" and not tournament.waiting
        return is_last or len(tournament.judged) > len(tournament.standings)

    def _next_draw(self) -> _Draw | None:
        """Return the next draw of the tournament that has waited longest."""
        served = self._work.served
        going_on = [
            tournament for tournament in self._tournaments.all() if tournament.state != "ended"
        ]
        for tournament in sorted(going_on, key=lambda tournament: served.get(tournament.id, -1)):
            for entry in in_turn(tournament):
                for number in range(tournament.rules.draws):
                    draw = _Draw(tournament, entry, number)
                    if number not in entry.judgements and draw.key not in self._work.draws:
                        return draw
        return None

    # ---- judging and ranking

    def _judge(self, pool: ProcessPool, draw: _Draw) -> None:
        try:
            judgement = self._judgement(pool, draw)
            if judgement is not None:
                self._tournaments.keep(draw.tournament, draw.entry.number, draw.number, judgement)
        finally:
            with self._changed:
                self._work.draws.discard(draw.key)
                self._changed.notify_all()

    def _judgement(self, pool: ProcessPool, draw: _Draw) -> Judgement | None:
        """Return the judgement of a draw; None if its process ended, or its entry waits no more."""
        tournament, entry, _ = draw
        limit = limit_s(tournament.rules, self._limit_s)
        try:
            task = self._task(draw)
            (judgement,) = pool.map(judge, [task], partial(self._check, draw), limit)
        except _GivenUp:
            return None
        except OutOfProcessorTime:
            return Judgement(0.0, f"It took over {limit:g} s of processor time.")
        except (InvalidInput, NotFound) as error:
            return Judgement(0.0, message(str(error)))
        except TookTooLong:
            judgement = None
        except Busy as error:
            if not isinstance(error.__cause__, BrokenExecutor):
                raise  # no process could be started
            judgement = None
        if judgement is None and not self._stopping.is_set():
            with self._changed:
                deaths = self._work.deaths[draw.key] = self._work.deaths.get(draw.key, 0) + 1
            _logger.warning("a process ended that judged entry %d of %s", entry.number, draw.key[0])
            if deaths >= MAX_DEATHS:
                return Judgement(0.0, f"{MAX_DEATHS} processes ended while they judged it.")
        return judgement

    def _task(self, draw: _Draw) -> JudgingTask:
        """Return the arguments for judging a draw; raises NotFound or DamagedFile for its table."""
        tournament, entry, number = draw
        table = None
        if entry.entry.table is not None:
            table = base64.b64decode(self._tournaments.table(tournament, entry.entry.table))
        return JudgingTask(tournament.rules, entry.entry, tournament.draws[number], table)

    def _check(self, draw: _Draw) -> None:
        """Raise _GivenUp if the entry of a draw does not wait any more."""
        if not self._tournaments.is_waiting(draw.tournament.id, draw.entry.number):
            raise _GivenUp

    def _rank(self, pool: ProcessPool, tournament: Tournament) -> None:
        """Rank the judged entries; finish a tournament that is ending once all are judged."""
        try:
            with self._changed:
                is_last = tournament.state == "ending" and not tournament.waiting
                judged = {entry.number: entry.in_order() for entry in tournament.judged}
            if is_last:
                (outcome,) = pool.map(outcome_of, [(tournament.rules, tournament.secret, judged)])
                self._tournaments.finish(tournament, outcome)
            else:
                (standings,) = pool.map(standings_of, [judged])
                self._tournaments.rank(tournament, standings)
        finally:
            with self._changed:
                self._work.ranked.discard(tournament.id)
                self._changed.notify_all()


def in_turn(tournament: Tournament) -> Sequence[TournamentEntry]:
    """Return the entries of a tournament that wait, the next one first.

    References come first, then entries with a judgement; then those of the entrant with the fewest
    judged entries, oldest first.
    """
    judged: dict[Any, int] = {}
    for entry in tournament.judged:
        judged[entry.entrant] = judged.get(entry.entrant, 0) + 1
    return sorted(
        tournament.waiting,
        key=lambda entry: (
            not entry.is_reference,
            not entry.judgements,
            judged.get(entry.entrant, 0),
            entry.number,
        ),
    )


def limit_s(rules: TournamentRules, usual_s: float) -> float:
    """Return the processor time that a draw may take [s].

    Args:
        rules: rules of the tournament.
        usual_s: time for up to `DEFAULT_TRANSITIONS` [s]; more have a proportional time, or entries
            that the rules allow would fail on the judge's machine, and not where they are repeated.
    """
    return usual_s * max(1.0, rules.transitions / DEFAULT_TRANSITIONS)


def judge(task: JudgingTask) -> Judgement | None:
    """Judge an entry on a draw, in a process; None if memory is short there."""
    table = None if task.table is None else from_bytes(task.table, "the table that entered")
    try:
        return judging.judge(task.rules, task.entry, task.draw, table)
    except MemoryError:
        return None


def outcome_of(
    ended: tuple[TournamentRules, str, Mapping[int, tuple[Judgement, ...]]],
) -> dict[str, Any]:
    """Return the outcome of a tournament that ends, in a process.

    Args:
        ended: its rules, its secret, and by number the judgements of its entries.
    """
    rules, secret, judged = ended
    entries = [
        JudgedEntry(number=number, name="", entry=EntryConfig(agent=""), judgements=judgements)
        for number, judgements in judged.items()
    ]
    plain = to_json(tournament_file("", rules, secret, entries))
    return {name: plain[name] for name in OUTCOME}
