"""Response models of tournaments, as those of `app.api.answers`."""

from datetime import datetime
from typing import Annotated

from pydantic import Field

from app.answer import Answer, Count
from app.features.tournaments.tournament import EntryState, TournamentState
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.judging import Judgement
from hexapods.tournaments.ranking import RankedEntry
from hexapods.tournaments.rules import Draw, TournamentRules

Hexadecimal = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class ListedTournament(Answer):
    """A tournament in a list.

    Attributes:
        room: code of its room; null without one.
        state: `open` for entries; `ending` until those that wait are judged; or `ended`.
        entries: number of its entries, without the references.
    """

    id: str
    title: str
    room: str | None
    state: TournamentState
    entries: Count
    created_at: datetime


class TournamentList(Answer):
    """The tournaments that who asks may know, newest first."""

    items: list[ListedTournament]


class EntryView(Answer):
    """An entry of a tournament.

    Attributes:
        number: from 0, in the order of their entering; the references come first.
        name: of its entrant, or of the reference; null where it is not to be seen.
        is_own: whether it is the reader's own; an operator's if an operator reads.
        entry: with all settings; that of others is null until the end, but for operators.
        training_id: of the training whose table entered; null where the entry is, or without one.
        state: `judging` once its first draw is; `withdrawn` if the end came before it was judged.
        judged, of: number of draws on which it is judged, and of all.
        judgements: on each draw; null until the end.
    """

    number: Count
    name: str | None
    is_reference: bool
    is_own: bool
    entry: EntryConfig | None
    training_id: str | None
    state: EntryState
    judged: Count
    of: Count
    judgements: list[Judgement] | None
    entered_at: datetime


class OwnEntries(Answer):
    """What the reader may enter.

    Attributes:
        may_enter: whether an entry would be taken now.
        reason: why not, in a sentence; null if it would be.
        left: entries that are left this hour; null for operators, who have no limit, and for
            others who may not enter at all.
        next_at: when there is a further one; null while some are left.
    """

    may_enter: bool
    reason: str | None
    left: Count | None
    next_at: datetime | None


class TournamentView(Answer):
    """A tournament, as who asks may see it.

    Attributes:
        room: code of its room; null without one.
        state: `open` for entries; `ending` until those that wait are judged; or `ended`.
        commitment: SHA-256 of the secret, from which the draws follow.
        entries_per_hour: entries of a participant within an hour.
        address: of its page, for others if they can reach the server.
        qr_code: of the address, an SVG image as a data URI; null if phones cannot reach the server.
        entries: in the order of their numbers.
        standings: of the entries that are judged on all draws, best first.
        own: what the reader may enter.
        is_operator: whether the reader is one, and may delete it.
        may_end: whether the reader may end it.
        secret, draws: null until the end.
        file: path of the file with all of it; null until the end.
    """

    id: str
    title: str
    room: str | None
    state: TournamentState
    rules: TournamentRules
    commitment: Hexadecimal
    entries_per_hour: Annotated[int, Field(ge=1)]
    created_at: datetime
    ended_at: datetime | None
    address: str
    qr_code: str | None
    entries: list[EntryView]
    standings: list[RankedEntry]
    own: OwnEntries
    is_operator: bool
    may_end: bool
    secret: Hexadecimal | None
    draws: list[Draw] | None
    file: str | None
