"""Ends responses that cannot be completed, without a traceback in the log."""

import asyncio
import logging

from starlette.requests import Request
from starlette.types import Message, Receive, Scope, Send

from app.api.middleware import HttpMiddleware
from app.api.problems import hexapod_error, problem
from app.limits.connections import client_has_left
from hexapods.domain.errors import HexapodError

_logger = logging.getLogger(__name__)


class Unfinished(HttpMiddleware):
    """Middleware for errors that no exception handler can answer; installed outside `HeldBodies`.

    A stream may fail after its start, as when its run is deleted. It is cut off, so that its client
    takes it for no whole file; if none of it was sent yet (`HeldBodies` holds back its start), the
    client gets the problem. A request that uvicorn cancels, since it does not end in time when the
    server stops, gets 503.
    """

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the app."""
        is_started = False

        async def send_noting_start(message: Message) -> None:
            nonlocal is_started
            is_started = True
            await send(message)

        try:
            await self._app(scope, receive, send_noting_start)
        except asyncio.CancelledError:
            if not is_started:
                detail = "The server is stopping; try again later."
                refusal = problem(503, detail, headers={"Retry-After": "1"})
                await refusal(scope, receive, send)
        except RuntimeError as error:
            # Starlette's, of a handled exception after the start of a response.
            cause = error.__cause__
            if not isinstance(cause, HexapodError):
                raise
            if client_has_left():
                _logger.debug("a client left during a response")
            elif is_started:
                _logger.warning("%s %s was cut off: %s", scope["method"], scope["path"], cause)
            else:
                answer = await hexapod_error(Request(scope), cause)
                await answer(scope, receive, send)
