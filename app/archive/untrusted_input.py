"""Base class and field types of untrusted input: one shape, nothing beside it, all in range."""

from datetime import UTC, datetime, timedelta
from typing import Annotated

import msgspec
from msgspec import Meta

from app.runs.config import MAX_LANES, MAX_STEPS

_MAX_M = 1e6
_MAX_S = 1e9
_FIRST = datetime(1970, 1, 1, tzinfo=UTC)
_AHEAD = timedelta(days=1)
"""How far another machine's clock may be ahead of ours."""

Count = Annotated[int, Meta(ge=0, le=MAX_STEPS * MAX_LANES)]
"""Steps of all lanes together."""
Step = Annotated[int, Meta(ge=0, le=MAX_STEPS)]
Large = Annotated[int, Meta(ge=0, le=2**53)]
"""Beyond it JavaScript no longer counts by ones."""
Metres = Annotated[float, Meta(ge=-_MAX_M, le=_MAX_M)]
Seconds = Annotated[float, Meta(ge=0, le=_MAX_S)]
Share = Annotated[float, Meta(ge=0, le=1)]
Name = Annotated[str, Meta(max_length=100)]
PortableText = Annotated[str, Meta(max_length=10_000, pattern=r"^[^\x00]*$")]
"""No database keeps NUL."""
Moment = Annotated[datetime, Meta(tz=True)]


class UntrustedInput(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """Has the fields it has and no others."""


def check_moment(name: str, moment: datetime | None) -> None:
    """Raise `ValueError` unless a moment is from 1970 on and not over a day ahead of our clock."""
    if moment is None:
        return
    try:
        in_utc = moment.astimezone(UTC)
    except OverflowError:
        in_utc = None
    if in_utc is None or not _FIRST <= in_utc <= datetime.now(UTC) + _AHEAD:
        raise ValueError(f"its {name} must be from 1970 on and not in the future, not {moment}")
