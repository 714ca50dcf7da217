"""A tournament, as it is in the database, with its entries and their judgements."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from functools import cached_property
from typing import Annotated, Any, Literal, NamedTuple, get_args

from annotated_types import Ge, Le

from app.answer import Answer, Count
from app.storage.errors import Conflict
from hexapods.domain.settings import Setting
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.ranking import RankedEntry
from hexapods.tournaments.rules import MAX_ENTRIES, Draw, TournamentRules, commitment_of, draws_of

TournamentState = Literal["open", "ending", "ended"]
STATES: tuple[TournamentState, ...] = get_args(TournamentState)
EntryState = Literal["waiting", "judging", "judged", "withdrawn"]
EntriesPerHour = Annotated[
    int,
    Ge(1),
    Le(60),
    Setting(title="Entries per hour", help="Of each participant; the same again counts no more."),
]
DEFAULT_ENTRIES_PER_HOUR = 6
HOUR = timedelta(hours=1)
OUTCOME = ("standings", "robots", "versions", "machine")
"""Fields of a tournament's file that are stored at its end: a later version could differ."""


class Entrant(NamedTuple):
    """Entrant of a tournament: a participant, an operator, or the server with a reference.

    Attributes:
        seed: seed of the participant; None for a reference, or an operator.
        name: name of the reference, or the one that the operator has given.
    """

    seed: int | None
    name: str = ""


class EnteredTable(NamedTuple):
    """The table of a training that enters.

    Attributes:
        training_id: id of the training.
        sha256: SHA-256 of its file, hexadecimal.
        data: the file.
    """

    training_id: str
    sha256: str
    data: bytes


@dataclass(frozen=True)
class TournamentEntry:
    """An entry of a tournament; its judgements come in one after another.

    Attributes:
        number: number from 0, in the order of their entering; the references come first.
        entrant: the entrant.
        is_reference: whether it is judged in every tournament.
        entry: config that is judged.
        training_id: id of the training whose table entered; None without one.
        is_withdrawn: whether the end came before it was judged.
        entered_at: time in UTC.
        judgements: judgements by number of the draw.
    """

    number: int
    entrant: Entrant
    is_reference: bool
    entry: EntryConfig
    training_id: str | None
    is_withdrawn: bool
    entered_at: datetime
    judgements: dict[int, Judgement] = field(default_factory=dict)

    def in_order(self) -> tuple[Judgement, ...]:
        """Return the judgements of the entry in the order of the draws."""
        return tuple(judgement for _, judgement in sorted({**self.judgements}.items()))


class TournamentEvent(Answer):
    """A tournament has changed; `GET /tournaments/{tournament_id}` returns it.

    Attributes:
        entries: number of its entries, without the references.
        judged, of: number of draws that are judged, over all entries and references, and of all.
    """

    id: str
    state: TournamentState | Literal["deleted"]
    entries: Count
    judged: Count
    of: Count


@dataclass
class Tournament:
    """A tournament, as it is in the database.

    Attributes:
        id: id that is hard to guess.
        title: title that its opener has given.
        room: code of its room; None without one.
        rules: rules of all entries.
        secret: secret from which the draws are derived; it is published at the end.
        entries_per_hour: maximum number of entries of a participant within an hour.
        state: `open` for entries; `ending` until those that wait are judged; or `ended`.
        created_at, ended_at: times in UTC.
        entries: entries by number.
        next_number: number of the next entry.
        standings: ranking of the entries that are judged on all draws, best first, by the judge.
        outcome: fields of its file that are named by `OUTCOME`, in JSON; empty before the end.
    """

    id: str
    title: str
    room: str | None
    rules: TournamentRules
    secret: str = field(repr=False)
    entries_per_hour: int
    state: TournamentState
    created_at: datetime
    ended_at: datetime | None
    entries: dict[int, TournamentEntry] = field(default_factory=dict)
    next_number: int = 0
    standings: Sequence[RankedEntry] = ()
    outcome: Mapping[str, Any] = field(default_factory=dict, repr=False)

    @cached_property
    def commitment(self) -> str:
        """SHA-256 of the secret."""
        return commitment_of(self.secret)

    @cached_property
    def draws(self) -> tuple[Draw, ...]:
        """Seeds and worlds on which all entries are judged."""
        return draws_of(self.rules, self.secret)

    @property
    def listed(self) -> list[TournamentEntry]:
        """All entries by number; a copy, as others may enter meanwhile."""
        return list(self.entries.values())

    @property
    def progress(self) -> TournamentEvent:
        """Data of the `tournament` event: state, and number of entries and of judged draws."""
        counted = [entry for entry in self.listed if not entry.is_withdrawn]
        return TournamentEvent(
            id=self.id,
            state=self.state,
            entries=self.entered,
            judged=sum(len(entry.judgements) for entry in counted),
            of=len(counted) * self.rules.draws,
        )

    @property
    def entered(self) -> int:
        """Number of entries without the references."""
        return sum(not entry.is_reference for entry in self.listed)

    @property
    def judged(self) -> list[TournamentEntry]:
        """The entries that are judged on all draws, by number."""
        return [entry for entry in self.listed if self.is_judged(entry)]

    @property
    def waiting(self) -> list[TournamentEntry]:
        """The entries that are not judged on all draws yet, by number."""
        return [entry for entry in self.listed if not (entry.is_withdrawn or self.is_judged(entry))]

    def is_judged(self, entry: TournamentEntry) -> bool:
        """Whether an entry is judged on all draws."""
        return len(entry.judgements) >= self.rules.draws

    def state_of(self, entry: TournamentEntry) -> EntryState:
        """Return the state of an entry: waiting, judging, judged or withdrawn."""
        if entry.is_withdrawn:
            return "withdrawn"
        if self.is_judged(entry):
            return "judged"
        return "judging" if entry.judgements else "waiting"

    def of_entrant(self, entrant: Entrant) -> list[TournamentEntry]:
        """Return the entries of an entrant, oldest first."""
        return [
            entry for entry in self.listed if not entry.is_reference and entry.entrant == entrant
        ]

    def equal_entry(self, entrant: Entrant, entry: EntryConfig) -> TournamentEntry | None:
        """Return the entry of an entrant that is judged alike; None if there is none.

        Args:
            entrant: the entrant.
            entry: config of the entry, as `completed` returns it.
        """
        wanted = self._written_out(entry)
        entries = self.of_entrant(entrant)
        return next(
            (stored for stored in entries if self._written_out(stored.entry) == wanted), None
        )

    def _written_out(self, entry: EntryConfig) -> EntryConfig:
        robot = self.rules.robot if entry.robot is None else entry.robot
        steps = self.rules.steps if entry.steps is None else entry.steps
        return replace(entry, robot=robot, steps=steps)

    def left(self, entrant: Entrant, now: datetime) -> tuple[int, datetime | None]:
        """Return the entries that a participant has left this hour, and when it has a further one.

        Args:
            entrant: the participant.
            now: time in UTC.

        Returns:
            the number, and the time if it is 0, else None.
        """
        # One in the future is of before the clock was set back.
        within = (entry.entered_at for entry in self.of_entrant(entrant))
        recent = sorted(time for time in within if now - HOUR < time <= now)
        left = max(0, self.entries_per_hour - len(recent))
        return left, None if left else recent[-self.entries_per_hour] + HOUR

    def check_open(self) -> None:
        """Check that the tournament takes entries.

        Raises:
            Conflict: if it does not.
        """
        if self.state != "open":
            raise Conflict("this tournament takes no more entries", self.state)

    def check_not_full(self) -> None:
        """Check that the tournament has a place for a further entry.

        Raises:
            Conflict: if it has not.
        """
        if len(self.entries) >= MAX_ENTRIES:
            raise Conflict(f"this tournament has {MAX_ENTRIES} entries, the most", self.state)

    def check_ended(self) -> None:
        """Check that the tournament has ended.

        Raises:
            Conflict: if it has not.
        """
        if self.state != "ended":
            raise Conflict(
                "this tournament has not ended; its file is there once the last entry is judged",
                self.state,
            )
