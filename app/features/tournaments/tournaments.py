"""The tournaments of a server: opens them, takes entries, ends them, and keeps them all.

All is written to the database before it counts, so that a server that is killed goes on with it.
"""

import logging
import math
import re
import secrets
import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from typing import Any, NamedTuple, TypeVar

from app.features.tournaments.rows import EntryRow, JudgementRow, TournamentRow, TournamentRows
from app.features.tournaments.tournament import (
    OUTCOME,
    STATES,
    EnteredTable,
    Entrant,
    Tournament,
    TournamentEntry,
)
from app.storage.database.store import RunStore
from app.storage.errors import Busy, Conflict, NotFound
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.records import Record, from_json, to_json
from hexapods.domain.robot import Robot
from hexapods.tournaments.entry import EntryConfig, completed, references
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.ranking import RankedEntry
from hexapods.tournaments.rules import TournamentRules

_logger = logging.getLogger(__name__)
MAX_NUMBER = 1_000_000
"""Above the number of any entry."""
MAX_OPEN = 16
"""Tournaments that have not ended, at once."""
MAX_TABLES_BYTES = 24 << 20
"""Limit on the size of all tables of a tournament in its file, in base64."""
MAX_ROBOTS_BYTES = 8 << 20
"""Limit on the size of the documents of all stored robots of the rules, which the file contains."""
_RETRY_S = 60
_SECRET = re.compile("[0-9a-f]{64}")
T = TypeVar("T")


class Entered(NamedTuple):
    """An entry that a tournament has.

    Attributes:
        entry: the entry.
        is_new: whether it was not there before.
    """

    entry: TournamentEntry
    is_new: bool


class Tournaments:
    """All tournaments of a server. Thread-safe."""

    def __init__(
        self,
        store: RunStore,
        *,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
        new_secret: Callable[[], str] = lambda: secrets.token_hex(32),
        on_changed: Callable[[Tournament, bool], object] = lambda tournament, is_deleted: None,  # noqa: ARG005
    ) -> None:
        """Load the tournaments.

        Args:
            store: where they are.
            now: the clock, with time zone.
            new_secret: draws the secret of a tournament.
            on_changed: called with each tournament that has changed, and whether it is deleted.

        Raises:
            StorageFailed: if they cannot be read.
        """
        self._store, self._rows = store, TournamentRows(store)
        self.now, self._new_secret = now, new_secret
        self.on_changed = on_changed
        self.changed = threading.Condition(threading.RLock())
        """Held for each change; notified after it."""
        self._tournaments: dict[str, Tournament] = {}
        self._load()

    def _load(self, tournament_id: str | None = None) -> None:
        """Load all tournaments, or one by its id."""
        loaded = self._rows.tournaments(_tournament, tournament_id)
        new = {tournament.id: tournament for tournament in loaded}
        for owner, number in self._rows.numbers():
            if owner in new and 0 <= number < MAX_NUMBER:
                new[owner].next_number = max(new[owner].next_number, number + 1)
        entries = self._rows.entries(lambda row: (row.tournament, _entry(row)), tournament_id)
        for owner, entry in entries:
            if owner in new:
                new[owner].entries[entry.number] = entry
        judgements = self._rows.judgements(partial(self._judgement, new), tournament_id)
        for row, judgement in judgements:
            if row.tournament in new and row.number in new[row.tournament].entries:
                new[row.tournament].entries[row.number].judgements[row.draw] = judgement
        tournaments = (self._tournaments | new).values()
        oldest_first = sorted(
            tournaments, key=lambda tournament: (tournament.created_at, tournament.id)
        )
        self._tournaments = {tournament.id: tournament for tournament in oldest_first}

    def _judgement(
        self, new: Mapping[str, Tournament], row: JudgementRow
    ) -> tuple[JudgementRow, Judgement]:
        tournament = new.get(row.tournament) or self._tournaments.get(row.tournament)
        if tournament is not None and not 0 <= row.draw < tournament.rules.draws:
            raise ValueError("draw: it is none of the tournament")
        return row, Judgement(row.distance_m, row.failure)

    def all(self) -> list[Tournament]:
        """Return all tournaments, oldest first; a copy, for which no write is waited for."""
        return list({**self._tournaments}.values())

    def of_room(self, code: str) -> list[Tournament]:
        """Return the tournaments of a room, oldest first."""
        return [tournament for tournament in self.all() if tournament.room == code]

    def has_entered(self, seat: tuple[str, int]) -> bool:
        """Whether a participant of a room has entered a tournament of it."""
        room, seed = seat
        entries = (
            entry for tournament in self.of_room(room) for entry in {**tournament.entries}.values()
        )
        return any(not entry.is_reference and entry.entrant.seed == seed for entry in entries)

    def delete_left_behind(self, time: datetime, codes: Collection[str]) -> None:
        """Delete the tournaments that were opened by a time in rooms that are not there any more.

        Args:
            time: in UTC.
            codes: of the rooms that are there.
        """
        for tournament in self.all():
            if tournament.room is None or tournament.room in codes or tournament.created_at > time:
                continue
            try:
                self.delete(tournament.id)
            except HexapodError as error:
                _logger.warning("the tournament %s is deleted later: %s", tournament.id, error)

    def get(self, tournament_id: str) -> Tournament:
        """Return a tournament.

        Raises:
            NotFound: if there is none.
        """
        tournament = self._tournaments.get(tournament_id)
        if tournament is None:
            raise NotFound(f"there is no tournament {tournament_id[:40]!r} (any more)")
        return tournament

    def room_of(self, tournament_id: str) -> str | None:
        """Return the code of a tournament's room; None without one, or if there is no such one."""
        tournament = self._tournaments.get(tournament_id)
        return None if tournament is None else tournament.room

    def create(
        self, rules: TournamentRules, title: str, room: str | None, entries_per_hour: int
    ) -> Tournament:
        """Open a tournament, whose references wait to be judged.

        Args:
            rules: of all entries.
            title: its name; "" for a generated one.
            room: code of the room whose participants may enter; None for operators alone.
            entries_per_hour: entries of a participant within an hour.

        Raises:
            Busy: if too many have not ended.
            InvalidInput: if the documents of its stored robots are too large.
            NotFound: if a stored robot of the rules was deleted meanwhile.
            UnknownName, InvalidInput: if the references cannot walk by these rules.
        """
        entries, robots = references(rules), (rules.robot, *rules.robots)
        self._check_robots(robots)
        with self.changed:
            self._check_may_open("end one")
            now = self.now()
            row = TournamentRow(
                id=secrets.token_hex(8),
                title=title or f"Tournament, {rules.resolved_gait.title}",
                room=room,
                rules=to_json(rules),
                secret=self._new_secret(),
                entries_per_hour=entries_per_hour,
                state="open",
                outcome=None,
                created_at=now,
                ended_at=None,
            )
            rows = [
                EntryRow(
                    tournament=row.id,
                    number=number,
                    seed=None,
                    name=entry.agent,
                    is_reference=True,
                    entry=to_json(entry),
                    training_id=None,
                    is_withdrawn=False,
                    entered_at=now,
                )
                for number, entry in enumerate(entries)
            ]
            self._rows.add(row, rows, lambda c: self._store.robots.check(c, robots))
            tournament = self._tournaments[row.id] = _tournament(row)
            tournament.entries = {row_.number: _entry(row_) for row_ in rows}
            tournament.next_number = len(rows)
            self.changed.notify_all()
        self._tell(tournament)
        return tournament

    def enter(
        self,
        tournament_id: str,
        entrant: Entrant,
        entry: EntryConfig,
        table: EnteredTable | None = None,
        check: Callable[[], object] = lambda: None,
    ) -> Entered:
        """Take an entry; one that would be judged as an earlier one of the entrant is that one.

        Args:
            tournament_id: of the tournament.
            entrant: whose it is; participants have a number of entries an hour, operators any.
            entry: what is to be judged.
            table: the table with which it enters, as it was checked; None without one.
            check: raises if the entrant may not enter at present.

        Raises:
            NotFound: if there is no such tournament.
            Conflict: if it takes no more entries, or has no place for this one.
            Busy: if the participant has none left this hour.
            UnknownName, InvalidInput: if the rules do not allow it.
        """
        rules = self.get(tournament_id).rules
        entry = completed(entry, rules)
        with self.changed:
            tournament = self.get(tournament_id)
            check()
            tournament.check_open()
            equal = tournament.equal_entry(entrant, entry)
            if equal is not None:
                return Entered(equal, is_new=False)
            now = self.now()
            tournament.check_not_full()
            _check_left(tournament, entrant, now)
            self._check_size(tournament, table)
            row = EntryRow(
                tournament=tournament.id,
                number=tournament.next_number,
                seed=entrant.seed,
                name=entrant.name,
                is_reference=False,
                entry=to_json(entry),
                training_id=None if table is None else table.training_id,
                is_withdrawn=False,
                entered_at=now,
            )
            self._rows.add_entry(row, None if table is None else (table.sha256, table.data))
            # As it is read after a restart.
            entered = tournament.entries[row.number] = _entry(row)
            tournament.next_number += 1
            self.changed.notify_all()
        self._tell(tournament)
        return Entered(entered, is_new=True)

    def end(self, tournament_id: str, *, withdraw_waiting: bool = False) -> Tournament:
        """Take no more entries; once those that wait are judged, it has ended.

        Args:
            tournament_id: of the tournament.
            withdraw_waiting: whether those that wait are withdrawn, but for the references.

        Raises:
            NotFound: if there is no such tournament.
        """
        with self.changed:
            tournament = self.get(tournament_id)
            if tournament.state == "ended":
                return tournament
            waiting = [entry for entry in tournament.waiting if not entry.is_reference]
            withdrawn = [entry.number for entry in waiting] if withdraw_waiting else []
            self._rows.end(tournament.id, withdrawn)
            tournament.state = "ending"
            for number in withdrawn:
                entry = tournament.entries[number]
                tournament.entries[number] = replace(entry, is_withdrawn=True)
            self.changed.notify_all()
        self._tell(tournament)
        return tournament

    def trash(self, tournament_id: str) -> datetime | None:
        """Delete a tournament so that it can be restored; its running judgements are cancelled.

        Returns:
            until when; None if it is gone at once, as the disk is full.

        Raises:
            NotFound: if there is no such tournament.
        """
        return self._delete(tournament_id, self._rows.trash)

    def delete(self, tournament_id: str) -> None:
        """Delete a tournament at once and for good; its running judgements are cancelled.

        Raises:
            NotFound: if there is no such tournament.
        """
        self._delete(tournament_id, self._rows.delete)

    def _delete(self, tournament_id: str, delete: Callable[[str], T]) -> T:
        with self.changed:
            tournament = self.get(tournament_id)
            result = delete(tournament.id)
            del self._tournaments[tournament.id]
            self.changed.notify_all()
        self.on_changed(tournament, True)
        return result

    def restore(self, tournament_id: str) -> Tournament:
        """Bring back a tournament that was deleted lately; what is missing of it is judged.

        One that is there stays.

        Raises:
            NotFound: if there is no such tournament, it was deleted too long ago, or a stored robot
                of its rules was deleted.
            Busy: if it has not ended, and too many others have not.
        """
        with self.changed:
            if (there := self._tournaments.get(tournament_id)) is not None:
                return there

            def check(restored: Tournament) -> None:
                if restored.state != "ended":
                    self._check_may_open("end one, and restore this one again")

            self._rows.restore(tournament_id, _tournament, check)
            self._load(tournament_id)
            tournament = self.get(tournament_id)
            self.changed.notify_all()
        self._tell(tournament)
        return tournament

    def _check_may_open(self, advice: str) -> None:
        going_on = [tournament for tournament in self.all() if tournament.state != "ended"]
        if len(going_on) >= MAX_OPEN:
            raise Busy(
                f"{MAX_OPEN} tournaments have not ended, which is the most; {advice}", _RETRY_S
            )

    def table(self, tournament: Tournament, sha256: str) -> str:
        """Return a table that has entered, in base64.

        Raises:
            NotFound: if the tournament has none of this SHA-256.
            DamagedFile: if it is damaged.
        """
        data = self._rows.table(tournament.id, sha256)
        if data is None:
            raise NotFound(f"the tournament {tournament.id} has no table {sha256[:64]!r}")
        return data

    # ---- of the judge

    def is_waiting(self, tournament_id: str, number: int) -> bool:
        """Whether an entry is there, and was not withdrawn."""
        tournament = self._tournaments.get(tournament_id)
        entry = None if tournament is None else tournament.entries.get(number)
        return entry is not None and not entry.is_withdrawn

    def keep(self, tournament: Tournament, number: int, draw: int, judgement: Judgement) -> None:
        """Keep the judgement of an entry on a draw, unless the entry waits for it no longer."""
        row = JudgementRow(tournament.id, number, draw, judgement.distance_m, judgement.failure)
        with self.changed:
            if not self.is_waiting(tournament.id, number):
                return  # withdrawn, or deleted
            self._rows.add_judgement(row)
            # The tournament may have been deleted and restored since.
            tournament = self.get(tournament.id)
            tournament.entries[number].judgements[draw] = judgement
        self._tell(tournament)

    def rank(self, tournament: Tournament, standings: Sequence[RankedEntry]) -> None:
        """Set the standings, unless newer ones are there already, or the tournament is deleted."""
        with self.changed:
            if (current := self._tournaments.get(tournament.id)) is None:
                return
            if len(standings) >= len(current.standings):
                current.standings = tuple(standings)
        self._tell(current)

    def finish(self, tournament: Tournament, outcome: Mapping[str, Any]) -> None:
        """Note that a tournament has ended, with its outcome in JSON.

        Raises:
            NotFound: if the tournament was deleted.
        """
        with self.changed:
            tournament = self.get(tournament.id)
            now = self.now()
            changes = {"state": "ended", "outcome": outcome, "ended_at": now}
            self._rows.change(tournament.id, changes)
            tournament.outcome, tournament.standings = outcome, _standings(outcome)
            tournament.state, tournament.ended_at = "ended", now
        self._tell(tournament)

    def _tell(self, tournament: Tournament) -> None:
        self.on_changed(tournament, False)

    def _check_robots(self, robots: Sequence[Robot]) -> None:
        stored = [robot.id for robot in robots if robot.id is not None]
        size = sum(len(self._store.robots.document(robot_id)) for robot_id in stored)
        if size > MAX_ROBOTS_BYTES:
            raise InvalidInput(
                f"the stored robots of these rules have {size:,} bytes together; at most "
                f"{MAX_ROBOTS_BYTES:,} enter a tournament, as its file has them"
            )

    def _check_size(self, tournament: Tournament, table: EnteredTable | None) -> None:
        if table is None:
            self._store.check_disk_space()
            return
        self._store.files.check_disk_space(2 * len(table.data))
        if self._rows.size_of_tables(tournament.id) + len(table.data) * 4 // 3 > MAX_TABLES_BYTES:
            raise Conflict(
                f"the tables of this tournament have {MAX_TABLES_BYTES >> 20} MB, which is the "
                "most; enter without a table",
                tournament.state,
            )


def _check_left(tournament: Tournament, entrant: Entrant, now: datetime) -> None:
    if entrant.seed is None:
        return
    left, next_at = tournament.left(entrant, now)
    if not left and next_at is not None:
        wait_s = max(1, math.ceil((next_at - now).total_seconds()))
        raise Busy(
            f"you have used up your {tournament.entries_per_hour} entries of this hour; the "
            f"next one is possible in {_minutes(wait_s)}",
            wait_s,
        )


def _minutes(seconds: int) -> str:
    return f"{seconds} s" if seconds < 120 else f"{-(-seconds // 60)} minutes"


@dataclass(frozen=True)
class _Outcome(Record):
    """Data that are stored of a tournament at its end; see `OUTCOME`."""

    standings: tuple[RankedEntry, ...]
    robots: Mapping[str, Mapping[str, Any]]
    versions: Mapping[str, str]
    machine: Mapping[str, Any]


def _tournament(row: TournamentRow) -> Tournament:
    if row.state not in STATES:
        raise ValueError(f"state: it is none of {', '.join(STATES)}")
    if row.entries_per_hour < 1:
        raise ValueError("entries_per_hour: it is none")
    if not _SECRET.fullmatch(row.secret):
        raise ValueError("secret: it is none")
    outcome = row.outcome or {}
    if row.state == "ended":
        from_json(_Outcome, {name: outcome[name] for name in OUTCOME})
    return Tournament(
        id=row.id,
        title=row.title,
        room=row.room,
        rules=from_json(TournamentRules, row.rules),
        secret=row.secret,
        entries_per_hour=row.entries_per_hour,
        state=row.state,
        created_at=row.created_at,
        ended_at=row.ended_at,
        standings=_standings(outcome),
        outcome=outcome,
    )


def _standings(outcome: Mapping[str, Any]) -> tuple[RankedEntry, ...]:
    return tuple(from_json(RankedEntry, entry) for entry in outcome.get("standings", ()))


def _entry(row: EntryRow) -> TournamentEntry:
    if not 0 <= row.number < MAX_NUMBER:
        raise ValueError("number: it is none of an entry")
    return TournamentEntry(
        number=row.number,
        entrant=Entrant(row.seed, row.name),
        is_reference=row.is_reference,
        entry=from_json(EntryConfig, row.entry),
        training_id=row.training_id,
        is_withdrawn=row.is_withdrawn,
        entered_at=row.entered_at,
    )
