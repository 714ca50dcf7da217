"""Routes of the stage, the run that all viewers see."""

from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app.api.answers import StageView
from app.api.deps import ServicesDep
from app.api.schemas import StageBody

router = APIRouter(prefix="/stage", tags=["stage"])


@router.get("", response_model=StageView, summary="What is on stage")
def get_stage(services: ServicesDep) -> Response:
    """Which run, at which time, how fast, by which clock."""
    return JSONResponse(services.stage.state())


@router.put("", response_model=StageView, summary="Show a run, or command the show")
def put_stage(services: ServicesDep, body: StageBody) -> Response:
    """Change the given fields; the others stay as they are."""
    services.stage.set(**body.model_dump())
    return JSONResponse(services.stage.state())
