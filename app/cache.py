"""Least-recently-used cache of encoded answers, with a limit on their size."""

from collections.abc import Callable, Hashable
from operator import attrgetter
from threading import Condition

from cachetools import LRUCache, cachedmethod


class BytesCache:
    """Bytes by all that they depend on; the least recently used are dropped first. Thread-safe."""

    def __init__(self, max_bytes: int) -> None:
        """Create an empty cache.

        Args:
            max_bytes: size of all values; the newest is kept whatever its size.
        """
        self._values: LRUCache[Hashable, bytes] = LRUCache(
            max_bytes, lambda value: min(len(value), max_bytes)
        )
        self._condition = Condition()

    def get(self, key: Hashable) -> bytes | None:
        """Return a value; None if it is not kept."""
        with self._condition:
            return self._values.get(key)

    def put(self, key: Hashable, value: bytes) -> None:
        """Keep a value."""
        with self._condition:
            self._values[key] = value

    @cachedmethod(
        attrgetter("_values"),
        key=lambda _self, key, _compute: key,
        condition=attrgetter("_condition"),
    )
    def computed(self, key: Hashable, compute: Callable[[], bytes]) -> bytes:  # noqa: ARG002
        """Return a value, computed unless it is kept: once for requests that come together."""
        return compute()
