"""A client that leaves a stream is no error; an error is one all the same."""

import asyncio

import anyio
import pytest
from starlette.types import Message, Receive, Scope, Send

from app.api.disconnects import Disconnects

SCOPE: Scope = {"type": "http"}


async def gone() -> Message:
    return {"type": "http.disconnect"}


async def here() -> Message:
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
def test_who_has_left_breaks_nothing(error: Exception) -> None:
    asyncio.run(failing(error)(SCOPE, gone, ignore))
    with pytest.raises(type(error)):
        asyncio.run(failing(error)(SCOPE, here, ignore))


def test_other_errors_are_told() -> None:
    for error in (ValueError(), ExceptionGroup("", [BROKEN, ValueError()])):
        with pytest.raises(type(error)):
            asyncio.run(failing(error)(SCOPE, gone, ignore))
