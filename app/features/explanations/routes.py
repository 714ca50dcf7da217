"""Routes of explanations: of a step, of a table after a step, of why a learner loses."""

from typing import Annotated

from fastapi import Query
from starlette.responses import Response

from app.api.deps import ServicesDep
from app.api.policy import WATCH_RUN, api_router, policy
from app.api.runs import RunPath, find
from app.api.work import ANALYSIS
from app.features.explanations.response_models import ExplanationView, LossView, TableView
from app.features.explanations.service import Explanations
from app.features.explanations.views import MAX_VALUES_SHOWN
from hexapods.runs.clocks import Clock

runs = api_router(prefix="/runs", tags=["runs"])
trainings = api_router(prefix="/trainings", tags=["trainings"])
races = api_router(prefix="/races", tags=["races"])


@runs.get(
    "/{run_id}/explain",
    summary="Explain why a step was taken and what was learned from it",
    response_model=ExplanationView,
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def explain_step(
    services: ServicesDep,
    run_id: RunPath,
    step: Annotated[int | None, Query(description="from 1 on; the newest if absent")] = None,
    lane: Annotated[int, Query(description="of a race, from 0 on")] = 0,
) -> Response:
    """Explain a step of a training or of a lane of a race.

    The learner is built again from what is stored, and takes the step once more: the rule of its
    update is checked, and gives the value after it to the last bit.
    """
    answer = services.of(Explanations).explain(run_id, step, lane)
    return Response(answer, media_type="application/json")


@trainings.get(
    "/{run_id}/table",
    summary="Get the Q-table after a step",
    response_model=TableView,
    description=(
        "Return values, visits and best actions as they were after a step, built again from its "
        "log.\n\nThe index of a state is the number whose digits are its cells, the first pair's "
        f"the most significant. An answer has at most {MAX_VALUES_SHOWN:,} values; `first` and "
        "`count` choose which."
    ),
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def get_table_at_step(
    services: ServicesDep,
    run_id: RunPath,
    step: Annotated[int | None, Query(description="after so many steps; newest if absent")] = None,
    first: Annotated[int, Query(ge=0, description="index of the first state")] = 0,
    count: Annotated[int, Query(ge=1, description="number of states, as far as they fit")] = 1000,
) -> Response:
    """Return a part of the table as it was after a step."""
    find(services, "training", run_id)
    answer = services.of(Explanations).table(run_id, step, first, count)
    return Response(answer, media_type="application/json")


@races.get(
    "/{run_id}/loss",
    summary="Explain why a learner with a table loses a race",
    response_model=LossView,
)
@policy(access=WATCH_RUN, work=ANALYSIS)
def explain_loss(
    services: ServicesDep,
    run_id: RunPath,
    lane: Annotated[int, Query(description="from 0 on")],
    clock: Annotated[Clock, Query(description="by which the lanes are ranked")] = "paper",
) -> Response:
    """Return how much of its table the learner had tried, and why it made no better moves.

    In each state of its walk every move is simulated, one step ahead. A lane that is not behind, or
    has no table, is refused.
    """
    run = find(services, "race", run_id)
    answer = services.of(Explanations).explain_loss(run.id, lane, clock)
    return Response(answer, media_type="application/json")
