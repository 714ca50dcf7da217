"""A parser of HTTP/1.1 that bounds what the head and the framing of a request cost to read.

What h11 parses at once it parses on the event loop, before any other limit. It limits what has not
arrived completely, but a head that comes in one piece may be as long as the piece.
"""

import re
from http import HTTPStatus

import h11

MAX_HEAD_BYTES = 32 << 10
"""Longest request line with its headers: over three of the longest headers that the app reads."""
MAX_HEAD_LINES = 128
READ_BYTES = 16 << 10
"""Bytes of a connection that are read, and so parsed, at once: others have their turn between."""
MAX_SMALL_CHUNKS, CHUNK_BYTES = 500, 1024
"""A body may have so many chunks, and one more for each so many bytes."""
_END_OF_HEAD = re.compile(rb"\n\r?\n")


class BoundedConnection(h11.Connection):
    """The server's side of a connection.

    Attributes:
        refusal: what was wrong with the request that was refused last; None before.
    """

    def __init__(self) -> None:
        """Begin with no request."""
        super().__init__(h11.SERVER, MAX_HEAD_BYTES)
        self.refusal: h11.RemoteProtocolError | None = None
        self._chunks = self._body_bytes = 0

    def next_event(self) -> h11.Event | type[h11.NEED_DATA] | type[h11.PAUSED]:
        """Return the next event, as in h11.

        Raises:
            RemoteProtocolError: if the request is malformed, too long, or in too many pieces.
        """
        try:
            if self.their_state is h11.IDLE:
                self._check_head()
            event = super().next_event()
            if isinstance(event, h11.Request):
                self._chunks = self._body_bytes = 0
            elif isinstance(event, h11.Data):
                self._check_chunks(event)
        except h11.RemoteProtocolError as error:
            self.refusal = error
            raise
        return event

    def _check_head(self) -> None:
        received, _ = self.trailing_data
        end = _END_OF_HEAD.search(received)
        size = len(received) if end is None else end.end()
        if size > MAX_HEAD_BYTES or received.count(b"\n", 0, size) > MAX_HEAD_LINES:
            raise h11.RemoteProtocolError(
                f"A request's line and headers may have at most {MAX_HEAD_BYTES:,} bytes and "
                f"{MAX_HEAD_LINES} lines.",
                error_status_hint=HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE,
            )

    def _check_chunks(self, event: h11.Data) -> None:
        self._body_bytes += len(event.data)
        self._chunks += event.chunk_start
        if self._chunks > MAX_SMALL_CHUNKS + self._body_bytes // CHUNK_BYTES:
            raise h11.RemoteProtocolError(
                f"A body may have at most {MAX_SMALL_CHUNKS} chunks under {CHUNK_BYTES} bytes."
            )
