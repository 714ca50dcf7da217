"""Places: limits in total and per address, eviction for newcomers, priority of operators."""

import pytest

from app.limits.client_slots import ClientSlots, NoFreeSlot


def filled(slots: int, per_address: int, *addresses: str) -> ClientSlots[int]:
    table = ClientSlots[int](slots, per_address)
    for number, address in enumerate(addresses):
        assert table.take(number, address, is_operator=False) is None
    return table


def test_places_of_one_address_are_limited() -> None:
    slots = filled(10, 3, "a", "a", "a")

    with pytest.raises(NoFreeSlot, match="address full"):
        slots.take(9, "a", is_operator=False)
    assert slots.take(9, "b", is_operator=False) is None
    slots.leave(0)
    assert slots.take(10, "a", is_operator=False) is None


def test_newest_client_of_the_address_with_most_places_is_evicted() -> None:
    slots = filled(5, 4, "a", "a", "a", "b", "a")

    assert slots.take(10, "c", is_operator=False) == 4
    assert slots.take(11, "c", is_operator=False) == 2
    # Two, two and one slots: an eviction would only swap the counts of two addresses.
    for address in ("a", "b", "c"):
        with pytest.raises(NoFreeSlot, match="full"):
            slots.take(12, address, is_operator=False)
    assert len(slots) == 5


def test_new_address_is_always_admitted() -> None:
    slots = filled(20, 16, *["a"] * 10, *["b"] * 10)
    for number in range(8):
        assert slots.take(100 + number, f"new {number}", is_operator=False) is not None


def test_operator_evicts_a_spectator_and_is_exempt_from_the_address_limit() -> None:
    slots = filled(3, 2, "a", "a", "b")

    assert slots.take(10, "a", is_operator=True) == 1
    assert slots.take(11, "a", is_operator=True) in (0, 2)
    assert 10 in slots
    assert slots.take(12, "b", is_operator=True) in (0, 2)
    assert len(slots) == 3


def test_operator_evicts_the_first_operator_and_spectators_are_refused() -> None:
    slots = ClientSlots[int](2, 2)
    for number in (1, 2):
        assert slots.take(number, "a", is_operator=True) is None

    with pytest.raises(NoFreeSlot, match="full"):
        slots.take(3, "b", is_operator=False)
    assert slots.take(4, "a", is_operator=True) == 1


def test_leaving_after_an_eviction_changes_nothing() -> None:
    slots = filled(1, 1, "a")
    assert slots.take(1, "b", is_operator=True) == 0
    slots.leave(0)
    slots.leave(1)

    assert len(slots) == 0


def test_table_without_places_refuses_all() -> None:
    slots = ClientSlots[int](0, 0)
    for is_operator in (False, True):
        with pytest.raises(NoFreeSlot):
            slots.take(1, "a", is_operator=is_operator)
