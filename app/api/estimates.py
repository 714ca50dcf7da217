"""Routes that estimate how long a run would take here, from the bodies that would start it."""

from typing import Annotated

from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app.api.agent_bodies import AgentBodies
from app.api.answers import EstimateView
from app.api.deps import ServicesDep
from app.api.experiment_body import ExperimentBody
from app.api.schemas import BranchBody, RaceBody, TrainingBody
from app.jobs.submissions import BranchStart
from hexapods.domain.errors import InvalidInput


def estimate_routes(bodies: AgentBodies) -> APIRouter:
    """Return the routes, with the request bodies of the registered agents."""
    router = APIRouter()

    @router.post(
        "/trainings/estimate",
        tags=["trainings"],
        summary="Estimate how long a training would take on this server",
        response_model=EstimateView,
    )
    def estimate_training(
        services: ServicesDep, body: Annotated[TrainingBody, bodies.training]
    ) -> Response:
        """Time a few steps of the agent on this machine, and extrapolate."""
        return JSONResponse({"seconds": round(services.estimates.of(body.start()), 1)})

    @router.post(
        "/races/estimate",
        tags=["races"],
        summary="Estimate how long a race and its practice would take on this server",
        response_model=EstimateView,
    )
    def estimate_race(
        services: ServicesDep, body: Annotated[RaceBody | BranchBody, bodies.race]
    ) -> Response:
        """Time a few steps of each lane, and extrapolate; not for a race that branches off."""
        start = body.start()
        if isinstance(start, BranchStart):
            raise InvalidInput("a branch takes what is left of its race; leave out branch_from")
        return JSONResponse({"seconds": round(services.estimates.of(start), 1)})

    @router.post(
        "/experiments/estimate",
        tags=["experiments"],
        summary="Estimate how long an experiment would take on this server",
        response_model=EstimateView,
    )
    def estimate_experiment(
        services: ServicesDep, body: Annotated[ExperimentBody, bodies.experiment]
    ) -> Response:
        """Time a few steps of its agents, and extrapolate to all of its trials."""
        start = body.start(services.agents)
        return JSONResponse({"seconds": round(services.estimates.of(start), 1)})

    return router
