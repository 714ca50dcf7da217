"""Starts that are asked for again: the same key is the same run."""

import hashlib
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

from app.domain.errors import InvalidInput

KEPT_S = 24 * 3600.0
MAX_KEPT = 10_000
T = TypeVar("T")


@dataclass
class _Start:
    digest: bytes
    began_s: float
    lock: threading.Lock = field(default_factory=threading.Lock)
    made: Any = None


class Once:
    """Remembers for a day which key started which run. Safe to use from any thread.

    It is kept in memory, so a retry after a restart of the server starts a new run.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        """Remember nothing yet.

        Args:
            now: the clock, in seconds.
        """
        self._now = now
        self._starts: OrderedDict[str, _Start] = OrderedDict()
        self._lock = threading.Lock()

    def run(self, key: str | None, request: bytes, start: Callable[[], T]) -> T:
        """What `start` returns, or returned when it was called with this key before.

        Whoever comes with the same key meanwhile waits. A start that fails is not remembered as
        one, so the next with its key tries again.

        Args:
            key: chosen by who asks; None starts in any case.
            request: what is asked for.
            start: starts it, and says something about it that is not None.

        Raises:
            InvalidInput: if something else was asked for with this key.
        """
        if key is None:
            return start()
        known = self._known(key, hashlib.sha256(request).digest())
        with known.lock:
            if known.made is None:
                known.made = start()
            made: T = known.made
            return made

    def _known(self, key: str, digest: bytes) -> _Start:
        now = self._now()
        with self._lock:
            while self._starts and self._oldest().began_s < now - KEPT_S:
                self._starts.popitem(last=False)
            known = self._starts.setdefault(key, _Start(digest, now))
            if len(self._starts) > MAX_KEPT:
                self._starts.popitem(last=False)
        if known.digest != digest:
            raise InvalidInput(
                "this Idempotency-Key came with another request before; send a new key with each "
                "new request, and the same only to repeat one"
            )
        return known

    def _oldest(self) -> _Start:
        return next(iter(self._starts.values()))
