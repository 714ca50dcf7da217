"""Routes whose bodies depend on the registered agents: starts of runs, and live changes."""

from collections.abc import Iterable
from typing import Any, NamedTuple

from fastapi import APIRouter, Request
from starlette.responses import Response

from app.api.agent_bodies import agent_bodies
from app.api.contract import LOCATION, answers
from app.api.deps import ServicesDep, StartRequestDep
from app.api.policy import OPERATOR, START, Access, api_router, policy
from app.api.record_response import RecordResponse
from app.api.runs import RunPath, find, start_run
from app.events.run_view import RaceView, RunView, TrainingView
from app.storage.run import Kind


class StartKind(NamedTuple):
    """A kind of run that can be started.

    Attributes:
        kind: of the run.
        body: type of the request's body, whose `start()` returns what is started.
        thing: what is started, for the summary.
        description: of the route.
        view: model of the run.
        access: who may start it.
    """

    kind: Kind
    body: Any
    thing: str
    description: str
    view: type[RunView]
    access: Access = START


def start_kinds(agents: tuple[str, ...]) -> tuple[StartKind, ...]:
    """Return the kinds of the core that can be started, with bodies of the registered agents.

    Args:
        agents: names of the registered agents.
    """
    bodies = agent_bodies(agents)
    return (
        StartKind(
            "training",
            bodies.training,
            "a training",
            "Queue a training, and return its run.",
            TrainingView,
        ),
        StartKind(
            "race",
            bodies.race,
            "a race and the practice that it needs",
            "Queue the trainings of its lanes, then the race, and return the race's run.\n\n"
            "With `branch_from` the race repeats the first steps of another to the last bit, and "
            "goes on\nfrom there in another world; it takes all else from that race.",
            RaceView,
        ),
    )


def start_routes(agents: tuple[str, ...], kinds: Iterable[StartKind]) -> APIRouter:
    """Return the routes, with the request bodies of the registered agents.

    Args:
        agents: names of the registered agents.
        kinds: of runs that can be started.
    """
    router = api_router()
    change_body: Any = agent_bodies(agents).change
    for start in kinds:
        _add_start(router, start)

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
        return RecordResponse(services.jobs.view(services.jobs.change(run_id, body.changes())))

    return router


def _add_start(router: APIRouter, start: StartKind) -> None:
    """Add the route that starts a run of this kind."""
    body_type: Any = start.body

    @router.post(
        f"/{start.kind}s",
        tags=[f"{start.kind}s"],
        status_code=202,
        summary=f"Start {start.thing}",
        description=start.description,
        response_model=start.view,
        responses=answers(202, headers=LOCATION),
        name=f"start_{start.kind}",
    )
    @policy(access=start.access, starts=True)
    def start_of_kind(
        services: ServicesDep,
        request: Request,
        start_request: StartRequestDep,
        body: body_type,
    ) -> Response:
        return start_run(services, request, start_request, body.start())
