"""Lets clients leave in the middle of a stream without an error in the log."""

import logging

import anyio
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_ENDED = (anyio.BrokenResourceError, anyio.ClosedResourceError)
_logger = logging.getLogger(__name__)


class Disconnects:
    """Takes the broken ends of a stream whose client has left for what they are.

    FastAPI's stream of events raises them, now and then, when it is cancelled.
    """

    def __init__(self, app: ASGIApp) -> None:
        """Guard an app."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        has_left = False

        async def noting() -> Message:
            nonlocal has_left
            message = await receive()
            has_left = has_left or message["type"] == "http.disconnect"
            return message

        try:
            await self._app(scope, noting, send)
        except Exception as error:
            if not has_left or not _is_of_a_stream(error):
                raise
            _logger.debug("a client left in the middle of a stream")


def _is_of_a_stream(error: Exception) -> bool:
    if isinstance(error, ExceptionGroup):
        return error.split(_ENDED)[1] is None
    return isinstance(error, _ENDED)
