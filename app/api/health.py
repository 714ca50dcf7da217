"""Liveness and readiness probes."""

from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app import __version__
from app.api.answers import HealthView
from app.api.deps import ServicesDep
from app.api.problems import problem

router = APIRouter(tags=["health"])


@router.get("/healthz", response_model=HealthView, summary="Whether the server lives")
async def get_health() -> Response:
    """Liveness probe: return 200 as long as the server responds at all."""
    return JSONResponse({"status": "ok", "version": __version__})


@router.get("/readyz", response_model=HealthView, summary="Whether the server is ready to work")
def get_readiness(services: ServicesDep) -> Response:
    """Readiness probe: return 503 with the reason while something that runs need is unavailable."""
    trouble = services.ready()
    if trouble is not None:
        return problem(503, trouble, headers={"Retry-After": "1"})
    return JSONResponse({"status": "ready", "version": __version__})
