"""Pages of the classroom: of a room, links to lessons, their sheets, a room's dashboard."""

from urllib.parse import quote

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import BaseRoute

from app.api.deps import Services
from app.api.descriptions import as_sentence
from app.api.pages import PageContent, page_of
from app.api.policy import OPERATOR, WATCH, GuardedPage, RoutePolicy, policy
from app.api.problems import problem
from app.api.stage_paths import stage_of
from app.features.classroom.access import BY_CODE
from app.features.classroom.lesson_sheet import sheet_of
from app.features.classroom.lessons import Lessons
from app.features.classroom.names import normalized
from app.features.classroom.rooms import Rooms
from app.storage.errors import NotFound


def routes(page: PageContent) -> list[BaseRoute]:
    """Return the routes of lessons, `/l/ID` and its sheet, and of rooms, `/r/CODE` and `/r/CODE/`.

    The stage of an open room serves the dashboard at `/r/CODE/`; what is left of it is other
    spellings of the code, and rooms that are not open.

    Args:
        page: of a room, the same for all.
    """
    show_room = page_of(page, lambda services, params: services.of(Rooms).get(params["code"]))
    return [
        GuardedPage("/l/{lesson_id}", _lesson, name="lesson_page"),
        GuardedPage("/l/{lesson_id}/sheet", _sheet, name="lesson_sheet"),
        GuardedPage("/r/{code}", show_room, RoutePolicy(access=BY_CODE), name="room_page"),
        GuardedPage("/r/{code}/", _room, name="room_stage"),
    ]


@policy(access=WATCH)
def _lesson(request: Request) -> Response:
    """Lead to `/?lesson=ID`; relative, so that it is valid behind a proxy with a prefix."""
    services: Services = request.app.state.services
    lesson_id = request.path_params["lesson_id"]
    try:
        services.of(Lessons).get(lesson_id)
    except NotFound as error:
        return problem(404, as_sentence(str(error)))
    query = request.scope["query_string"].decode("latin-1")
    return RedirectResponse(f"../?lesson={quote(lesson_id)}{'&' if query else ''}{query}", 303)


@policy(access=OPERATOR)
def _sheet(request: Request) -> Response:
    """Show the sheet of a lesson for its teacher, which has the answers."""
    services: Services = request.app.state.services
    try:
        stored = services.of(Lessons).get(request.path_params["lesson_id"])
    except NotFound as error:
        return problem(404, as_sentence(str(error)))
    return HTMLResponse(sheet_of(stored.lesson))


@policy(access=BY_CODE)
def _room(request: Request) -> Response:
    services: Services = request.app.state.services
    code = request.path_params["code"]
    try:
        room = services.of(Rooms).get(code)
    except NotFound as error:
        return problem(404, as_sentence(str(error)))
    if not room.is_open:
        return problem(410, f"The room {room.code} has ended; ask for the code of a new one.")
    if stage_of(request.scope).path:  # the dashboard of a stage, below which there is no room
        raise HTTPException(404)
    if normalized(code) == code:
        return problem(503, "The room is opening; try again.", headers={"Retry-After": "1"})
    return RedirectResponse(f"../{room.code}/", 303)
