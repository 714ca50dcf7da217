"""Run ids: short, URL-safe and sortable by time of creation (like ULIDs).

An id is 13 base-32 digits: 9 for the time in milliseconds since 1970, 4 random ones.
"""

import secrets
import threading
import time

from app.storage.database.listing import cursor_before
from app.storage.database.store import RunStore

_DIGITS = "0123456789abcdefghjkmnpqrstvwxyz"
_TIME_DIGITS, _RANDOM_DIGITS = 9, 4
_RELEASE_MS = 1_767_225_600_000
"""2026-01-01 in UTC: an earlier clock is wrong, as on a machine without a battery-backed clock
before its first NTP synchronisation."""
_MAX_CLOCK_LEAD_MS = 366 * 24 * 3_600_000
"""Most by which the clock may have been ahead when an existing id was created."""


class RunIds:
    """Generates strictly increasing ids, even if the clock is set back. Thread-safe."""

    def __init__(self, after: str | None = None) -> None:
        """Generate ids that sort after this one, whatever the clock says.

        Args:
            after: the newest existing id; None if there is none.
        """
        self._last_ms = _time_ms(after or "") or 0
        self._lock = threading.Lock()

    @classmethod
    def of(cls, store: RunStore) -> "RunIds":
        """Generate ids that sort after those in a store, except implausibly late ones.

        An id of the year 3000 cannot have been generated here, and starting after it would use up
        the range of ids.
        """
        plausible_ms = max(_now_ms(), _RELEASE_MS) + _MAX_CLOCK_LEAD_MS
        newest = store.list(limit=1, cursor=cursor_before(_id(plausible_ms, 0))).items
        return cls(after=newest[0].id if newest else None)

    def __call__(self) -> str:
        """Generate an id that sorts after all earlier ones."""
        with self._lock:
            self._last_ms = max(self._last_ms + 1, _now_ms())
            time_ms = self._last_ms
        return _id(time_ms, secrets.randbits(5 * _RANDOM_DIGITS))

    def is_plausible(self, run_id: str) -> bool:
        """Whether an id is well-formed and not in the future, so that all new ids sort after it."""
        time_ms = _time_ms(run_id)
        with self._lock:
            return time_ms is not None and time_ms <= max(self._last_ms, _now_ms())


def _now_ms() -> int:
    return time.time_ns() // 1_000_000


def _time_ms(run_id: str) -> int | None:
    """Return the time in an id [ms since 1970]; None if the id is malformed."""
    if len(run_id) != _TIME_DIGITS + _RANDOM_DIGITS or set(run_id) - set(_DIGITS):
        return None
    time_ms = 0
    for digit in run_id[:_TIME_DIGITS]:
        time_ms = time_ms << 5 | _DIGITS.index(digit)
    return time_ms


def _id(time_ms: int, random: int) -> str:
    return _base_32(time_ms, _TIME_DIGITS) + _base_32(random, _RANDOM_DIGITS)


def _base_32(number: int, digits: int) -> str:
    return "".join(_DIGITS[number >> 5 * place & 31] for place in reversed(range(digits)))
