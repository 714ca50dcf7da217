"""The route of a run as code."""

from fastapi import Request
from starlette.responses import JSONResponse, Response

from app.api.answers import Answer
from app.api.deps import ServicesDep
from app.api.policy import WATCH_RUN, api_router, policy
from app.api.runs import RunPath
from app.api.work import ANALYSIS
from app.features.run_code.run_code import run_code

router = api_router(prefix="/runs", tags=["runs"])


class CodeView(Answer):
    """A run as commands for a shell, and as a Python program."""

    command: str
    python: str


@router.get(
    "/{run_id}/code", summary="Get commands and Python that repeat a run", response_model=CodeView
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_code(services: ServicesDep, request: Request, run_id: RunPath) -> Response:
    """Return what makes exactly this run, on the command line and in Python.

    Trainings that it rests on are practised first; a table that no practice repeats is downloaded.
    """
    run = services.store.get(run_id)
    return JSONResponse(run_code(run, services.store, str(request.base_url))._asdict())
