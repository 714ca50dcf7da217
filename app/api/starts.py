"""Routes whose bodies depend on the registered agents: starts, live changes, what-ifs."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import JSONResponse, Response

from app.api.agent_bodies import agent_bodies
from app.api.answers import EstimateView, TrainingView, WhatIfView
from app.api.contract import LOCATION, answers
from app.api.deps import RoleDep, Services, ServicesDep, StartRequestDep
from app.api.policy import OPERATOR, QUESTION, api_router, policy
from app.api.rate_limit import what_ifs_used_up, whole_seconds
from app.api.runs import VIEWS, RunPath, find, start_access, start_run
from app.limits.addresses import client_of
from app.storage.errors import Busy
from app.storage.run import Kind
from app.what_if.what_if import MAX_STEPS, OPERATORS_LIMIT_S, SEEDS, SPECTATORS_LIMIT_S, Asker
from hexapods.domain.errors import InvalidInput


def start_routes(agents: tuple[str, ...]) -> APIRouter:
    """Return the routes, with the request bodies of the registered agents.

    Args:
        agents: names of the registered agents.
    """
    router, bodies = api_router(), agent_bodies(agents)
    training_body: Any = bodies.training
    change_body: Any = bodies.change
    _add_starts(
        router,
        "training",
        training_body,
        start=("a training", "Queue a training, and return its run."),
        estimate=("a training", "Time a few steps of the agent on this machine, and extrapolate."),
    )
    _add_starts(
        router,
        "race",
        bodies.race,
        start=(
            "a race and the practice that it needs",
            "Queue the trainings of its lanes, then the race, and return the race's run.\n\n"
            "With `branch_from` the race repeats the first steps of another to the last bit, and "
            "goes on\nfrom there in another world; it takes all else from that race.",
        ),
        estimate=(
            "a race and its practice",
            "Time a few steps of each lane, and extrapolate; not for a race that branches off.",
        ),
    )
    _add_starts(
        router,
        "experiment",
        bodies.experiment,
        start=("an experiment over many seeds", "Queue an experiment, and return its run."),
        estimate=(
            "an experiment",
            "Time a few steps of its agents, and extrapolate to all of its trials.",
        ),
    )

    @router.patch(
        "/trainings/{run_id}",
        tags=["trainings"],
        summary="Change pace or live settings of a training",
        response_model=TrainingView,
    )
    @policy(access=OPERATOR)
    def change_training(services: ServicesDep, run_id: RunPath, body: change_body) -> Response:
        """Apply the change between two steps, and record it with the step's number in `changes`."""
        find(services, "training", run_id)
        return JSONResponse(services.jobs.view(services.jobs.change(run_id, body.changes())))

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
    @policy(access=QUESTION, work="what-if")
    def ask(
        services: ServicesDep, request: Request, role: RoleDep, body: training_body
    ) -> Response:
        """Return what a practice with these settings would give, on the kinematic simulator."""
        if body.continue_from is not None:
            raise InvalidInput("a what-if begins with an empty table; leave out continue_from")
        asker = Asker(check=services.stopping.check)
        if role == "spectator":
            asker = spectators_asker(services, client_of(request.scope))
        return JSONResponse(services.what_if.ask(body.start().config, asker))

    return router


def _add_starts(
    router: APIRouter, kind: Kind, body_type: Any, start: tuple[str, str], estimate: tuple[str, str]
) -> None:
    """Add the routes that start a run, and that estimate how long it would take.

    Args:
        router: receives the routes.
        kind: of the run.
        body_type: type of the body of both.
        start: what is started, for the summary, and a description.
        estimate: likewise, of what is estimated.
    """

    @policy(access=start_access(kind), starts=True)
    def start_of_kind(
        services: ServicesDep,
        request: Request,
        start_request: StartRequestDep,
        body: body_type,
    ) -> Response:
        return start_run(services, request, start_request, body.start())

    @policy(access=OPERATOR)
    def estimate_of_kind(
        services: ServicesDep,
        body: body_type,
    ) -> Response:
        start, estimates = body.start(), services.estimates
        seconds = round(estimates.of(start), 1)
        return JSONResponse({"seconds": seconds, "workers": estimates.workers_of(start)})

    router.add_api_route(
        f"/{kind}s",
        start_of_kind,
        methods=["POST"],
        tags=[f"{kind}s"],
        status_code=202,
        summary=f"Start {start[0]}",
        description=start[1],
        response_model=VIEWS[kind][0],
        responses=answers(202, headers=LOCATION),
        name=f"start_{kind}",
    )
    router.add_api_route(
        f"/{kind}s/estimate",
        estimate_of_kind,
        methods=["POST"],
        tags=[f"{kind}s"],
        summary=f"Estimate how long {estimate[0]} would take on this server",
        description=estimate[1],
        response_model=EstimateView,
        name=f"estimate_{kind}",
    )


def spectators_asker(services: Services, client: str) -> Asker:
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
