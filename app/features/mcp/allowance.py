"""Limits of what the tools may start."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from hexapods.domain.errors import InvalidInput


class Allowance:
    """A number of runs and of steps, which starts use up. Thread-safe."""

    def __init__(self, starts: int, steps: int) -> None:
        """Allow so many runs, and so many steps of all of them together."""
        self.starts, self.steps = starts, steps
        self._lock = threading.Lock()

    @contextmanager
    def spent(self, steps: int) -> Iterator[None]:
        """Use up a run of so many steps; give it back if it is not started.

        Raises:
            InvalidInput: if it is more than is left.
        """
        with self._lock:
            if self.starts < 1:
                raise InvalidInput("the allowance is used up: no further run may be started")
            if not 0 < steps <= self.steps:
                raise InvalidInput(
                    f"a run may have from 1 to {self.steps:,} steps in all, which are left of the "
                    f"allowance, not {steps:,}"
                )
            self.starts -= 1
            self.steps -= steps
        try:
            yield
        except BaseException:
            with self._lock:
                self.starts += 1
                self.steps += steps
            raise
