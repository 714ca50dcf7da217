"""Routes that export a run as an archive, and import one."""

from collections.abc import Callable

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from app.api.answers import ExperimentView, RaceView, TrainingView
from app.api.contract import ATTACHMENT, BINARY, LOCATION, answers, takes_file
from app.api.deps import ServicesDep, StartRequestDep
from app.api.formats import attachment
from app.api.runs import RunPath, find, phrase
from app.archive import archive
from app.archive.transfer import export_chunks, import_run
from app.domain.errors import InvalidInput
from app.events.run_view import run_view
from app.storage.run import KINDS, Kind

router = APIRouter()


def _export(kind: Kind) -> Callable[..., Response]:
    def export(services: ServicesDep, run_id: RunPath) -> Response:
        """Return a `.zip` that another server's import, or `hexapods import`, accepts."""
        run = find(services, kind, run_id)
        data = export_chunks(services.store, run.id, services.exports)
        return attachment(data, archive.MEDIA_TYPE, f"{kind}-{run.id}.zip")

    return export


for _kind in KINDS:
    router.add_api_route(
        f"/{_kind}s/{{run_id}}/export",
        _export(_kind),
        tags=[f"{_kind}s"],
        summary=phrase("{} with all it has", _kind),
        name=f"export_{_kind}",
        response_class=Response,
        responses=answers(200, {archive.MEDIA_TYPE: BINARY}, headers=ATTACHMENT),
    )


@router.post(
    "/import",
    status_code=201,
    tags=["trainings", "races", "experiments"],
    summary="Take in a run that was exported",
    response_model=TrainingView | RaceView | ExperimentView,
    responses=answers(201, headers=LOCATION),
    openapi_extra=takes_file("application/octet-stream"),
)
def import_archive(
    services: ServicesDep, request: Request, start_request: StartRequestDep
) -> Response:
    """Import the body, an archive. A run that exists already is not replaced but duplicated.

    A repeated request with the same `Idempotency-Key` returns the run that it imported first. The
    run keeps its id if that is free here and not in the future; the response has the actual id.
    """
    if not start_request.body:
        raise InvalidInput("send the .zip file of an exported run as the request's body")
    store, agents, ids = services.store, services.agents, services.jobs.new_id
    run = start_request.start(
        services,
        lambda key: import_run(store, start_request.body, ids, agents, "the archive", key=key),
    )
    services.bus.publish("run", run_view(run), run.id)
    location = request.url_for(f"get_{run.kind}", run_id=run.id).path
    return JSONResponse(run_view(run), 201, {"Location": location})
