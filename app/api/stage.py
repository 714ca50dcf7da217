"""Routes of the stage, which shows one run to all viewers."""

from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import APIRouter
from pydantic import create_model
from starlette.responses import Response

from app.api.deps import StageDep
from app.api.fields import known_members
from app.api.policy import OPERATOR, WATCH_STAGE, api_router, policy
from app.api.record_response import RecordResponse
from app.api.schemas import StageBody
from app.feature import Feature, stage_members
from app.stage.stage_view import stage_view


def stage_routes(features: Sequence[type[Feature]]) -> APIRouter:
    """Return the routes of the stage, with what it keeps for features."""
    router = api_router(prefix="/stage", tags=["stage"])
    kinds = stage_members(features)
    view = stage_view(tuple(kinds.items()))
    added: dict[str, Any] = {
        name: (Annotated[kind, known_members(kind)] | None, None) for name, kind in kinds.items()
    }
    stage_body = create_model("StageBody", __base__=StageBody, __doc__=StageBody.__doc__, **added)

    @router.get("", response_model=view, summary="Get the stage's state")
    @policy(access=WATCH_STAGE)
    def get_stage(shared: StageDep) -> Response:
        """Return the state of the stage: run, time, speed and clock."""
        return RecordResponse(shared.stage.state())

    @router.put("", response_model=view, summary="Show a run, or change the stage's playback")
    @policy(access=OPERATOR)
    def put_stage(shared: StageDep, body: stage_body) -> Response:  # type: ignore[valid-type]
        """Change the given fields; the others are unchanged."""
        changes: dict[str, Any] = dict(body)
        members = {name: changes.pop(name) for name in kinds}
        changed_members = {name: member for name, member in members.items() if member is not None}
        shared.stage.set(**changes, members=changed_members)
        return RecordResponse(shared.stage.state())

    return router
