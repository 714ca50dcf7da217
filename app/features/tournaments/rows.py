"""Rows of tournaments: `tournaments`, `tournament_entries`, their judgements and their tables.

All but the tables are read when the server starts; from then on they are only written.
"""

import base64
import hashlib
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from typing import Any, NamedTuple, TypeVar

from sqlalchemy import (
    ColumnElement,
    Connection,
    String,
    Table,
    and_,
    cast,
    delete,
    func,
    select,
    update,
)

from app.features.tournaments.tables import (
    TOURNAMENT_ENTRIES,
    TOURNAMENT_JUDGEMENTS,
    TOURNAMENT_TABLES,
    TOURNAMENTS,
)
from app.storage.database.store import RunStore
from app.storage.database.stored_rows import put_rows, read_rows, rows_in
from app.storage.errors import NotFound
from hexapods.domain.errors import DamagedFile

T = TypeVar("T")


class TournamentRow(NamedTuple):
    """A tournament.

    Attributes:
        id: hard to guess.
        title: as its opener has named it.
        room: code of its room; None without one.
        rules: in JSON.
        secret: from which the draws follow.
        entries_per_hour: entries of a participant within an hour.
        state: `open`, `ending` or `ended`.
        outcome: once it has ended: standings, versions and machine, in JSON.
        created_at, ended_at: in UTC.
    """

    id: str
    title: str
    room: str | None
    rules: Mapping[str, Any]
    secret: str
    entries_per_hour: int
    state: str
    outcome: Mapping[str, Any] | None
    created_at: datetime
    ended_at: datetime | None


class EntryRow(NamedTuple):
    """An entry of a tournament.

    Attributes:
        tournament: its id.
        number: from 0, in the order of their entering.
        seed: of the participant; None of a reference, or of an operator.
        name: of a reference, or as an operator has given it.
        is_reference: whether it is judged in every tournament.
        entry: in JSON.
        training_id: of the training whose table entered; None without one.
        is_withdrawn: whether the end came before it was judged.
        entered_at: in UTC.
    """

    tournament: str
    number: int
    seed: int | None
    name: str
    is_reference: bool
    entry: Mapping[str, Any]
    training_id: str | None
    is_withdrawn: bool
    entered_at: datetime


class JudgementRow(NamedTuple):
    """The judgement of an entry on a draw."""

    tournament: str
    number: int
    draw: int
    distance_m: float
    failure: str | None


class TableRow(NamedTuple):
    """A trained table that entered, in base64."""

    tournament: str
    sha256: str
    data: str


class TournamentRows:
    """Reads and writes the tournaments in a database."""

    def __init__(self, store: RunStore) -> None:
        self._store, self._database = store, store.database
        self._database.decoders[TOURNAMENT_TABLES.name] = _sound_table

    def tournaments(
        self, decode: Callable[[TournamentRow], T], tournament: str | None = None
    ) -> list[T]:
        """Return all sound tournaments, oldest first, or one by its id.

        What `decode` raises is damage.
        """
        order = TOURNAMENTS.c.created_at, TOURNAMENTS.c.id
        where = None if tournament is None else TOURNAMENTS.c.id == tournament
        return self._read(
            TOURNAMENTS, lambda **row: decode(TournamentRow(**row)), *order, where=where
        )

    def entries(self, decode: Callable[[EntryRow], T], tournament: str | None = None) -> list[T]:
        """Return all sound entries, or those of a tournament, in the order of their numbers."""
        table = TOURNAMENT_ENTRIES
        where = _of(table, tournament)
        return self._read(table, lambda **row: decode(EntryRow(**row)), table.c.number, where=where)

    def judgements(
        self, decode: Callable[[JudgementRow], T], tournament: str | None = None
    ) -> list[T]:
        """Return all sound judgements, or those of a tournament, in the order of their draws."""
        table = TOURNAMENT_JUDGEMENTS
        where = _of(table, tournament)
        return self._read(
            table, lambda **row: decode(JudgementRow(**row)), table.c.draw, where=where
        )

    def _read(
        self,
        table: Table,
        decode: Callable[..., T],
        *order: ColumnElement[Any],
        where: ColumnElement[bool] | None,
    ) -> list[T]:
        return read_rows(self._database, table, decode, *order, where=where).sound

    def add(
        self,
        row: TournamentRow,
        entries: Sequence[EntryRow],
        check: Callable[[Connection], object],
    ) -> None:
        """Insert a tournament with its first entries, if a check passes within the transaction."""

        def work(connection: Connection) -> None:
            check(connection)
            put_rows(connection, TOURNAMENTS, [row._asdict()])
            put_rows(connection, TOURNAMENT_ENTRIES, [entry._asdict() for entry in entries])

        self._database.write(work)

    def numbers(self) -> list[tuple[str, int]]:
        """Return tournaments with the numbers of their entries, of those that are damaged too."""
        query = select(TOURNAMENT_ENTRIES.c.tournament, TOURNAMENT_ENTRIES.c.number)
        rows = self._database.read(lambda connection: connection.execute(query).all())
        return [(tournament, number) for tournament, number in rows if isinstance(number, int)]

    def add_entry(self, row: EntryRow, table: tuple[str, bytes] | None = None) -> None:
        """Insert an entry, with its table by SHA-256."""

        def work(connection: Connection) -> None:
            put_rows(connection, TOURNAMENT_ENTRIES, [row._asdict()])
            if table is not None:
                data = base64.b64encode(table[1]).decode()
                copied = TableRow(row.tournament, table[0], data)
                put_rows(connection, TOURNAMENT_TABLES, [copied._asdict()])

        self._database.write(work)

    def add_judgement(self, row: JudgementRow) -> None:
        """Insert a judgement.

        Raises:
            NotFound: if there is no such entry any more.
        """
        entries = TOURNAMENT_ENTRIES

        def work(connection: Connection) -> None:
            is_of = and_(entries.c.tournament == row.tournament, entries.c.number == row.number)
            if connection.execute(select(entries.c.number).where(is_of)).first() is None:
                raise NotFound(f"there is no tournament {row.tournament!r} (any more)")
            put_rows(connection, TOURNAMENT_JUDGEMENTS, [row._asdict()])

        self._database.write(work)

    def change(self, tournament: str, changes: Mapping[str, Any]) -> None:
        """Change columns of a tournament."""
        statement = update(TOURNAMENTS).where(TOURNAMENTS.c.id == tournament).values(**changes)
        self._database.write(lambda connection: connection.execute(statement))

    def end(self, tournament: str, withdrawn: Sequence[int]) -> None:
        """Mark a tournament as ending, and withdraw entries by number, in one transaction."""
        entries = TOURNAMENT_ENTRIES
        is_of = and_(entries.c.tournament == tournament, entries.c.number.in_(list(withdrawn)))

        def work(connection: Connection) -> None:
            is_it = TOURNAMENTS.c.id == tournament
            connection.execute(update(TOURNAMENTS).where(is_it).values(state="ending"))
            if withdrawn:
                connection.execute(update(entries).where(is_of).values(is_withdrawn=True))

        self._database.write(work)

    def trash(self, tournament: str) -> datetime | None:
        """Delete a tournament so that it can be restored for a while; its other rows stay.

        Returns:
            until when; None if it is gone at once, as the disk is full.
        """
        return self._store.deletions.delete(TOURNAMENTS, lambda _: TOURNAMENTS.c.id == tournament)

    def restore(
        self,
        tournament: str,
        decode: Callable[[TournamentRow], T],
        check: Callable[[T], object],
    ) -> None:
        """Bring back a tournament that was deleted lately, if a check passes in the transaction.

        Args:
            tournament: its id.
            decode: returns a tournament; what it raises is damage.
            check: checks the tournament; what it raises keeps it deleted.

        Raises:
            NotFound: if there is no such tournament, it was deleted too long ago, or a stored robot
                of its rules was deleted, too.
        """
        is_it = TOURNAMENTS.c.id == tournament

        def fetch(connection: Connection) -> None:
            query = select(cast(TOURNAMENTS.c.rules, String)).where(is_it)
            for rules in connection.execute(query).scalars():
                self._store.robots.check_not_deleted(connection, rules)
            rows = rows_in(
                connection, TOURNAMENTS, lambda **row: decode(TournamentRow(**row)), where=is_it
            )
            if not rows.sound:
                raise NotFound(f"there is no tournament {tournament[:40]!r} (any more)")
            check(rows.sound[0])

        self._store.deletions.restore(TOURNAMENTS, lambda _: is_it, fetch)

    def delete(self, tournament: str) -> None:
        """Delete a tournament with all that belongs to it, at once and for good."""
        statement = delete(TOURNAMENTS).where(TOURNAMENTS.c.id == tournament)
        self._database.write(lambda connection: connection.execute(statement))

    def table(self, tournament: str, sha256: str) -> str | None:
        """Return a table in base64; None if the tournament has none of this SHA-256.

        Raises:
            DamagedFile: if it is damaged.
        """
        where = _is(tournament, sha256)
        rows = read_rows(self._database, TOURNAMENT_TABLES, _sound_table, where=where)
        for row in rows.damaged:
            raise DamagedFile(f"the table {sha256[:64]} that entered is damaged: {row.damaged}")
        return rows.sound[0].data if rows.sound else None

    def size_of_tables(self, tournament: str) -> int:
        """Return the length of all tables of a tournament, in base64."""
        table = TOURNAMENT_TABLES
        query = select(func.sum(func.length(table.c.data))).where(table.c.tournament == tournament)
        size = self._database.read(lambda connection: connection.execute(query).scalar())
        return int(size or 0)


def _sound_table(**row: str) -> TableRow:
    table = TableRow(**row)
    if hashlib.sha256(base64.b64decode(table.data, validate=True)).hexdigest() != table.sha256:
        raise ValueError("data: it is not what entered")
    return table


def _of(table: Table, tournament: str | None) -> ColumnElement[bool] | None:
    return None if tournament is None else table.c.tournament == tournament


def _is(tournament: str, sha256: str) -> Any:
    table = TOURNAMENT_TABLES
    return and_(table.c.tournament == tournament, table.c.sha256 == sha256)
