"""Kinds of work: what a request costs the server, and the slots that bound how many go on at once.

Few slots, as Python threads share one interpreter lock and delay each other. One address cannot
hold all that others need for reading. Features define kinds of their own.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from starlette.responses import Response
from starlette.types import Scope


class Slots(NamedTuple):
    """Slots of one kind of work: all of them, and how many one address may hold."""

    size: int
    per_address: int


@dataclass(frozen=True, kw_only=True)
class Work:
    """A kind of work, which has slots of its own.

    Attributes:
        name: of this kind.
        spectators: slots of all who are no operators.
        operators: slots of operators; None if theirs count as `OTHER`, without an allowance.
        counts_as_start: whether each request counts as a start.
        refusal: charges a request, by its scope, to an allowance of this kind, in place of those of
            starts, and returns the refusal of who has used it up; None for no such allowance.
    """

    name: str
    spectators: Slots
    operators: Slots | None
    counts_as_start: bool = False
    refusal: Callable[[Scope], Response | None] | None = None


PROBE = Work(name="probe", spectators=Slots(2, 2), operators=Slots(2, 2))
"""Liveness and readiness, in milliseconds: a busy server is not taken for a dead one."""
ENCODING = Work(
    name="encoding", spectators=Slots(1, 1), operators=Slots(2, 2), counts_as_start=True
)
"""Files of long runs that take up to minutes before their first byte, and robots' files that are
read."""
DOWNLOAD = Work(name="download", spectators=Slots(2, 1), operators=Slots(2, 2))
"""Files that are computed chunk by chunk while a client reads them."""
ANALYSIS = Work(name="analysis", spectators=Slots(2, 1), operators=Slots(4, 4))
"""Any other view of what a run recorded, which takes seconds if that is long, and what is told of a
robot before it walks, if it is large."""
OTHER = Work(name="other", spectators=Slots(2, 2), operators=Slots(16, 16))
"""Listings, commands and files of the page, in milliseconds."""
