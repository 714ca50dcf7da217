"""Access to the routes of tournaments, and the reader of a request: participants or an operator."""

from typing import Annotated

from fastapi import Depends, Request

from app.api.policy import Access

WATCH_TOURNAMENT = Access(name="watch tournament", spectators="watching", is_read=True)
"""Shows the tournament `tournament_id` of the path."""
ENTER_TOURNAMENT = Access(name="enter tournament")
"""Enters the tournament `tournament_id` of the path."""
Reader = tuple[tuple[str, int], ...] | None
"""Which participants of rooms a client is, by code and seed; None for operators."""


def _reader(request: Request) -> Reader:
    if request.state.role == "operator":
        return None
    # By its attribute alone: the class is that of another feature, which may be left out.
    seats: Reader = getattr(request.state.identity, "seats", ())
    return seats


ReaderDep = Annotated[Reader, Depends(_reader)]
"""The reader of the request."""
