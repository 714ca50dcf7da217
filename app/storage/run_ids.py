"""Ids of runs: short, fit for a URL, and in the order in which they were made."""

import secrets
import threading
import time

from app.storage.store import RunStore

_DIGITS = "0123456789abcdefghjkmnpqrstvwxyz"
_TIME_DIGITS, _CHANCE_DIGITS = 9, 4
_THIS_VERSION_MS = 1_767_225_600_000
"""2026-01-01 in UTC: a clock that is behind that is wrong, as that of a machine without a battery
is until it has asked others for the time."""
_AHEAD_MS = 366 * 24 * 3_600_000
"""A clock may have been so far ahead when an id was made, and be right again now."""


class RunIds:
    """Makes ids out of the time [ms], which rises even if the clock does not, and chance."""

    def __init__(self, after: str | None = None) -> None:
        """Begin after an id that was made before, whatever the clock says by now."""
        self._last_ms = _time_ms(after or "") or 0
        self._lock = threading.Lock()

    @classmethod
    def of(cls, store: RunStore) -> "RunIds":
        """Ids that sort after those in a store, but for what could not have been made yet.

        An id of the year 3000 came from elsewhere, and after it there are none.
        """
        believed_ms = max(_now_ms(), _THIS_VERSION_MS) + _AHEAD_MS
        newest = store.list(limit=1, cursor=_id(believed_ms, 0)).items
        return cls(after=newest[0].id if newest else None)

    def __call__(self) -> str:
        """An id that sorts after all that were made before."""
        with self._lock:
            self._last_ms = max(self._last_ms + 1, _now_ms())
            made = self._last_ms
        return _id(made, secrets.randbits(5 * _CHANCE_DIGITS))

    def may_have_made(self, run_id: str) -> bool:
        """Whether an id could come from here by now, so that no later one sorts before it."""
        made_ms = _time_ms(run_id)
        with self._lock:
            return made_ms is not None and made_ms <= max(self._last_ms, _now_ms())


def _now_ms() -> int:
    return time.time_ns() // 1_000_000


def _time_ms(made: str) -> int | None:
    """The time in an id; None for what is none."""
    if len(made) != _TIME_DIGITS + _CHANCE_DIGITS or set(made) - set(_DIGITS):
        return None
    time_ms = 0
    for digit in made[:_TIME_DIGITS]:
        time_ms = time_ms << 5 | _DIGITS.index(digit)
    return time_ms


def _id(time_ms: int, chance: int) -> str:
    return _in_base_32(time_ms, _TIME_DIGITS) + _in_base_32(chance, _CHANCE_DIGITS)


def _in_base_32(number: int, digits: int) -> str:
    return "".join(_DIGITS[number >> 5 * place & 31] for place in reversed(range(digits)))
