"""Route of the preview of a robot: its properties without a simulation.

It is in the core, as it previews any robot: a built-in one, a stored one, or one in the request.
"""

from typing import Any

from pydantic import create_model

from app.api.fields import Body, record_fields
from app.api.policy import QUESTION, api_router, policy
from app.api.record_response import RecordResponse
from app.api.work import ANALYSIS
from hexapods.runs.config import WalkingProblem
from hexapods.runs.preview import Preview, preview

router = api_router(prefix="/robots", tags=["robots"])
_IRRELEVANT = {"world", "simulator", "tolerance", "reward"}
"""Fields of the walking problem that a preview does not depend on."""
_PreviewBody: Any = create_model(
    "PreviewBody", __base__=Body, **record_fields(WalkingProblem, _IRRELEVANT)
)


@router.post(
    "/preview",
    summary="Tell support, reach, states and speed of a robot before it walks",
)
@policy(access=QUESTION, work=ANALYSIS)
def preview_robot(body: _PreviewBody) -> RecordResponse[Preview]:
    """Compute support, reach and speed of a robot from gait and foot grid, without a simulation.

    `margin_m` below 0 means that the robot tips over; `better` then has groups with which it
    stands. Without slip it advances by `law_m_per_step`: 2 h / (G (1 + Σ w²)), h half the grid's
    side, G the number of groups, w their shares of the feet.
    """
    walk = WalkingProblem(**{name: getattr(body, name) for name in type(body).model_fields})
    return RecordResponse(preview(walk))
