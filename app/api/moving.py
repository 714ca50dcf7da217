"""Runs as files: out of one server, and into another."""

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from app.api.deps import Given, Start
from app.api.formats import attachment
from app.api.runs import RunPath, find
from app.domain.errors import InvalidInput
from app.services import archives
from app.services.moving import export_pieces, import_run
from app.services.views import run_view

router = APIRouter()


@router.get("/trainings/{run_id}/export", tags=["trainings"], summary="A training with all it has")
def export_training(services: Given, run_id: RunPath) -> Response:
    """A `.zip` that another server's import, or `hexapods import`, takes in."""
    run = find(services, "training", run_id)
    data = export_pieces(services.store, run.id, services.exports)
    return attachment(data, archives.MEDIA_TYPE, f"training-{run.id}.zip")


@router.get("/races/{run_id}/export", tags=["races"], summary="A race with all it has")
def export_race(services: Given, run_id: RunPath) -> Response:
    """A `.zip` that another server's import, or `hexapods import`, takes in."""
    run = find(services, "race", run_id)
    data = export_pieces(services.store, run.id, services.exports)
    return attachment(data, archives.MEDIA_TYPE, f"race-{run.id}.zip")


@router.get(
    "/experiments/{run_id}/export", tags=["experiments"], summary="An experiment with all it has"
)
def export_experiment(services: Given, run_id: RunPath) -> Response:
    """A `.zip` that another server's import, or `hexapods import`, takes in."""
    run = find(services, "experiment", run_id)
    data = export_pieces(services.store, run.id, services.exports)
    return attachment(data, archives.MEDIA_TYPE, f"experiment-{run.id}.zip")


@router.post(
    "/import",
    status_code=201,
    tags=["trainings", "races", "experiments"],
    summary="Take in a run that was exported",
    openapi_extra={
        "requestBody": {
            "content": {"application/octet-stream": {"schema": {"type": "string"}}},
            "required": True,
        }
    },
)
def import_archive(services: Given, request: Request, asked: Start) -> Response:
    """The archive is the body. A run that is here already is not replaced: it comes twice.

    Unless it is the same request again, with the same `Idempotency-Key`.
    """
    if not asked.body:
        raise InvalidInput("send the .zip file of an exported run as the request's body")
    store, agents, new_id = services.store, services.agents, services.jobs.new_id
    run = asked.once(services, lambda: import_run(store, asked.body, new_id, agents, "the archive"))
    services.bus.publish("run", run_view(run), run.id)
    location = request.url_for(f"get_{run.kind}", run_id=run.id).path
    return JSONResponse(run_view(run), 201, {"Location": location})
