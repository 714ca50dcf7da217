"""Least-recently-used cache of answers that many pages request at once."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable

MAX_BYTES = 8 << 20
"""The newest answer is kept whatever its size."""


class AnswerCache:
    """Cache of encoded answers by what they depend on. Thread-safe.

    An answer is computed under a lock, so that requests that come together compute it once.
    """

    def __init__(self) -> None:
        self._entries: OrderedDict[Hashable, bytes] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, key: Hashable, compute: Callable[[], bytes]) -> bytes:
        """Return the answer of a key, computed unless it is cached."""
        with self._lock:
            answer = self._entries.get(key)
            if answer is None:
                answer = self._entries[key] = compute()
            self._entries.move_to_end(key)
            while len(self._entries) > 1 and sum(map(len, self._entries.values())) > MAX_BYTES:
                self._entries.popitem(last=False)
            return answer
