"""Turns of requests that take long: one at a time, those of operators first."""

import itertools
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from app.storage.errors import Busy

GRACE_S = 1.0
"""Time for which an operator's request lets a spectator's go on [s]; most have ended by then."""
_LOOK_EVERY_S = 0.1
_RETRY_S = 5


class Turns:
    """Gives turns to requests, each in a thread of its own. Thread-safe."""

    def __init__(self, what: str, max_waiting: int) -> None:
        """Create an empty queue of requests.

        Args:
            what: name of the requests, for the error: `questions`.
            max_waiting: maximum number of requests of operators that wait, and of spectators.
        """
        self._what, self._max_waiting = what, max_waiting
        self._changed = threading.Condition()
        self._waiting: list[tuple[bool, int]] = []
        """Tickets: whether the request is a spectator's, and its number; the least is the next."""
        self._numbers = itertools.count()
        self._is_taken = False

    @property
    def waiting(self) -> int:
        """Number of requests that wait for their turn."""
        return len(self._waiting)

    @contextmanager
    def turn(
        self, check: Callable[[], None], *, is_operator: bool = True
    ) -> Iterator[Callable[[], None]]:
        """Wait for the turn of a request, and hold it within the context.

        Args:
            check: called ten times a second while the request waits; if it raises, the wait ends.
            is_operator: whether the request comes before those of spectators.

        Returns:
            a function to be called often during the turn: it calls `check`, and raises `Busy` if an
            operator has waited for a spectator's request for `GRACE_S`.

        Raises:
            Busy: if too many are waiting.
        """
        ticket = (not is_operator, next(self._numbers))
        with self._changed:
            if sum(waiting[0] == ticket[0] for waiting in self._waiting) >= self._max_waiting:
                waiting = f"{self._max_waiting} {self._what} are waiting"
                raise Busy(f"{waiting}; ask again later", 2)
            self._waiting.append(ticket)
            try:
                while self._is_taken or min(self._waiting) != ticket:
                    self._changed.wait(_LOOK_EVERY_S)
                    check()
                self._is_taken = True
            finally:
                self._waiting.remove(ticket)
                self._changed.notify_all()
        try:
            check()
            yield check if is_operator else self._check_for_operators(check)
        finally:
            with self._changed:
                self._is_taken = False
                self._changed.notify_all()

    def _check_for_operators(self, check: Callable[[], None]) -> Callable[[], None]:
        since_s: float | None = None

        def check_both() -> None:
            nonlocal since_s
            check()
            with self._changed:
                is_wanted = any(not is_spectators for is_spectators, _ in self._waiting)
            since_s = (since_s or time.monotonic()) if is_wanted else None
            if since_s is not None and time.monotonic() - since_s > GRACE_S:
                raise Busy(
                    f"the operator asked meanwhile, and goes first; ask again in {_RETRY_S} s",
                    _RETRY_S,
                )

        return check_both
