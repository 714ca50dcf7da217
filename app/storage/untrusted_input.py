"""Base class and field types for untrusted input: fixed fields, ranges for every number."""

import json
from datetime import UTC, datetime, timedelta
from typing import Annotated

import msgspec
from msgspec import Meta

from hexapods.runs.config import MAX_STEPS
from hexapods.runs.race_config import MAX_LANES

MAX_M = 1e6
_MAX_S = 1e9
_EARLIEST = datetime(1970, 1, 1, tzinfo=UTC)
_MAX_CLOCK_LEAD = timedelta(days=1)
"""Most by which the clock of the exporting machine may be ahead of this one's."""

Count = Annotated[int, Meta(ge=0, le=MAX_STEPS * MAX_LANES)]
"""Number of steps, summed over all lanes."""
Step = Annotated[int, Meta(ge=0, le=MAX_STEPS)]
Large = Annotated[int, Meta(ge=0, le=2**53)]
"""Any other count, up to JavaScript's largest exact integer."""
Metres = Annotated[float, Meta(ge=-MAX_M, le=MAX_M)]
Seconds = Annotated[float, Meta(ge=0, le=_MAX_S)]
Share = Annotated[float, Meta(ge=0, le=1)]
Name = Annotated[str, Meta(max_length=100)]
PortableText = Annotated[str, Meta(max_length=10_000, pattern=r"^[^\x00]*$")]
"""Text without NUL, which no database stores."""
Moment = Annotated[datetime, Meta(tz=True)]


class UntrustedInput(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """Base class for untrusted input; rejects unknown fields."""


def check_json(data: bytes) -> None:
    """Check that a JSON document has no key twice, and no more blanks than indentation needs.

    Readers differ in which of the values they take, and blanks only fill memory.

    Raises:
        ValueError: if it has, or is no JSON document.
        RecursionError: if it is nested too deeply.
    """
    compact = msgspec.json.format(data, indent=-1)
    if len(data) > len(msgspec.json.format(compact, indent=1)) + 1:
        raise ValueError("it has more blanks than indentation needs")
    json.loads(data, object_pairs_hook=_check_keys)


def _check_keys(pairs: list[tuple[str, object]]) -> None:
    names = [name for name, _ in pairs]
    if len(set(names)) < len(names):
        name = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"it has {name[:80]!r} twice")


def check_moment(name: str, moment: datetime | None) -> None:
    """Check that a time is from 1970 on and at most a day ahead of this machine's clock.

    Raises:
        ValueError: if it is not.
    """
    if moment is None:
        return
    try:
        in_utc = moment.astimezone(UTC)
    except OverflowError:
        in_utc = None
    if in_utc is None or not _EARLIEST <= in_utc <= datetime.now(UTC) + _MAX_CLOCK_LEAD:
        raise ValueError(f"its {name} must be from 1970 on and not in the future, not {moment}")
