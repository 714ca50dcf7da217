"""Routes of a demo: what a visitor may still start, and for operators who has started what."""

from datetime import timedelta
from typing import Annotated

from fastapi import Path, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response

from app.api.answers import AllowanceView, VisitorList
from app.api.deps import ReaderDep, Services, ServicesDep, VisitorDep
from app.api.policy import OPERATOR, WATCH, GuardedPage, api_router, policy
from app.demo.allowance import HOUR
from app.storage.errors import Forbidden, NotFound

VisitorPath = Annotated[str, Path(description="id of the visitor", max_length=64)]

router = api_router(tags=["demo"])
_OF_A_DEMO = "User-agent: *\nDisallow: /api/\nDisallow: /viewer/\nDisallow: /r/\nDisallow: /t/\n"
_OF_OTHERS = "User-agent: *\nDisallow: /\n"


@router.get(
    "/allowance",
    summary="Get what a visitor of a demo may start, and what is left of it",
    response_model=AllowanceView,
    responses={404: {}},
)
@policy(access=WATCH)
def get_allowance(services: ServicesDep, visitor: VisitorDep) -> Response:
    """Return the limits of each visitor, what who asks has left, and the ids of their runs."""
    _check_demo(services)
    allowance = services.visitors.allowance
    used = services.visitors.use("" if visitor is None else visitor.value)
    answer = {
        "steps_per_hour": allowance.steps_per_hour,
        "steps_left": max(0, allowance.steps_per_hour - used.steps),
        "steps_per_start": min(allowance.steps_per_start, allowance.steps_per_hour),
        "least_steps": allowance.least_steps,
        "max_unended": allowance.unended,
        "unended": used.unended,
        "max_kept": allowance.kept,
        "seconds_per_run": allowance.seconds_per_run,
        "hours": allowance.hours,
        "runs": list(used.kept),
    }
    return JSONResponse(answer)


@router.get(
    "/visitors",
    summary="List the visitors of a demo",
    response_model=VisitorList,
    responses={404: {}},
)
@policy(access=WATCH)
def list_visitors(services: ServicesDep, reader: ReaderDep) -> Response:
    """Return the visitors of whom something is kept or counted; for operators alone."""
    _check_demo(services)
    if reader is not None:
        raise Forbidden("the visitors of a demo are shown to its operators alone")
    items = []
    for visitor, runs in services.visitors.by_visitor().items():
        newest = max(one.created_at for one in runs)
        items.append(
            {
                "id": visitor,
                "since": min(one.created_at for one in runs).isoformat(),
                "newest": newest.isoformat(),
                "steps": sum(one.steps for one in runs if newest - one.created_at < HOUR),
                "runs": [one.run_id for one in runs],
            }
        )
    return JSONResponse({"items": sorted(items, key=lambda one: str(one["newest"]), reverse=True)})


@router.delete("/visitors/{visitor_id}", status_code=204, summary="End a visitor of a demo")
@policy(access=OPERATOR)
def end_visitor(services: ServicesDep, visitor_id: VisitorPath) -> None:
    """Stop and delete all that a visitor has made, and forget the visitor."""
    _check_demo(services)
    services.expiry.end_visitor(visitor_id)


def robots_txt(*, is_demo: bool) -> GuardedPage:
    """Return the route of `/robots.txt`: of a demo the page may be found, of others nothing."""

    @policy(access=WATCH)
    async def show(request: Request) -> Response:
        del request
        headers = {"Cache-Control": f"max-age={int(timedelta(days=1).total_seconds())}"}
        return PlainTextResponse(_OF_A_DEMO if is_demo else _OF_OTHERS, headers=headers)

    return GuardedPage("/robots.txt", show, name="robots_txt")


def _check_demo(services: Services) -> None:
    if not services.settings.demo:
        raise NotFound("this server is no demo; `hexapods serve --demo` makes one")
