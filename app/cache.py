"""Least-recently-used cache of encoded answers, with a limit on their size."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable


class BytesCache:
    """Bytes by all that they depend on; the least recently used are dropped first. Thread-safe."""

    def __init__(self, max_bytes: int) -> None:
        """Create an empty cache.

        Args:
            max_bytes: size of all values; the newest is kept whatever its size.
        """
        self._max_bytes, self._bytes = max_bytes, 0
        self._values: OrderedDict[Hashable, bytes] = OrderedDict()
        self._lock = threading.Lock()
        self._computing: dict[Hashable, threading.Lock] = {}

    def get(self, key: Hashable) -> bytes | None:
        """Return a value; None if it is not kept."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
            return self._values.get(key)

    def put(self, key: Hashable, value: bytes) -> None:
        """Keep a value."""
        with self._lock:
            self._bytes += len(value) - len(self._values.pop(key, b""))
            self._values[key] = value
            while self._bytes > self._max_bytes and len(self._values) > 1:
                self._bytes -= len(self._values.popitem(last=False)[1])

    def computed(self, key: Hashable, compute: Callable[[], bytes]) -> bytes:
        """Return a value, computed unless it is kept: once for requests that come together."""
        if (value := self.get(key)) is not None:
            return value
        with self._lock:
            computing = self._computing.setdefault(key, threading.Lock())
        try:
            with computing:
                value = self.get(key)
                if value is None:
                    value = compute()
                    self.put(key, value)
        finally:
            with self._lock:
                self._computing.pop(key, None)
        return value
