"""Stream errors after a disconnect are suppressed; other errors are raised."""

import asyncio

import anyio
import pytest
from starlette.types import Message, Receive, Scope, Send

from app.api.disconnects import Disconnects

SCOPE: Scope = {"type": "http"}


async def receive_disconnect() -> Message:
    return {"type": "http.disconnect"}


async def receive_request() -> Message:
    return {"type": "http.request", "body": b"", "more_body": False}


async def ignore(message: Message) -> None:
    del message


def failing(error: Exception) -> Disconnects:
    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        await receive()
        raise error

    return Disconnects(app)


BROKEN = anyio.BrokenResourceError()


@pytest.mark.parametrize("error", [BROKEN, ExceptionGroup("", [ExceptionGroup("", [BROKEN])])])
def test_stream_error_after_a_disconnect_is_suppressed(error: Exception) -> None:
    asyncio.run(failing(error)(SCOPE, receive_disconnect, ignore))
    with pytest.raises(type(error)):
        asyncio.run(failing(error)(SCOPE, receive_request, ignore))


def test_other_errors_are_raised() -> None:
    for error in (ValueError(), ExceptionGroup("", [BROKEN, ValueError()])):
        with pytest.raises(type(error)):
            asyncio.run(failing(error)(SCOPE, receive_disconnect, ignore))
