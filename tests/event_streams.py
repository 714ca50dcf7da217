"""Client of the event stream, which watches the stage as a page does, by the pieces in it."""

import base64
import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

import httpx2

from tests.drawing.replay_decoding import decoded

PATH = "/api/v1/events"
WITH_PICTURE = f"{PATH}?picture=true"


class ReceivedEvent(NamedTuple):
    """One server-sent event."""

    name: str
    data: Any
    id: str
    """"" if the event has none."""


def parsed(lines: Iterable[str]) -> Iterator[ReceivedEvent]:
    """Yield the server-sent events in the lines of a stream."""
    fields: dict[str, str] = {}
    for line in lines:
        name, _, value = line.partition(": ")
        fields[name] = value
        if not line and "data" in fields:
            yield ReceivedEvent(fields["event"], json.loads(fields["data"]), fields.get("id", ""))
            fields = {}


class EventStream:
    """An open event stream; see `open_stream`."""

    def __init__(self, response: httpx2.Response) -> None:
        self.events = parsed(response.iter_lines())

    def next(self) -> ReceivedEvent:
        """Wait for the next event.

        Raises:
            StopIteration: The stream has ended.
        """
        return next(self.events)

    def until(self, name: str, /, **fields: Any) -> list[ReceivedEvent]:
        """Return the events up to the first of a name whose data has some fields."""
        events: list[ReceivedEvent] = []
        for event in self.events:
            events.append(event)
            if event.name == name and fields.items() <= event.data.items():
                return events
        raise AssertionError([event.name for event in events])

    def frames(self, **fields: Any) -> list[dict[str, Any]]:
        """Return the frames of the next piece whose event has some fields, decoded."""
        piece: dict[str, Any] = self.until("piece", **fields)[-1].data
        return frames_of(piece)


def frames_of(piece: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the frames in the data of a `piece` event, decoded."""
    head, _ = decoded(base64.b64decode(piece["data"]))
    frames: list[dict[str, Any]] = head["frames"]
    return frames


@contextmanager
def open_stream(
    client: httpx2.Client, path: str = WITH_PICTURE, **options: Any
) -> Iterator[EventStream]:
    """Open an event stream.

    Args:
        client: of the server.
        path: path and query; by default a viewer's, whose stream has the picture.
        options: of `httpx2.Client.stream`.
    """
    with client.stream("GET", path, **options) as response:
        assert response.status_code == 200, response.status_code
        assert response.headers["content-type"].startswith("text/event-stream")
        yield EventStream(response)
