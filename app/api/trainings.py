"""Routes of trainings: import, disturbance, learning curve and Q-table; see also `starts`."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from fastapi import Body, Query, Request
from pydantic import BeforeValidator
from starlette.responses import JSONResponse, Response, StreamingResponse

from app.api import curves
from app.api.answers import TrainingPage
from app.api.contract import BINARY, LOCATION, TEXT, answers, takes_file
from app.api.deps import ServicesDep, StartRequestDep
from app.api.fields import Name
from app.api.formats import attachment, negotiated
from app.api.policy import OPERATOR, WATCH_RUN, policy
from app.api.record_response import RecordResponse
from app.api.recorded_answers import CurveView, QTableView
from app.api.runs import RunPath, find, located, run_routes
from app.api.work import ANALYSIS
from app.events.event_records import Evaluation
from app.events.run_view import TrainingView
from app.jobs import table_import
from app.storage.artifact_file import closing_after
from app.storage.errors import Conflict
from app.storage.run import IdempotencyKey, Run, world_of
from app.storage.stored_tables import open_table, read_rows
from hexapods.domain.disturbance_documents import AnyDisturbance, as_mapping
from hexapods.domain.errors import InvalidInput
from hexapods.runs import tables
from hexapods.runs.best_known import best_known_m
from hexapods.runs.config import TrainingConfig

router = run_routes("training", TrainingView, TrainingPage)


@router.post(
    "/import",
    status_code=201,
    summary="Import a training from a Q-table's file",
    response_model=TrainingView,
    responses=answers(201, headers=LOCATION),
    openapi_extra=takes_file("application/octet-stream"),
)
@policy(access=OPERATOR, starts=True, takes_file=True)
def import_training(
    services: ServicesDep,
    request: Request,
    start_request: StartRequestDep,
    name: Annotated[Name | None, Query()] = None,
) -> Response:
    """Import the body, an `.npz` from a training's `q-table` or from `hexapods train`."""
    if not start_request.body:
        raise InvalidInput("send the .npz file of a Q-table as the request's body")
    jobs, agents, table = services.jobs, services.agents, start_request.body

    def create(key: IdempotencyKey | None) -> Sequence[Run]:
        services.store.check_disk_space(len(table))
        return [table_import.import_table(jobs, table, agents, name, key)]

    (run,) = start_request.runs(services, create)
    return located(services, request, run, 201)


def _without_step(body: Any) -> Any:
    if isinstance(body, dict) and "at_step" in body:
        raise InvalidInput("it happens at the next step; leave out at_step")
    return body


@router.post(
    "/{run_id}/disturbances",
    status_code=202,
    summary="Disturb a running training",
    response_model=AnyDisturbance,
    responses=answers(202),
)
@policy(access=OPERATOR)
def disturb_training(
    services: ServicesDep,
    run_id: RunPath,
    body: Annotated[AnyDisturbance, BeforeValidator(_without_step), Body()],
) -> Response:
    """Apply a disturbance from the next step on; return it with that step.

    Leave out `at_step`. A later disturbance of the same thing replaces an earlier one, and
    `repair` ends what happened to legs.
    """
    find(services, "training", run_id)
    happened = services.jobs.disturb(run_id, body)
    return JSONResponse(as_mapping(happened), 202)


@router.get(
    "/{run_id}/curve",
    summary="Get the learning curve (JSON, CSV)",
    responses=answers(200, {"text/csv": TEXT}),
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_curve(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    format: Annotated[Literal["json", "csv"] | None, Query()] = None,  # noqa: A002
) -> RecordResponse[CurveView] | Response:
    """Return the evaluations so far, with greedy's and the best known distance to compare."""
    run = find(services, "training", run_id)
    rows = services.store.curves.get(run_id)
    if negotiated(request, format, ("json", "csv")) == "csv":
        return attachment(curves.as_csv(rows), "text/csv; charset=utf-8", f"curve-{run_id}.csv")
    curve = CurveView(
        evaluations=[Evaluation(**row) for row in rows],
        greedy_distance_m=run.greedy_distance_m,
        best_known_m=_best_known_m(run),
    )
    return RecordResponse(curve)


def _best_known_m(run: Run) -> float | None:
    """Return the best known distance in a training's present world [m]; None if none is known."""
    if not isinstance(run.config, TrainingConfig):
        return None
    step = min(run.done, run.config.steps - 1)
    return best_known_m(run.config, world_of(run).as_of(step))


@router.get(
    "/{run_id}/q-table",
    summary="Get the Q-table (JSON, .npz, CSV)",
    response_model=QTableView,
    responses=answers(200, {"text/csv": TEXT, tables.MEDIA_TYPE: BINARY}),
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_q_table(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    format: Annotated[Literal["json", "npz", "csv"] | None, Query()] = None,  # noqa: A002
) -> Response:
    """Return the values of all legal actions in all states; the `.npz` can be trained further."""
    run = find(services, "training", run_id)
    file = open_table(services.store, run_id)
    kind = negotiated(request, format, ("json", "npz", "csv"))
    if kind == "npz":
        return attachment(file, tables.MEDIA_TYPE, f"q-table-{run_id}.npz")
    try:
        file_of_table = read_rows(file, run_id)
    except InvalidInput as error:
        file.close()
        raise Conflict(f"{error}; take it as ?format=npz", run.state) from error
    if kind == "csv":
        rows = closing_after(file, curves.table_as_csv(file_of_table.table))
        return attachment(rows, "text/csv; charset=utf-8", f"q-table-{run_id}.csv")
    rows = closing_after(file, curves.table_as_json(file_of_table.table, file_of_table.meta))
    return StreamingResponse(rows, media_type="application/json")
