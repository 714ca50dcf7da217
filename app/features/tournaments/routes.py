"""Routes of tournaments, in which entries are judged on secret seeds and worlds."""

from functools import partial
from typing import Annotated, Any

from fastapi import APIRouter, Path, Request
from starlette.responses import Response

from app.api.answers import DeletedView
from app.api.budgeted_chunks import BudgetedChunks
from app.api.contract import ATTACHMENT, BINARY, TEXT, answers
from app.api.deps import Services, ServicesDep
from app.api.formats import attachment
from app.api.policy import ANY_PAGE, OPERATOR, api_router, policy
from app.api.record_response import RecordResponse
from app.api.work import DOWNLOAD
from app.features.tournaments.access import (
    ENTER_TOURNAMENT,
    WATCH_TOURNAMENT,
    Reader,
    ReaderDep,
)
from app.features.tournaments.ended_file import file_of
from app.features.tournaments.entered_tables import entry_of_training
from app.features.tournaments.request_bodies import EndBody, EntryBody, TournamentBody, entry_body
from app.features.tournaments.response_models import (
    EntryView,
    ListedTournament,
    TournamentList,
    TournamentView,
)
from app.features.tournaments.room_directory import RoomDirectory
from app.features.tournaments.tournament import EnteredTable, Entrant, Tournament
from app.features.tournaments.tournaments import Tournaments
from app.features.tournaments.views import (
    check_may_enter,
    check_may_know,
    entry_view,
    name_for_others,
    seed_of,
    tournament_view,
)
from app.storage.artifact_file import CHUNK_BYTES
from app.storage.errors import Forbidden
from hexapods.domain.errors import InvalidInput, about
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.tournament_file import MEDIA_TYPE

TournamentPath = Annotated[str, Path(description="id of the tournament", max_length=64)]

router = api_router(prefix="/tournaments", tags=["tournaments"])


@router.post(
    "",
    status_code=201,
    summary="Open a tournament",
    responses=answers(201, headers={"Location": {"required": True, "schema": TEXT}}),
)
@policy(access=OPERATOR, starts=True)
def open_tournament(
    services: ServicesDep, request: Request, body: TournamentBody
) -> RecordResponse[TournamentView]:
    """Open a tournament: its secret is drawn, and the secret's SHA-256 shown.

    With a room its participants may enter; without one operators alone. The references greedy,
    random walk and linear model are judged in every tournament.
    """
    rules, room = body.rules.rules(), None
    if body.room is not None:
        room = services.of(RoomDirectory).get(body.room)
        room.check_open()
    code = None if room is None else room.code
    tournament = services.of(Tournaments).create(rules, body.title, code, body.entries_per_hour)
    location = request.url_for("get_tournament", tournament_id=tournament.id).path
    view = tournament_view(request, services, tournament, None)
    return RecordResponse(view, 201, {"Location": location})


@router.get("", summary="List the tournaments that who asks may know")
@policy(access=ANY_PAGE)
def list_tournaments(services: ServicesDep, reader: ReaderDep) -> RecordResponse[TournamentList]:
    """Return all tournaments to operators; to others those without a room or of their rooms."""
    codes = {None, *dict(reader or ())}
    items = [
        ListedTournament(
            id=tournament.id,
            title=tournament.title,
            room=tournament.room,
            state=tournament.state,
            entries=tournament.entered,
            created_at=tournament.created_at,
        )
        for tournament in reversed(services.of(Tournaments).all())
        if reader is None or tournament.room in codes
    ]
    return RecordResponse(TournamentList(items=items))


@router.get("/{tournament_id}", summary="Get a tournament")
@policy(access=WATCH_TOURNAMENT, depends_on_state=False)
def get_tournament(
    services: ServicesDep, request: Request, tournament_id: TournamentPath, reader: ReaderDep
) -> RecordResponse[TournamentView]:
    """Return a tournament as the client may see it; its draws only once it has ended.

    A tournament of a room is for its participants until it or the room has ended.
    """
    tournament = _known(services, tournament_id, reader)
    return RecordResponse(tournament_view(request, services, tournament, reader))


@router.post("/{tournament_id}/end", summary="End a tournament")
@policy(access=OPERATOR)
def end_tournament(
    services: ServicesDep,
    request: Request,
    tournament_id: TournamentPath,
    body: EndBody | None = None,
) -> RecordResponse[TournamentView]:
    """Close a tournament to entries; once all are judged, secret and draws are published.

    With `withdraw_waiting` entries that are not judged yet are withdrawn, but for references.
    """
    withdraws = (body or EndBody()).withdraw_waiting
    tournament = services.of(Tournaments).end(tournament_id, withdraw_waiting=withdraws)
    return RecordResponse(tournament_view(request, services, tournament, None))


@router.get(
    "/{tournament_id}/file",
    summary="Get the file of a tournament that has ended",
    response_class=Response,
    responses=answers(200, {MEDIA_TYPE: BINARY}, headers=ATTACHMENT),
)
@policy(access=WATCH_TOURNAMENT, work=DOWNLOAD)
def get_tournament_file(
    services: ServicesDep, tournament_id: TournamentPath, reader: ReaderDep
) -> Response:
    """Return all that is needed to repeat the tournament by `hexapods verify`."""
    tournament = _known(services, tournament_id, reader)
    name_of = partial(name_for_others, services.of(RoomDirectory), tournament)
    data = file_of(services.of(Tournaments), tournament, name_of)
    parts = (data[at : at + CHUNK_BYTES] for at in range(0, len(data), CHUNK_BYTES))
    chunks = BudgetedChunks(parts, len(data), services.downloads)
    return attachment(chunks, MEDIA_TYPE, f"tournament-{tournament.id}.json")


@router.delete("/{tournament_id}", summary="Delete a tournament")
@policy(access=OPERATOR)
def delete_tournament(
    services: ServicesDep, tournament_id: TournamentPath
) -> RecordResponse[DeletedView]:
    """Delete a tournament with its entries and their tables; judging it ends.

    It can be restored for an hour, unless the disk is full.
    """
    until = services.of(Tournaments).trash(tournament_id)
    return RecordResponse(DeletedView(deleted=[tournament_id], kept=[], restorable_until=until))


@router.post("/{tournament_id}/restore", summary="Restore a tournament that was deleted")
@policy(access=OPERATOR)
def restore_tournament(
    services: ServicesDep, request: Request, tournament_id: TournamentPath
) -> RecordResponse[TournamentView]:
    """Bring back a tournament that was deleted within the last hour; one that is there stays.

    It goes on as it was: entries that are not judged yet are judged. 404 is the answer where a
    stored robot of its rules was deleted too.
    """
    tournament = services.of(Tournaments).restore(tournament_id)
    return RecordResponse(tournament_view(request, services, tournament, None))


def entry_routes(agents: tuple[str, ...]) -> APIRouter:
    """Return the route that enters a tournament, with the bodies of the registered agents.

    Args:
        agents: names of the registered agents.
    """
    entries = api_router(prefix="/tournaments")
    body_type: Any = entry_body(agents)

    @entries.post(
        "/{tournament_id}/entries",
        tags=["tournaments"],
        status_code=202,
        summary="Enter a tournament",
        responses={
            **answers(202),
            200: {"model": EntryView, "description": "an equal entry of the same entrant"},
        },
    )
    @policy(access=ENTER_TOURNAMENT)
    def enter_tournament(
        services: ServicesDep,
        tournament_id: TournamentPath,
        reader: ReaderDep,
        body: body_type,
    ) -> RecordResponse[EntryView]:
        """Enter a tournament: as a participant of its room by the name there, or as an operator.

        An entry that is equal to one of the same entrant is not entered again. A participant may
        make `entries_per_hour` entries an hour, an operator any number.
        """
        tournament = _known(services, tournament_id, reader)
        check_may_enter(services.of(RoomDirectory), tournament, reader)
        if reader is not None and body.name is not None:
            raise Forbidden("participants enter by their name in the room; leave out name")
        entry, table = _entry(services, tournament, reader, body)
        entered = services.of(Tournaments).enter(
            tournament.id,
            Entrant(seed_of(tournament, reader), body.name or ""),
            entry,
            table,
            lambda: check_may_enter(services.of(RoomDirectory), tournament, reader),
        )
        view = entry_view(services.of(RoomDirectory), tournament, entered.entry, reader)
        return RecordResponse(view, 202 if entered.is_new else 200)

    return entries


def _known(services: Services, tournament_id: str, reader: Reader) -> Tournament:
    tournament = services.of(Tournaments).get(tournament_id)
    check_may_know(services.of(RoomDirectory), tournament, reader)
    return tournament


def _entry(
    services: Services, tournament: Tournament, reader: Reader, body: Any
) -> tuple[EntryConfig, EnteredTable | None]:
    """Return the entry of a request's body, and its table; participants enter own trainings.

    Raises:
        HexapodError: if the entry is not valid.
    """
    assert isinstance(body, EntryBody)  # noqa: S101 - by the type of the route's body
    training_id = body.training_id
    if training_id is None:
        return body.entry(), None
    body.check_of_training()
    store, rules = services.store, tournament.rules
    with about("training_id"):
        _check_own(services, tournament, reader, training_id)
        return entry_of_training(store, rules, training_id, body.agent, body.robot)


def _check_own(
    services: Services, tournament: Tournament, reader: Reader, training_id: str
) -> None:
    seed = seed_of(tournament, reader)
    owner = services.of(RoomDirectory).owner_of(training_id)
    if reader is not None and owner != f"{tournament.room} {seed}":
        raise InvalidInput(f"you have no training {training_id!r} in the room; enter one of yours")
