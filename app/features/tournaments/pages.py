"""The page of a tournament."""

from starlette.routing import BaseRoute

from app.api.pages import PageContent, page_of
from app.api.policy import GuardedPage, RoutePolicy
from app.features.tournaments.access import WATCH_TOURNAMENT
from app.features.tournaments.tournaments import Tournaments


def routes(page: PageContent) -> list[BaseRoute]:
    """Return the route of the page of a tournament, `/t/ID`.

    Args:
        page: of a tournament, the same for all.
    """
    show = page_of(
        page, lambda services, params: services.of(Tournaments).get(params["tournament_id"])
    )
    watch = RoutePolicy(access=WATCH_TOURNAMENT)
    return [GuardedPage("/t/{tournament_id}", show, watch, name="tournament_page")]
