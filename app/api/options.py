"""What there is to choose from."""

from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app.api.deps import Given
from app.services.catalogue import catalogue

router = APIRouter(prefix="/options", tags=["options"])


@router.get("", summary="Gaits, robots, agents, clocks; defaults, limits and help")
def get_options(services: Given) -> Response:
    """All that a form needs."""
    return JSONResponse(catalogue(services.agents))
