"""Routes that export runs as an archive, and import them."""

from collections.abc import Callable, Sequence

from fastapi import APIRouter, Request
from starlette.responses import Response

from app.answer import Answer
from app.api.contract import ATTACHMENT, BINARY, LOCATION, answers, takes_file
from app.api.deps import Services, ServicesDep, StartRequest, StartRequestDep
from app.api.formats import attachment
from app.api.policy import OPERATOR, WATCH, WATCH_RUN, api_router, policy
from app.api.record_response import RecordResponse
from app.api.run_views import AnyRunView
from app.api.runs import RunIdsQuery, RunPath, find, located, phrase
from app.api.work import DOWNLOAD
from app.features.archives import archive
from app.features.archives.transfer import export_chunks, export_many, import_runs
from app.storage.run import IdempotencyKey, Kind, Run, robots_of
from app.storage.run_kind import run_kinds
from hexapods.domain.errors import InvalidInput

router = api_router()


class ImportedView(Answer):
    """Runs that were imported, in the order of their archive."""

    items: list[AnyRunView]


def _export(kind: Kind) -> Callable[..., Response]:
    @policy(access=WATCH_RUN, work=DOWNLOAD)
    def export(services: ServicesDep, run_id: RunPath) -> Response:
        """Return a `.zip` that another server's import, or `hexapods import`, accepts."""
        run = find(services, kind, run_id)
        data = export_chunks(services.store, run.id, services.downloads)
        return attachment(data, archive.MEDIA_TYPE, f"{kind}-{run.id}.zip")

    return export


def export_routes(kind: Kind) -> APIRouter:
    """Return the route that exports a run of a kind."""
    router = api_router()
    router.add_api_route(
        f"/{kind}s/{{run_id}}/export",
        _export(kind),
        tags=[f"{kind}s"],
        summary=phrase("Export {}", kind),
        name=f"export_{kind}",
        response_class=Response,
        responses=answers(200, {archive.MEDIA_TYPE: BINARY}, headers=ATTACHMENT),
    )
    return router


@router.get(
    "/runs/export",
    tags=["runs"],
    summary="Export several runs as one archive",
    response_class=Response,
    responses={
        **answers(200, {archive.MEDIA_TYPE: BINARY}, headers=ATTACHMENT),
        404: {},
        409: {},
    },
)
@policy(access=WATCH, work=DOWNLOAD)
def export_runs(services: ServicesDep, ids: RunIdsQuery) -> Response:
    """Return one `.zip` with the archive of each, which `POST /runs/import` accepts."""
    data = export_many(services.store, ids, services.downloads)
    count = len(dict.fromkeys(ids))
    return attachment(data, archive.MEDIA_TYPE, f"{count}-run{'' if count == 1 else 's'}.zip")


@router.post(
    "/runs/import",
    status_code=201,
    tags=["runs"],
    summary="Import an archive of runs",
    name="import_runs",
    openapi_extra=takes_file("application/octet-stream"),
)
@policy(access=OPERATOR, starts=True, takes_file=True)
def import_archive_of_runs(
    services: ServicesDep, start_request: StartRequestDep
) -> RecordResponse[ImportedView]:
    """Import the body, an archive, whole or not at all; otherwise as `POST /import`."""
    runs = _imported(services, start_request, is_one=False)
    return RecordResponse(ImportedView(items=[services.jobs.view(run) for run in runs]), 201)


@router.post(
    "/import",
    status_code=201,
    tags=[f"{kind}s" for kind in run_kinds()],
    summary="Import an archive of one run",
    response_model=AnyRunView,
    responses=answers(201, headers=LOCATION),
    openapi_extra=takes_file("application/octet-stream"),
)
@policy(access=OPERATOR, starts=True, takes_file=True)
def import_archive(
    services: ServicesDep, request: Request, start_request: StartRequestDep
) -> Response:
    """Import the body, an archive. A run that exists already is not replaced but duplicated.

    A repeated request with the same `Idempotency-Key` returns the run that it imported first. The
    run keeps its id if that is free here and not in the future; the response has the actual id.
    """
    (run,) = _imported(services, start_request, is_one=True)
    return located(services, request, run, 201)


def _imported(services: Services, start_request: StartRequest, *, is_one: bool) -> Sequence[Run]:
    body, store, ids = start_request.body, services.store, services.jobs.new_id
    if not body:
        raise InvalidInput("send the .zip file of an exported run as the request's body")

    def create(key: IdempotencyKey | None) -> Sequence[Run]:
        agents = services.agents
        runs = import_runs(store, body, ids, agents, "the archive", is_one=is_one, key=key)
        # One that was made by somebody else and deleted, with the same id, is the operator's now.
        for feature in services.features:
            feature.adopt([run.id for run in runs])
        return runs

    runs = start_request.runs(services, create)
    for run in runs:
        services.bus.publish_run(run)
    if any(robot.id is not None for run in runs for robot in robots_of(run.config)):
        services.publish_robots()
    return runs
