"""Where browsers find the viewer: the page, and the websocket that it opens."""

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute

from app.viewer.hub import Hub
from app.viewer.page import ViewerPage, clean_query


def viewer_routes(hub: Hub) -> list[BaseRoute]:
    """Routes for `/viewer/`, all of them for whoever may watch. Reads viser's client once.

    Raises:
        RuntimeError: This version of viser has a client that the skin does not fit.
    """
    page = ViewerPage()

    async def show(request: Request) -> Response:
        cleaned = clean_query(request.query_params)
        if cleaned is not None:
            return RedirectResponse(f"?{cleaned}")
        return page.response(request.headers)

    async def add_slash(request: Request) -> Response:
        # Relative, so that it holds behind a proxy that serves the app under a prefix.
        return RedirectResponse(f"viewer/?{request.url.query}".removesuffix("?"))

    return [
        Route("/viewer", add_slash, name="viewer-slash"),
        Route("/viewer/", show, name="viewer"),
        # viser's client leaves the slash out where the skin does not tell it better.
        WebSocketRoute("/viewer", hub.serve, name="viewer-socket-slash"),
        WebSocketRoute("/viewer/", hub.serve, name="viewer-socket"),
    ]
