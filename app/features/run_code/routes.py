"""The route of a run as code."""

from fastapi import Request

from app.api.deps import ServicesDep
from app.api.policy import WATCH_RUN, api_router, policy
from app.api.record_response import RecordResponse
from app.api.runs import RunPath
from app.api.work import ANALYSIS
from app.features.run_code.run_code import CodeView, run_code

router = api_router(prefix="/runs", tags=["runs"])


@router.get("/{run_id}/code", summary="Get commands and Python that repeat a run")
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_run_code(
    services: ServicesDep, request: Request, run_id: RunPath
) -> RecordResponse[CodeView]:
    """Return commands for a shell and a Python program, each of which repeats exactly this run.

    Trainings that it uses are practised first; a table that no practice repeats is downloaded.
    """
    run = services.store.get(run_id)
    return RecordResponse(run_code(run, services.store, str(request.base_url)))
