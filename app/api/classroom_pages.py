"""Pages of the classroom: of a room, of a tournament, links to lessons, a room's dashboard."""

from collections.abc import Callable, Mapping
from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute

from app.api.compression import CompressedContent
from app.api.deps import Services
from app.api.policy import WATCH, GuardedPage, Policy, policy
from app.api.problem_pages import prefers_html
from app.api.problems import as_sentence, problem
from app.api.room_access import BY_CODE, WATCH_TOURNAMENT
from app.classroom.names import normalized
from app.storage.errors import NotFound


def classroom_routes(page: CompressedContent) -> list[BaseRoute]:
    """Return the routes of links to lessons, `/l/ID`, and of rooms, `/r/CODE` and `/r/CODE/`.

    The stage of an open room serves the dashboard at `/r/CODE/`; what is left of it is other
    spellings of the code, and rooms that are not open.

    Args:
        page: of a room, the same for all.
    """
    show_room = _found_page(page, lambda own, params: own.rooms.get(params["code"]))
    return [
        GuardedPage("/l/{lesson_id}", _lesson, name="lesson_page"),
        GuardedPage("/r/{code}", show_room, Policy(access=BY_CODE), name="room_page"),
        GuardedPage("/r/{code}/", _room, name="room_stage"),
    ]


def tournament_routes(page: CompressedContent) -> list[BaseRoute]:
    """Return the route of the page of a tournament, `/t/ID`.

    Args:
        page: of a tournament, the same for all.
    """
    show_tournament = _found_page(
        page, lambda own, params: own.tournaments.get(params["tournament_id"])
    )
    watch = Policy(access=WATCH_TOURNAMENT)
    return [GuardedPage("/t/{tournament_id}", show_tournament, watch, name="tournament_page")]


def _found_page(
    page: CompressedContent, find: Callable[[Services, Mapping[str, str]], object]
) -> Callable[[Request], Response]:
    """Return the endpoint of a page; where `find` raises `NotFound` its status is 404."""

    def show(request: Request) -> Response:
        response = page.response(request.scope)
        try:
            find(request.app.state.services, request.path_params)
        except NotFound as error:
            if not prefers_html(request.headers):
                return problem(404, as_sentence(str(error)))
            # The page itself asks again, and tells what came of that.
            response.status_code = 404
        return response

    return show


@policy(access=WATCH)
def _lesson(request: Request) -> Response:
    """Lead to `/?lesson=ID`; relative, so that it is valid behind a proxy with a prefix."""
    services: Services = request.app.state.services
    lesson_id = request.path_params["lesson_id"]
    try:
        services.lessons.get(lesson_id)
    except NotFound as error:
        return problem(404, as_sentence(str(error)))
    query = request.scope["query_string"].decode("latin-1")
    return RedirectResponse(f"../?lesson={quote(lesson_id)}{'&' if query else ''}{query}", 303)


@policy(access=BY_CODE)
def _room(request: Request) -> Response:
    services: Services = request.app.state.services
    given = request.path_params["code"]
    try:
        room = services.rooms.get(given)
    except NotFound as error:
        return problem(404, as_sentence(str(error)))
    if not room.is_open:
        return problem(410, f"The room {room.code} has ended; ask for the code of a new one.")
    if normalized(given) == given:
        return problem(503, "The room is opening; try again.", headers={"Retry-After": "1"})
    return RedirectResponse(f"../{room.code}/", 303)
