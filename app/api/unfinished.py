"""Ends responses that cannot be completed, without a traceback in the log."""

import asyncio
import logging

import anyio
from starlette.requests import Request
from starlette.types import Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.problems import hexapod_error, problem
from app.limits.connections import client_has_left
from hexapods.domain.errors import HexapodError

_STREAM_ERRORS = (anyio.BrokenResourceError, anyio.ClosedResourceError)
_logger = logging.getLogger(__name__)


class IncompleteBodyGuard(HttpMiddleware):
    """Middleware for errors that no exception handler can answer; installed outside the guards.

    A stream may fail after its start, as when its run is deleted. It is cut off, so that its client
    takes it for no whole file; if none of it was sent yet, as `BodyMemoryLimit` holds back its
    start, the client gets the problem. A request that uvicorn cancels, since it does not end in
    time when the server stops, gets 503. FastAPI's event stream sometimes raises a broken-stream
    error when its client disconnects.
    """

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app."""
        is_started = is_disconnected = False

        async def receive_noting_disconnect() -> Message:
            nonlocal is_disconnected
            message = await receive()
            is_disconnected |= message["type"] == "http.disconnect"
            return message

        async def send_noting_start(message: Message) -> None:
            nonlocal is_started
            is_started = True
            await send(message)

        try:
            await self._app(scope, receive_noting_disconnect, send_noting_start)
        except asyncio.CancelledError:
            if not is_started:
                detail = "The server is stopping; try again later."
                refusal = problem(503, detail, headers={"Retry-After": "1"})
                await refusal(scope, receive, send)
        except Exception as error:
            # Starlette's, of a handled exception after the start of a response.
            cause = error.__cause__ if isinstance(error, RuntimeError) else None
            if is_disconnected and _is_stream_error(error):
                _logger.debug("a client disconnected during a stream")
            elif not isinstance(cause, HexapodError):
                raise
            else:
                await _end(cause, is_started, scope, receive, send)


async def _end(
    cause: HexapodError, is_started: bool, scope: Scope, receive: Receive, send: Send
) -> None:
    """Cut a response off, or answer by the problem if none of it was sent yet."""
    if client_has_left():
        _logger.debug("a client left during a response")
    elif is_started:
        _logger.warning("%s %s was cut off: %s", scope["method"], scope["path"], cause)
    else:
        answer = await hexapod_error(Request(scope), cause)
        await answer(scope, receive, send)


def _is_stream_error(error: Exception) -> bool:
    if isinstance(error, ExceptionGroup):
        return error.split(_STREAM_ERRORS)[1] is None
    return isinstance(error, _STREAM_ERRORS)
