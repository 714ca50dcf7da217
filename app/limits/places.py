"""Places for clients that stay: bounded in all and for each address, with room for who comes anew.

An address alone gets a share of the places. When all are taken, the address with the most of them
gives its newest up to one that has fewer, so that no crowd behind one address keeps others out. An
operator takes the place of a spectator, or else of the operator who came first, and always gets in.
"""

from typing import Generic, Literal, NamedTuple, TypeVar

T = TypeVar("T")
Refusal = Literal["full", "address full"]


class NoPlace(Exception):
    """There is none; `reason` says of what there is too much."""

    def __init__(self, reason: Refusal) -> None:
        super().__init__(reason)
        self.reason: Refusal = reason


class _Holder(NamedTuple):
    address: str
    is_operator: bool


class Places(Generic[T]):
    """Who holds a place. To be used on one event loop."""

    def __init__(self, places: int, per_address: int) -> None:
        """All are free.

        Args:
            places: in all.
            per_address: of spectators at one address.
        """
        self._places, self._per_address = places, per_address
        self._holders: dict[T, _Holder] = {}
        """In the order in which they came."""

    def __len__(self) -> int:
        return len(self._holders)

    def __contains__(self, holder: T) -> bool:
        return holder in self._holders

    def take(self, holder: T, address: str, is_operator: bool) -> T | None:
        """Give it a place.

        Returns:
            who lost its own for that, if anyone did.

        Raises:
            NoPlace: if it gets none.
        """
        counts = self._spectators()
        mine = counts.get(address, 0)
        if not is_operator and mine >= self._per_address:
            raise NoPlace("address full")
        loser = None
        if len(self._holders) >= self._places:
            loser = self._loser(counts, mine, is_operator)
            if loser is None:
                raise NoPlace("full")
            del self._holders[loser]
        self._holders[holder] = _Holder(address, is_operator)
        return loser

    def leave(self, holder: T) -> None:
        """It has none any more; it may have lost it before."""
        self._holders.pop(holder, None)

    def _spectators(self) -> dict[str, int]:
        counts: dict[str, int] = {}
        for address, is_operator in self._holders.values():
            if not is_operator:
                counts[address] = counts.get(address, 0) + 1
        return counts

    def _loser(self, counts: dict[str, int], mine: int, is_operator: bool) -> T | None:
        heaviest = max(counts, key=counts.__getitem__, default=None)
        if heaviest is None:
            # Operators only.
            return next(iter(self._holders), None) if is_operator else None
        if not is_operator and counts[heaviest] <= mine + 1:
            # It would have as many then: they would only take turns.
            return None
        at_it = _Holder(heaviest, is_operator=False)
        return next(one for one, held in reversed(self._holders.items()) if held == at_it)
