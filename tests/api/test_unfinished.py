"""Responses that cannot be completed: an error after their start, the end of server or client."""

import asyncio
import logging
from collections.abc import Iterator

import anyio
import pytest
from fastapi import FastAPI
from starlette.responses import StreamingResponse
from starlette.types import Message, Receive, Scope

from app.api import problems
from app.api.memory_limit import BodyMemoryLimit
from app.api.unfinished import IncompleteBodyGuard
from app.storage.errors import NotFound
from tests.api.guarding import admitted

SCOPE: Scope = {
    "type": "http",
    "method": "GET",
    "path": "/",
    "query_string": b"",
    "headers": [],
    "state": admitted("operator"),
}


async def receive() -> Message:
    await asyncio.Event().wait()
    raise AssertionError


def streaming(chunks: int) -> FastAPI:
    """An app whose stream fails after some chunks: its run was deleted."""
    app = FastAPI()

    def parts() -> Iterator[bytes]:
        for _ in range(chunks):
            yield b"x"
        raise NotFound("there is no run 'r' (any more)")

    @app.get("/")
    def stream() -> StreamingResponse:
        return StreamingResponse(parts())

    problems.install(app)
    app.add_middleware(BodyMemoryLimit)
    app.add_middleware(IncompleteBodyGuard)
    return app


def sent_by(app: FastAPI) -> list[Message]:
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    asyncio.run(app(dict(SCOPE), receive, send))
    return sent


def test_an_error_before_the_first_chunk_is_a_problem() -> None:
    start, body = sent_by(streaming(0))
    assert start["status"] == 404
    assert b"There is no run" in body["body"]


def test_an_error_in_a_stream_cuts_it_off_without_a_traceback(
    caplog: pytest.LogCaptureFixture,
) -> None:
    start, *chunks = sent_by(streaming(2))
    assert start["status"] == 200
    assert [chunk["more_body"] for chunk in chunks] == [True, True], "not complete"
    (record,) = caplog.records
    assert record.levelno == logging.WARNING
    assert record.exc_info is None
    assert "there is no run 'r'" in record.getMessage()


def test_a_request_that_is_cancelled_is_answered() -> None:
    """Uvicorn cancels those that do not end in time when the server stops."""

    async def scenario() -> list[Message]:
        sent: list[Message] = []

        async def wait(scope: Scope, receive: object, send: object) -> None:
            await asyncio.Event().wait()

        async def send(message: Message) -> None:
            sent.append(message)

        task = asyncio.ensure_future(IncompleteBodyGuard(wait)(dict(SCOPE), receive, send))
        await asyncio.sleep(0)
        task.cancel()
        await task
        return sent

    start, body = asyncio.run(scenario())
    assert start["status"] == 503
    assert (b"retry-after", b"1") in start["headers"]
    assert b"The server is stopping" in body["body"]


def test_other_errors_are_raised() -> None:
    async def broken(scope: Scope, receive: object, send: object) -> None:
        raise RuntimeError("unexpected")

    async def send(message: Message) -> None:
        del message

    with pytest.raises(RuntimeError, match="unexpected"):
        asyncio.run(IncompleteBodyGuard(broken)(dict(SCOPE), receive, send))


async def receive_disconnect() -> Message:
    return {"type": "http.disconnect"}


async def receive_request() -> Message:
    return {"type": "http.request", "body": b"", "more_body": False}


async def ignore(message: Message) -> None:
    del message


def failing(error: Exception) -> IncompleteBodyGuard:
    async def app(scope: Scope, receive: Receive, send: object) -> None:
        await receive()
        raise error

    return IncompleteBodyGuard(app)


BROKEN = anyio.BrokenResourceError()


@pytest.mark.parametrize("error", [BROKEN, ExceptionGroup("", [ExceptionGroup("", [BROKEN])])])
def test_a_stream_error_after_a_disconnect_is_suppressed(error: Exception) -> None:
    asyncio.run(failing(error)(dict(SCOPE), receive_disconnect, ignore))
    with pytest.raises(type(error)):
        asyncio.run(failing(error)(dict(SCOPE), receive_request, ignore))


def test_other_errors_after_a_disconnect_are_raised() -> None:
    for error in (ValueError(), ExceptionGroup("", [BROKEN, ValueError()])):
        with pytest.raises(type(error)):
            asyncio.run(failing(error)(dict(SCOPE), receive_disconnect, ignore))
