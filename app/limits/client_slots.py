"""Concurrency limit for long-lived clients, as of streams of events, in total and per address.

When all slots are taken, a newcomer from an address with fewer slots evicts the newest client
of the address with the most, so that many clients behind one address do not exclude others. An
operator is always admitted: it evicts a spectator, or else the operator who came first.
"""

from typing import Generic, Literal, NamedTuple, TypeVar

T = TypeVar("T")
Refusal = Literal["full", "address full"]


class NoFreeSlot(Exception):
    """No slot is free; `reason` tells which limit was reached."""

    def __init__(self, reason: Refusal) -> None:
        super().__init__(reason)
        self.reason: Refusal = reason


class _Holder(NamedTuple):
    address: str
    is_operator: bool


class ClientSlots(Generic[T]):
    """Table of the clients that hold a slot. Not thread-safe: use on one event loop."""

    def __init__(self, slots: int, per_address: int) -> None:
        """Create a table with all slots free.

        Args:
            slots: maximum of clients in total.
            per_address: maximum of spectators of one address; operators are exempt.
        """
        self._slots, self._per_address = slots, per_address
        self._holders: dict[T, _Holder] = {}
        """In order of arrival."""

    def __len__(self) -> int:
        return len(self._holders)

    def __contains__(self, holder: T) -> bool:
        return holder in self._holders

    def holders(self) -> list[T]:
        """Return the clients that hold a slot, in order of arrival; from any thread."""
        return list(self._holders)

    def take(self, holder: T, address: str, is_operator: bool) -> T | None:
        """Give a client a slot, evicting another if needed.

        Returns:
            the evicted client, which the caller must disconnect; None if there is none.

        Raises:
            NoFreeSlot: if the client is refused.
        """
        counts = self._spectator_counts()
        same_address = counts.get(address, 0)
        if not is_operator and same_address >= self._per_address:
            raise NoFreeSlot("address full")
        evicted = None
        if len(self._holders) >= self._slots:
            evicted = self._to_evict(counts, same_address, is_operator)
            if evicted is None:
                raise NoFreeSlot("full")
            del self._holders[evicted]
        self._holders[holder] = _Holder(address, is_operator)
        return evicted

    def leave(self, holder: T) -> None:
        """Free a client's slot; does nothing if it was evicted before."""
        self._holders.pop(holder, None)

    def _spectator_counts(self) -> dict[str, int]:
        counts: dict[str, int] = {}
        for address, is_operator in self._holders.values():
            if not is_operator:
                counts[address] = counts.get(address, 0) + 1
        return counts

    def _to_evict(self, counts: dict[str, int], same_address: int, is_operator: bool) -> T | None:
        """Return the client to evict for a newcomer; None if the newcomer must be refused."""
        heaviest = max(counts, key=counts.__getitem__, default=None)
        if heaviest is None:
            # All slots are held by operators.
            return next(iter(self._holders), None) if is_operator else None
        if not is_operator and counts[heaviest] <= same_address + 1:
            # Both addresses would have as many then, and evict each other in turns.
            return None
        spectator = _Holder(heaviest, is_operator=False)
        return next(
            holder for holder, occupant in reversed(self._holders.items()) if occupant == spectator
        )
