"""The what-if route: kinematic trials of a training's settings."""

from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app.api.answers import WhatIfView
from app.api.deps import ServicesDep
from app.api.schemas import TrainingBody
from app.domain.errors import InvalidInput

router = APIRouter(prefix="/what-if", tags=["what-if"])


@router.post(
    "",
    response_model=WhatIfView,
    summary="How far 30 seeds would come after a practice, and by default",
)
def ask(services: ServicesDep, body: TrainingBody) -> Response:
    """A training's body, of at most 2,000 steps; always computed in the kinematic simulator."""
    if body.continue_from is not None:
        raise InvalidInput("a what-if begins with an empty table; leave out continue_from")
    return JSONResponse(services.what_if.ask(body.start(services.agents).config))
