"""Routes of the stage, which shows one run to all viewers."""

from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app.api.answers import StageView
from app.api.deps import StageDep
from app.api.schemas import StageBody

router = APIRouter(prefix="/stage", tags=["stage"])


@router.get("", response_model=StageView, summary="Get the stage's state")
def get_stage(shared: StageDep) -> Response:
    """Return the state of the stage: run, time, speed and clock."""
    return JSONResponse(shared.stage.state())


@router.put("", response_model=StageView, summary="Show a run, or change the stage's playback")
def put_stage(shared: StageDep, body: StageBody) -> Response:
    """Change the given fields; the others are unchanged."""
    shared.stage.set(**dict(body))
    return JSONResponse(shared.stage.state())
