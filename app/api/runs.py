"""Routes common to all kinds of runs: list, get, stop, pause, resume, delete.

`/runs` lists and finds runs of every kind; the other routes are of one kind each.
"""

from collections.abc import Callable, Iterable
from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request
from starlette.responses import Response

from app.api.answers import (
    DeletedView,
    KeptRun,
    Page,
)
from app.api.contract import LOCATION, answers
from app.api.deps import IdentityDep, RoleDep, Services, ServicesDep, StartRequest, StartRequestDep
from app.api.descriptions import MAX_CURSOR, MAX_PAGE, MAX_RUN_IDS, MAX_SEARCH, VALID
from app.api.fields import RunId
from app.api.policy import OPERATOR, OWN_RUNS, START, WATCH, WATCH_RUN, Access, api_router, policy
from app.api.record_response import RecordResponse
from app.api.recorded_answers import CurvesView, ThinnedCurve
from app.api.run_views import AnyRunView, KindName, ListedRunView, RunPage
from app.api.schemas import AnnotationBody
from app.events.run_view import DamagedRunView, RunView
from app.jobs.jobs import Jobs
from app.jobs.submissions import CopyStart, Start
from app.storage.database.listing import Listing
from app.storage.errors import Conflict, Damaged, NotFound
from app.storage.run import AnyRun, DamagedRun, Kind, Run, Sort, State
from app.storage.run_kind import with_article
from hexapods.domain.text import MAX_TAG

MAX_POINTS = 40
"""Points of a thinned curve; its picture is a hundred pixels wide."""
RunPath = Annotated[str, Path(description="id of the run")]
RunIdsQuery = Annotated[
    list[RunId],
    Query(alias="id", min_length=1, max_length=MAX_RUN_IDS, description=VALID["id"]),
]


def _listing(
    *,
    services: ServicesDep,
    role: RoleDep,
    identity: IdentityDep,
    state: Annotated[State | None, Query(description=VALID["state"])] = None,
    search: Annotated[str | None, Query(max_length=MAX_SEARCH, description=VALID["search"])] = None,
    limit: Annotated[int, Query(ge=1, le=MAX_PAGE)] = 50,
    cursor: Annotated[str | None, Query(max_length=MAX_CURSOR, description=VALID["cursor"])] = None,
    tag: Annotated[str | None, Query(max_length=MAX_TAG, description=VALID["tag"])] = None,
    sort: Annotated[Sort, Query(description=VALID["sort"])] = "newest",
) -> Listing:
    condition = None if role == "operator" else services.features.visible_runs(identity)
    return Listing(None, state, limit, cursor, search, tag, sort, condition)


ListingDep = Annotated[Listing, Depends(_listing)]


def find(services: Services, kind: Kind, run_id: str) -> Run:
    """Return a run of this kind.

    Raises:
        NotFound: if there is no such run.
        Damaged: if its row cannot be read.
    """
    run = find_any(services, kind, run_id)
    if isinstance(run, DamagedRun):
        raise Damaged(run.id, run.damaged)
    return run


def find_any(services: Services, kind: Kind, run_id: str) -> AnyRun:
    """Return a run of this kind, or a damaged run whose kind cannot be read.

    Raises:
        NotFound: if there is no such run.
    """
    try:
        run = services.store.find(run_id)
    except NotFound:
        run = None
    if run is None or run.kind not in (kind, None):
        raise NotFound(f"there is no {kind} {run_id!r}; GET /api/v1/{kind}s lists all")
    return run


def start_run(
    services: Services, request: Request, start_request: StartRequest, start: Start
) -> Response:
    """Queue a run, unless this request did before; return the response with its Location."""
    for feature in services.features:
        response = feature.start_run(request, start_request, start)
        if response is not None:
            return response
    (run,) = start_request.runs(services, lambda key: [services.jobs.start(start, key)])
    return located(services, request, run, 202)


def located(services: Services, request: Request, run: Run, status: int) -> Response:
    """Return the response with a new run, and its Location."""
    location = request.url_for(f"get_{run.kind}", run_id=run.id).path
    return RecordResponse(services.jobs.view(run), status, {"Location": location})


router = api_router(prefix="/runs", tags=["runs"])


@router.get("", summary="List runs of every kind")
@policy(access=WATCH)
def list_runs(
    services: ServicesDep,
    listing: ListingDep,
    kind: Annotated[KindName | None, Query(description=VALID["kind"])] = None,
) -> RecordResponse[RunPage]:
    """List runs, filtered by kind, state, tag, and a part of the name, id, tags or notes."""
    return _page(RunPage, services, listing._replace(kind=kind))


@router.delete("", summary="Delete runs that have ended")
@policy(access=OWN_RUNS)
def delete_runs(services: ServicesDep, ids: RunIdsQuery) -> RecordResponse[DeletedView]:
    """Delete each run that can be deleted; the answer names the others, and why they are kept.

    What was deleted can be restored for an hour, unless the disk is full.
    """
    return RecordResponse(delete_each(ids, services.jobs.trash))


def delete_each(ids: Iterable[str], delete: Callable[[str], datetime | None]) -> DeletedView:
    """Delete each run that can be deleted, in this order; return what was deleted and kept.

    Args:
        ids: of the runs.
        delete: deletes a run, and returns until when it can be restored; None if it cannot.
    """
    deleted: dict[str, datetime | None] = {}
    kept_runs = []
    for run_id in dict.fromkeys(ids):
        try:
            deleted[run_id] = delete(run_id)
        except (NotFound, Conflict) as error:
            kept_runs.append(KeptRun(id=run_id, reason=str(error)))
    times = [time for time in deleted.values() if time is not None]
    until = min(times) if times and len(times) == len(deleted) else None
    return DeletedView(deleted=[*deleted], kept=kept_runs, restorable_until=until)


@router.get(
    "/curves",
    summary="Get a few points of several learning curves",
    description=(
        f"Return up to {MAX_POINTS} points of each training's curve, at even distances and with "
        "the newest, for small pictures. Runs without evaluations are left out."
    ),
)
@policy(access=WATCH)
def get_curves(services: ServicesDep, ids: RunIdsQuery) -> RecordResponse[CurvesView]:
    """Return thinned curves; `GET /trainings/{run_id}/curve` has all points of one."""
    points_by_run = services.store.curves.thinned(frozenset(ids), MAX_POINTS)
    curves = [
        ThinnedCurve(
            id=run_id,
            steps=[step for step, _ in points],
            distances_m=[distance_m for _, distance_m in points],
        )
        for run_id, points in sorted(points_by_run.items())
    ]
    return RecordResponse(CurvesView(curves=curves))


@router.get("/{run_id}", summary="Get a run of any kind")
@policy(access=WATCH_RUN, depends_on_state=False)
def get_run(services: ServicesDep, run_id: RunPath) -> RecordResponse[ListedRunView]:
    """Return a run of any kind by its id."""
    return RecordResponse(services.jobs.view(services.store.find(run_id)))


@router.patch("/{run_id}", summary="Rename a run, or change its tags or notes")
@policy(access=OWN_RUNS)
def annotate_run(
    services: ServicesDep, run_id: RunPath, body: AnnotationBody
) -> RecordResponse[AnyRunView]:
    """Change the name, tags or notes of a run, in any state; each is replaced as a whole."""
    return RecordResponse(services.jobs.view(services.jobs.annotate(run_id, body.changes())))


@router.post("/{run_id}/restore", summary="Restore a run that was deleted")
@policy(access=OWN_RUNS)
def restore_run(services: ServicesDep, run_id: RunPath) -> RecordResponse[ListedRunView]:
    """Bring back a run that was deleted within the last hour, as it was; one that is there stays.

    404 is the answer where it is too late, or where a stored robot of it was deleted too.
    """
    return RecordResponse(services.jobs.view(services.jobs.restore(run_id)))


@router.post(
    "/{run_id}/again",
    status_code=202,
    summary="Start a run again with the same settings",
    response_model=AnyRunView,
    responses=answers(202, headers=LOCATION),
)
@policy(access=START, starts=True)
def repeat_run(
    services: ServicesDep, request: Request, run_id: RunPath, start_request: StartRequestDep
) -> Response:
    """Queue a copy of a run, with its seed and tables, without the changes made while it ran.

    If there were none, the copy has the same result to the last bit, wall times aside.
    """
    return start_run(services, request, start_request, CopyStart(run_id))


def _page(model: Callable[..., Page], services: Services, listing: Listing) -> RecordResponse[Any]:
    page = services.store.list(**listing._asdict())
    items = [services.jobs.view(run) for run in page.items]
    return RecordResponse(model(items=items, next_cursor=page.next_cursor))


def run_routes(
    kind: Kind, view: type[RunView], page: type[Page], changed_by: Access = OWN_RUNS
) -> APIRouter:
    """Create the routes common to all kinds of runs, for one kind.

    Args:
        kind: kind of the runs.
        view: model of a run.
        page: model of a page of runs.
        changed_by: access of the routes that stop and delete its runs.
    """
    router = api_router(prefix=f"/{kind}s", tags=[f"{kind}s"])

    @router.get("", summary=f"List {kind}s", name=f"list_{kind}s", response_model=page)
    @policy(access=WATCH)
    def list_runs(services: ServicesDep, listing: ListingDep) -> Response:
        return _page(page, services, listing._replace(kind=kind))

    @router.get(
        "/{run_id}",
        summary=phrase("Get {}", kind),
        name=f"get_{kind}",
        response_model=view | DamagedRunView,
    )
    @policy(access=WATCH_RUN, depends_on_state=False)
    def get_run(services: ServicesDep, run_id: RunPath) -> Response:
        return RecordResponse(services.jobs.view(find_any(services, kind, run_id)))

    @router.delete(
        "/{run_id}",
        status_code=204,
        summary=phrase("Delete {} that has ended", kind),
        name=f"delete_{kind}",
    )
    @policy(access=changed_by)
    def delete_run(services: ServicesDep, run_id: RunPath) -> None:
        find_any(services, kind, run_id)
        services.jobs.trash(run_id)

    for verb, summary in _VERBS.items():
        access = changed_by if verb == "stop" else OPERATOR
        router.add_api_route(
            f"/{{run_id}}/{verb}",
            policy(access=access, starts=verb == "resume")(_command(kind, verb)),
            methods=["POST"],
            status_code=202,
            summary=phrase(summary, kind),
            response_model=view,
            name=f"{verb}_{kind}",
        )
    return router


_VERBS = {
    "stop": "Stop {} and keep its result so far",
    "pause": "Pause {}",
    "resume": "Resume {} that is paused, stopped, interrupted or failed",
}


def phrase(template: str, kind: Kind) -> str:
    """Insert a kind of run, with its article, into a sentence."""
    sentence = template.format(with_article(kind))
    return sentence[0].upper() + sentence[1:]


def _command(kind: Kind, verb: str) -> Callable[..., Any]:
    act = {"stop": Jobs.stop, "pause": Jobs.pause, "resume": Jobs.resume}[verb]

    def command(services: ServicesDep, run_id: RunPath) -> Response:
        find(services, kind, run_id)
        return RecordResponse(services.jobs.view(act(services.jobs, run_id)), 202)

    return command
