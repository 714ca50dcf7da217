"""Views of tournaments for responses of the API, and checks of the access of readers."""

from dataclasses import replace
from typing import Any

from fastapi import Request

from app.api.deps import Services
from app.api.descriptions import as_sentence
from app.api.spectators import link_to
from app.features.tournaments.access import Reader
from app.features.tournaments.response_models import (
    EntryView,
    OwnEntries,
    TournamentView,
)
from app.features.tournaments.room_directory import RoomDirectory
from app.features.tournaments.tournament import Entrant, Tournament, TournamentEntry
from app.features.tournaments.tournaments import Tournaments
from app.storage.errors import Conflict, Forbidden, NotFound
from app.viewer.shared_stage import SharedStage

_OPERATORS_ALONE = "operators alone enter this tournament, as it has no room"
_OF_A_ROOM = (
    "this tournament is for the participants of a room; join the room by its code, and try again"
)


def room_of(rooms: RoomDirectory, tournament: Tournament) -> Any:
    """Return the room of a tournament; None without one, or if it is not there any more."""
    try:
        return None if tournament.room is None else rooms.get(tournament.room)
    except NotFound:
        return None


def seed_of(tournament: Tournament, reader: Reader) -> int | None:
    """Return the seed of the participant who reads, in the tournament's room; None for others."""
    return dict(reader or ()).get(tournament.room or "")


def check_may_know(rooms: RoomDirectory, tournament: Tournament, reader: Reader) -> None:
    """Check that a reader may know a tournament: once it or its room has ended, all may.

    Without the classroom feature a room counts as open.

    Raises:
        Forbidden: if not.
    """
    room = room_of(rooms, tournament)
    is_going_on = room is not None and room.is_open
    may_go_on = is_going_on or (tournament.room is not None and not rooms.is_there)
    is_for_all = not may_go_on or tournament.state == "ended"
    if reader is not None and not is_for_all and seed_of(tournament, reader) is None:
        raise Forbidden(_OF_A_ROOM)


def check_may_enter(rooms: RoomDirectory, tournament: Tournament, reader: Reader) -> None:
    """Check that a reader may enter a tournament at present, but for the number of entries.

    Raises:
        Forbidden: if the reader is neither an operator nor a participant of its room.
        Conflict: if the room has ended or is frozen, or the tournament takes no more entries.
    """
    if reader is not None:
        if seed_of(tournament, reader) is None:
            raise Forbidden(_OPERATORS_ALONE if tournament.room is None else _OF_A_ROOM)
        rooms.get(tournament.room or "").check_going_on()
    tournament.check_open()


def tournament_view(
    request: Request, services: Services, tournament: Tournament, reader: Reader
) -> TournamentView:
    """Return a tournament as a reader may see it."""
    has_ended = tournament.state == "ended"
    file = request.url_for("get_tournament_file", tournament_id=tournament.id).path
    link = link_to(request, services.settings, f"/t/{tournament.id}")
    return TournamentView(
        id=tournament.id,
        title=tournament.title,
        room=tournament.room,
        state=tournament.state,
        rules=tournament.rules,
        commitment=tournament.commitment,
        entries_per_hour=tournament.entries_per_hour,
        created_at=tournament.created_at,
        ended_at=tournament.ended_at,
        address=link.address,
        qr_code=link.qr_code,
        entries=[
            entry_view(services.of(RoomDirectory), tournament, entry, reader)
            for entry in tournament.listed
        ],
        standings=list(tournament.standings),
        own=_own(services, tournament, reader),
        is_operator=reader is None,
        may_end=reader is None and tournament.state == "open",
        secret=tournament.secret if has_ended else None,
        draws=list(tournament.draws) if has_ended else None,
        file=file if has_ended else None,
    )


def entry_view(
    rooms: RoomDirectory, tournament: Tournament, entry: TournamentEntry, reader: Reader
) -> EntryView:
    """Return an entry as a reader may see it: that of others only after the end."""
    is_own = not entry.is_reference and entry.entrant.seed == seed_of(tournament, reader)
    is_own = is_own and (reader is None or entry.entrant.seed is not None)
    has_ended = tournament.state == "ended"
    is_shown = has_ended or is_own or entry.is_reference or reader is None
    return EntryView(
        number=entry.number,
        name=_name(rooms, tournament, entry, sees_all=is_own or reader is None),
        is_reference=entry.is_reference,
        is_own=is_own,
        entry=entry.entry if is_shown else None,
        training_id=entry.training_id if is_shown else None,
        state=tournament.state_of(entry),
        judged=len(entry.judgements),
        of=tournament.rules.draws,
        judgements=list(entry.in_order()) if has_ended else None,
        entered_at=entry.entered_at,
    )


def name_for_others(rooms: RoomDirectory, tournament: Tournament, entry: TournamentEntry) -> str:
    """Return the name of an entry's entrant as all may know it, as in the tournament's file."""
    return _name(rooms, tournament, entry, sees_all=False) or f"Entry {entry.number}"


def _name(
    rooms: RoomDirectory, tournament: Tournament, entry: TournamentEntry, *, sees_all: bool
) -> str | None:
    seed, name = entry.entrant
    if seed is None:
        return name or "Operator"
    room = room_of(rooms, tournament)
    room = None if room is None else room.snapshot()
    if room is None or seed not in room.participants:
        return None
    shown: str | None = room.name_for_others(seed)
    return str(room.participants[seed].name) if sees_all else shown


def _own(services: Services, tournament: Tournament, reader: Reader) -> OwnEntries:
    """Return whether a reader may enter, a reason if not, and the entries left this hour."""
    left, next_at, reason = None, None, None
    seed = seed_of(tournament, reader)
    if seed is not None:
        left, next_at = tournament.left(Entrant(seed), services.of(Tournaments).now())
    try:
        check_may_enter(services.of(RoomDirectory), tournament, reader)
        tournament.check_not_full()
        if left == 0:
            per_hour = tournament.entries_per_hour
            reason = f"You have used up your {per_hour} entries of this hour."
    except (Forbidden, Conflict) as error:
        reason = as_sentence(str(error))
    return OwnEntries(may_enter=reason is None, reason=reason, left=left, next_at=next_at)


def publish(
    common: SharedStage, rooms: RoomDirectory, tournament: Tournament, is_deleted: bool
) -> None:
    """Publish that a tournament has changed, on the common stage and its room's; any thread."""
    progress = tournament.progress
    if is_deleted:
        progress = replace(progress, state="deleted")
    of_room = None if tournament.room is None else rooms.stage_of(tournament.room)
    for shared in filter(None, (common, of_room)):
        shared.channel.publish("tournament", progress, tournament.id)
