"""Routes whose bodies depend on the registered agents: starts, live changes, what-ifs."""

from typing import Annotated

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from app.api.agent_bodies import AgentBodies
from app.api.answers import ExperimentView, RaceView, TrainingView, WhatIfView
from app.api.contract import LOCATION, answers
from app.api.deps import RoleDep, Services, ServicesDep, StartRequestDep
from app.api.estimates import estimate_routes
from app.api.experiment_body import ExperimentBody
from app.api.rate_limit import what_ifs_used_up, whole_seconds
from app.api.runs import RunPath, accepted, find
from app.api.schemas import BranchBody, ChangeBody, RaceBody, TrainingBody
from app.limits.addresses import client_of
from app.storage.errors import Busy
from app.what_if.what_if import MAX_STEPS, OPERATORS_LIMIT_S, SEEDS, SPECTATORS_LIMIT_S, Asker
from hexapods.domain.errors import InvalidInput


def start_routes(agents: tuple[str, ...]) -> APIRouter:
    """Return the routes, with the request bodies of the registered agents.

    Args:
        agents: names of the registered agents.
    """
    router, bodies = APIRouter(), AgentBodies(agents)
    router.include_router(estimate_routes(bodies))

    @router.post(
        "/trainings",
        tags=["trainings"],
        status_code=202,
        summary="Start a training",
        response_model=TrainingView,
        responses=answers(202, headers=LOCATION),
    )
    def start_training(
        services: ServicesDep,
        request: Request,
        start_request: StartRequestDep,
        body: Annotated[TrainingBody, bodies.training],
    ) -> Response:
        """Queue a training, and return its run."""
        jobs = services.jobs
        run = start_request.start(services, lambda key: jobs.train(body.start(), key))
        return accepted(request, jobs.view(run))

    @router.patch(
        "/trainings/{run_id}",
        tags=["trainings"],
        summary="Change pace or live settings of a training",
        response_model=TrainingView,
    )
    def change_training(
        services: ServicesDep, run_id: RunPath, body: Annotated[ChangeBody, bodies.change]
    ) -> Response:
        """Apply the change between two steps, and record it with the step's number in `changes`."""
        find(services, "training", run_id)
        return JSONResponse(services.jobs.view(services.jobs.change(run_id, body.changes())))

    @router.post(
        "/races",
        tags=["races"],
        status_code=202,
        summary="Start a race and the practice that it needs",
        response_model=RaceView,
        responses=answers(202, headers=LOCATION),
    )
    def start_race(
        services: ServicesDep,
        request: Request,
        start_request: StartRequestDep,
        body: Annotated[RaceBody | BranchBody, bodies.race],
    ) -> Response:
        """Queue the trainings of its lanes, then the race, and return the race's run.

        With `branch_from` the race repeats the first steps of another to the last bit, and goes on
        from there in another world; it takes all else from that race.
        """
        jobs = services.jobs
        run = start_request.start(services, lambda key: jobs.race(body.start(), key))
        return accepted(request, jobs.view(run))

    @router.post(
        "/experiments",
        tags=["experiments"],
        status_code=202,
        summary="Start an experiment over many seeds",
        response_model=ExperimentView,
        responses=answers(202, headers=LOCATION),
    )
    def start_experiment(
        services: ServicesDep,
        request: Request,
        start_request: StartRequestDep,
        body: Annotated[ExperimentBody, bodies.experiment],
    ) -> Response:
        """Queue an experiment, and return its run."""
        jobs, agents = services.jobs, services.agents
        run = start_request.start(services, lambda key: jobs.experiment(body.start(agents), key))
        return accepted(request, jobs.view(run))

    @router.post(
        "/what-if",
        tags=["what-if"],
        response_model=WhatIfView,
        summary=f"Compare {SEEDS} seeds of a practice with {SEEDS} of the defaults",
        description=(
            f"Take a training's body, of at most {MAX_STEPS:,} steps; always use the kinematic "
            f"simulator.\n\nIt may compute {SPECTATORS_LIMIT_S:g} s, for operators "
            f"{OPERATORS_LIMIT_S:g} s: settings that take longer are refused."
        ),
    )
    def ask(
        services: ServicesDep,
        request: Request,
        role: RoleDep,
        body: Annotated[TrainingBody, bodies.training],
    ) -> Response:
        """Return what a practice with these settings would give, on the kinematic simulator."""
        if body.continue_from is not None:
            raise InvalidInput("a what-if begins with an empty table; leave out continue_from")
        asker = Asker(check=services.stopping.check)
        if role == "spectator":
            asker = _spectator(services, client_of(request.scope))
        return JSONResponse(services.what_if.ask(body.start().config, asker))

    return router


def _spectator(services: Services, client: str) -> Asker:
    """Return the asker of a spectator's what-if, charged for what it takes beyond a second.

    Raises:
        Busy: if those before have taken more than its allowance.
    """
    limiter = services.what_if_limiter
    if (wait_s := limiter.debt_s(client)) > 0:
        told = what_ifs_used_up(services.settings.what_ifs_per_minute, wait_s)
        raise Busy(told, whole_seconds(wait_s))

    def charge(seconds: float) -> None:
        limiter.charge(client, max(0.0, seconds - 1.0))

    return Asker(is_operator=False, check=services.stopping.check, charge=charge)
