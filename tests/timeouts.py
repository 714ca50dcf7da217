"""Timeouts of tests: a test waits while there is progress, and `LONG_S` without any."""

import time
from typing import Any

LONG_S = 180.0
"""Only a broken server stands still for so long; a busy machine is slow, and gets on."""


class ProgressTimeout:
    """Fails once what it is shown has stayed the same for `LONG_S`."""

    def __init__(self) -> None:
        self._newest: Any = None
        self._deadline = time.monotonic() + LONG_S

    def check(self, shown: Any) -> None:
        """Take in how it is now."""
        now = time.monotonic()
        if shown != self._newest:
            self._newest, self._deadline = shown, now + LONG_S
        assert now < self._deadline, shown
