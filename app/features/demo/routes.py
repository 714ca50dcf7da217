"""Routes of a demo: what a visitor may still start, and for operators who has started what."""

from collections.abc import Sequence
from typing import Annotated

from fastapi import Path

from app.api.deps import IdentityDep, RoleDep, Services, ServicesDep
from app.api.policy import OPERATOR, WATCH, api_router, policy
from app.api.record_response import RecordResponse
from app.features.demo.access import Visitor
from app.features.demo.allowance import HOUR
from app.features.demo.expiry import Expiry
from app.features.demo.response_models import AllowanceView, VisitorList, VisitorView
from app.features.demo.rows import VisitorRun
from app.features.demo.settings import DemoSettings
from app.features.demo.visitors import Visitors
from app.storage.errors import Forbidden, NotFound

VisitorPath = Annotated[str, Path(description="id of the visitor", max_length=64)]

router = api_router(tags=["demo"])
ROBOTS_TXT = "User-agent: *\nDisallow: /api/\nDisallow: /viewer/\nDisallow: /r/\nDisallow: /t/\n"
"""The page of a demo may be found."""


@router.get(
    "/allowance",
    summary="Get what a visitor of a demo may start, and what is left of it",
    responses={404: {}},
)
@policy(access=WATCH)
def get_allowance(services: ServicesDep, identity: IdentityDep) -> RecordResponse[AllowanceView]:
    """Return the limits of each visitor, what who asks has left, and the ids of their runs."""
    _check_demo(services)
    allowance = services.of(Visitors).allowance
    used = services.of(Visitors).use(identity.cookie.value if isinstance(identity, Visitor) else "")
    view = AllowanceView(
        steps_per_hour=allowance.steps_per_hour,
        steps_left=max(0, allowance.steps_per_hour - used.steps),
        steps_per_start=min(allowance.steps_per_start, allowance.steps_per_hour),
        least_steps=allowance.least_steps,
        max_unended=allowance.unended,
        unended=used.unended,
        max_kept=allowance.kept,
        seconds_per_run=allowance.seconds_per_run,
        hours=allowance.hours,
        runs=list(used.kept),
    )
    return RecordResponse(view)


@router.get(
    "/visitors",
    summary="List the visitors of a demo",
    responses={404: {}},
)
@policy(access=WATCH)
def list_visitors(services: ServicesDep, role: RoleDep) -> RecordResponse[VisitorList]:
    """Return the visitors of whom something is kept or counted; for operators alone."""
    _check_demo(services)
    if role != "operator":
        raise Forbidden("the visitors of a demo are shown to its operators alone")
    visitors = [_visitor(*item) for item in services.of(Visitors).by_visitor().items()]
    newest_first = sorted(visitors, key=lambda visitor: visitor.newest, reverse=True)
    return RecordResponse(VisitorList(items=newest_first))


def _visitor(visitor_id: str, runs: Sequence[VisitorRun]) -> VisitorView:
    newest = max(run.created_at for run in runs)
    return VisitorView(
        id=visitor_id,
        since=min(run.created_at for run in runs),
        newest=newest,
        steps=sum(run.steps for run in runs if newest - run.created_at < HOUR),
        runs=[run.run_id for run in runs],
    )


@router.delete("/visitors/{visitor_id}", status_code=204, summary="End a visitor of a demo")
@policy(access=OPERATOR)
def end_visitor(services: ServicesDep, visitor_id: VisitorPath) -> None:
    """Stop and delete all that a visitor has made, and forget the visitor."""
    _check_demo(services)
    services.of(Expiry).end_visitor(visitor_id)


def _check_demo(services: Services) -> None:
    if not services.settings.of(DemoSettings).demo:
        raise NotFound("this server is no demo; `hexapods serve --demo` makes one")
