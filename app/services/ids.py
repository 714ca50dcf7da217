"""Names for runs: short, fit for a URL, and in the order in which they were made."""

import secrets
import threading
import time

_DIGITS = "0123456789abcdefghjkmnpqrstvwxyz"
_TIME_DIGITS, _CHANCE_DIGITS = 9, 4


class RunIds:
    """Makes ids out of the time [ms], which rises even if the clock does not, and chance."""

    def __init__(self, after: str | None = None) -> None:
        """Begin after an id that was made before, whatever the clock says by now."""
        self._last_ms = _time_ms(after or "")
        self._lock = threading.Lock()

    def __call__(self) -> str:
        """An id that sorts after all that were made before."""
        with self._lock:
            self._last_ms = max(self._last_ms + 1, time.time_ns() // 1_000_000)
            made = self._last_ms
        chance = secrets.randbits(5 * _CHANCE_DIGITS)
        return _in_base_32(made, _TIME_DIGITS) + _in_base_32(chance, _CHANCE_DIGITS)


def _time_ms(made: str) -> int:
    """The time in an id; 0 for what is none."""
    if len(made) != _TIME_DIGITS + _CHANCE_DIGITS or set(made) - set(_DIGITS):
        return 0
    time_ms = 0
    for digit in made[:_TIME_DIGITS]:
        time_ms = time_ms << 5 | _DIGITS.index(digit)
    return time_ms


def _in_base_32(number: int, digits: int) -> str:
    return "".join(_DIGITS[number >> 5 * place & 31] for place in reversed(range(digits)))
