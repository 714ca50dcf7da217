"""Runs as files: out of one server, and into another."""

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect
from starlette.responses import JSONResponse, Response

from app.api.deps import Given
from app.api.formats import attachment
from app.api.runs import RunPath, find
from app.domain.errors import InvalidInput
from app.services import archives
from app.services.moving import export_run, import_run
from app.services.views import run_view

router = APIRouter()


@router.get("/trainings/{run_id}/export", tags=["trainings"], summary="A training with all it has")
def export_training(services: Given, run_id: RunPath) -> Response:
    """A `.zip` that another server's import, or `hexapods import`, takes in."""
    run = find(services, "training", run_id)
    data = export_run(services.store, run.id)
    return attachment(data, archives.MEDIA_TYPE, f"training-{run.id}.zip")


@router.get("/races/{run_id}/export", tags=["races"], summary="A race with all it has")
def export_race(services: Given, run_id: RunPath) -> Response:
    """A `.zip` that another server's import, or `hexapods import`, takes in."""
    run = find(services, "race", run_id)
    data = export_run(services.store, run.id)
    return attachment(data, archives.MEDIA_TYPE, f"race-{run.id}.zip")


@router.post(
    "/import",
    status_code=201,
    tags=["trainings", "races"],
    summary="Take in a run that was exported",
    openapi_extra={
        "requestBody": {
            "content": {"application/octet-stream": {"schema": {"type": "string"}}},
            "required": True,
        }
    },
)
async def import_archive(services: Given, request: Request) -> Response:
    """The archive is the body. A run that is here already is not replaced: it comes twice."""
    try:
        data = await request.body()
    except ClientDisconnect:
        return Response(status_code=400)
    if not data:
        raise InvalidInput("send the .zip file of an exported run as the request's body")
    store, agents = services.store, services.agents
    run = await run_in_threadpool(
        import_run, store, data, services.jobs.new_id, agents, "the archive"
    )
    services.bus.publish("run", run_view(run), run.id)
    location = request.url_for(f"get_{run.kind}", run_id=run.id).path
    return JSONResponse(run_view(run), 201, {"Location": location})
