"""Suppresses stream errors that a client's disconnect causes, so that they are not logged."""

import logging

import anyio
from starlette.types import Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware

_STREAM_ERRORS = (anyio.BrokenResourceError, anyio.ClosedResourceError)
_logger = logging.getLogger(__name__)


class Disconnects(HttpMiddleware):
    """Middleware that suppresses broken-stream errors after the client has disconnected.

    FastAPI's event stream sometimes raises them when it is cancelled.
    """

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app; suppress broken-stream errors after a disconnect."""
        is_disconnected = False

        async def receive_noting_disconnect() -> Message:
            nonlocal is_disconnected
            message = await receive()
            is_disconnected = is_disconnected or message["type"] == "http.disconnect"
            return message

        try:
            await self._app(scope, receive_noting_disconnect, send)
        except Exception as error:
            if not is_disconnected or not _is_stream_error(error):
                raise
            _logger.debug("a client disconnected during a stream")


def _is_stream_error(error: Exception) -> bool:
    if isinstance(error, ExceptionGroup):
        return error.split(_STREAM_ERRORS)[1] is None
    return isinstance(error, _STREAM_ERRORS)
