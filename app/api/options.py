"""What there is to choose from."""

from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app.api.answers import OptionsView
from app.api.deps import Given
from app.services.catalogue import catalogue

router = APIRouter(prefix="/options", tags=["options"])


@router.get(
    "",
    response_model=OptionsView,
    summary="Gaits, robots, agents, clocks; defaults, limits and help",
)
def get_options(services: Given) -> Response:
    """All that a form needs."""
    return JSONResponse(catalogue(services.agents))
