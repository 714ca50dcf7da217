"""Routes of a run's walk as files for other programs."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Request
from starlette.responses import Response

from app.api.contract import ATTACHMENT, BINARY, TEXT, answers
from app.api.deps import Services, ServicesDep
from app.api.formats import attachment, negotiated
from app.api.runs import RunPath
from app.exports.recorded_lanes import RecordedWalks, checked_lane, recorded_walks
from app.exports.trajectory import (
    CSV_TYPE,
    PARQUET_TYPE,
    trajectory_csv,
    trajectory_parquet,
)
from app.storage.run import AnyRun

router = APIRouter(prefix="/runs/{run_id}", tags=["exports"])


@router.get(
    "/trajectory",
    summary="Joint angles, feet and torques over time, as CSV or Parquet",
    response_class=Response,
    responses=answers(200, {"text/csv": TEXT, PARQUET_TYPE: BINARY}, headers=ATTACHMENT),
)
def get_trajectory(
    services: ServicesDep,
    request: Request,
    run_id: RunPath,
    format: Annotated[Literal["csv", "parquet"] | None, Query()] = None,  # noqa: A002
    lane: Annotated[
        int | None, Query(ge=0, description="of a race, from 0 on; all if absent")
    ] = None,
) -> Response:
    """Return every recorded frame of a race or training that has ended, as a row of numbers.

    The columns have their units in their names; `docs/exports.md` describes them.
    """
    run = services.store.find(run_id)
    lanes = checked_lane(_walks(services, run), lane)

    def look() -> RecordedWalks:
        return _walks(services, run)

    name = f"{run.kind}-{run.id}"
    if negotiated(request, format, ("csv", "parquet")) == "parquet":
        return attachment(trajectory_parquet(look, lanes), PARQUET_TYPE, f"{name}.parquet")
    return attachment(trajectory_csv(look, lanes), CSV_TYPE, f"{name}.csv")


def _walks(services: Services, run: AnyRun) -> RecordedWalks:
    return recorded_walks(run, services.recordings)
