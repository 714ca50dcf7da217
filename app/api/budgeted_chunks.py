"""Chunks of an answer in memory that slow clients read, within a memory budget."""

from collections.abc import Iterator

from app.limits.memory_budget import MemoryBudget
from app.storage.errors import Busy

_ANYONE = "anyone"


class BudgetedChunks:
    """Iterator over chunks that holds bytes of a memory budget until it is garbage-collected."""

    def __init__(self, chunks: Iterator[bytes], size: int, budget: MemoryBudget) -> None:
        """Reserve the bytes.

        Args:
            chunks: what is iterated over.
            size: of what is held in memory meanwhile [bytes].
            budget: of which it is a part.

        Raises:
            Busy: if the budget has no place for it.
        """
        self._chunks, self._size, self._budget = chunks, 0, budget
        if budget.reserve(_ANYONE, size) is not None:
            raise Busy("as much is exported as the server can at once; try again in a moment", 5)
        self._size = size

    def __iter__(self) -> Iterator[bytes]:
        return self

    def __next__(self) -> bytes:
        return next(self._chunks)

    def __del__(self) -> None:
        # Not in a generator's `finally`, which does not run if the response was never started.
        if self._size:
            self._budget.release(_ANYONE, self._size)
