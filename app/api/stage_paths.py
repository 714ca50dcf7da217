"""Tells by the path of a request which stage it is about."""

from collections.abc import Sequence

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.viewer.shared_stage import SharedStage


class StagePaths(HttpMiddleware):
    """Middleware that finds the stage of a request; the page and all routes are below each path.

    The stage's path is added to the request's root path (ASGI), so that routes match what follows
    it, and addresses that are made from the request begin with it. The stage is stored in the
    scope's state.
    """

    def __init__(self, app: ASGIApp, stages: Sequence[SharedStage]) -> None:
        """Wrap an app.

        Args:
            app: the wrapped app.
            stages: all stages, which may change; the first has the path "".
        """
        super().__init__(app)
        self._stages = stages

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app."""
        path = path_of(scope)
        matching = (stage_ for stage_ in self._stages if path.startswith(f"{stage_.path}/"))
        stage = max(matching, key=lambda shared: len(shared.path), default=self._stages[0])
        scope.setdefault("state", {})["stage"] = stage
        scope["root_path"] = scope.get("root_path", "") + stage.path
        await self._app(scope, receive, send)


def stage_of(scope: Scope) -> SharedStage:
    """Return the stage of a request; to be called inside `StagePaths`."""
    stage: SharedStage = scope["state"]["stage"]
    return stage


def path_of(scope: Scope) -> str:
    """Return the path of a request below that of its stage, or before `StagePaths` the server's."""
    path: str = scope["path"]
    return path.removeprefix(scope.get("root_path", ""))
