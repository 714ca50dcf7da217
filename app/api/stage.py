"""Routes of the stage, which shows one run to all viewers."""

from starlette.responses import JSONResponse, Response

from app.api.answers import StageView
from app.api.deps import StageDep
from app.api.policy import OPERATOR, WATCH_STAGE, api_router, policy
from app.api.schemas import StageBody

router = api_router(prefix="/stage", tags=["stage"])


@router.get("", response_model=StageView, summary="Get the stage's state")
@policy(access=WATCH_STAGE)
def get_stage(shared: StageDep) -> Response:
    """Return the state of the stage: run, time, speed and clock."""
    return JSONResponse(shared.stage.state())


@router.put("", response_model=StageView, summary="Show a run, or change the stage's playback")
@policy(access=OPERATOR)
def put_stage(shared: StageDep, body: StageBody) -> Response:
    """Change the given fields; the others are unchanged."""
    shared.stage.set(**dict(body))
    return JSONResponse(shared.stage.state())
