"""Places: limits in total and per address, eviction for newcomers, priority of operators."""

import pytest

from app.limits.places import NoPlace, Places


def filled(places: int, per_address: int, *addresses: str) -> Places[int]:
    table = Places[int](places, per_address)
    for number, address in enumerate(addresses):
        assert table.take(number, address, is_operator=False) is None
    return table


def test_places_of_one_address_are_limited() -> None:
    places = filled(10, 3, "a", "a", "a")

    with pytest.raises(NoPlace, match="address full"):
        places.take(9, "a", is_operator=False)
    assert places.take(9, "b", is_operator=False) is None
    places.leave(0)
    assert places.take(10, "a", is_operator=False) is None


def test_newest_client_of_the_address_with_most_places_is_evicted() -> None:
    places = filled(5, 4, "a", "a", "a", "b", "a")

    assert places.take(10, "c", is_operator=False) == 4
    assert places.take(11, "c", is_operator=False) == 2
    # Two, two and one places: an eviction would only swap the counts of two addresses.
    for address in ("a", "b", "c"):
        with pytest.raises(NoPlace, match="full"):
            places.take(12, address, is_operator=False)
    assert len(places) == 5


def test_new_address_is_always_admitted() -> None:
    places = filled(20, 16, *["a"] * 10, *["b"] * 10)
    for number in range(8):
        assert places.take(100 + number, f"new {number}", is_operator=False) is not None


def test_operator_evicts_a_spectator_and_is_exempt_from_the_address_limit() -> None:
    places = filled(3, 2, "a", "a", "b")

    assert places.take(10, "a", is_operator=True) == 1
    assert places.take(11, "a", is_operator=True) in (0, 2)
    assert 10 in places
    assert places.take(12, "b", is_operator=True) in (0, 2)
    assert len(places) == 3


def test_operator_evicts_the_first_operator_and_spectators_are_refused() -> None:
    places = Places[int](2, 2)
    for number in (1, 2):
        assert places.take(number, "a", is_operator=True) is None

    with pytest.raises(NoPlace, match="full"):
        places.take(3, "b", is_operator=False)
    assert places.take(4, "a", is_operator=True) == 1


def test_leaving_after_an_eviction_changes_nothing() -> None:
    places = filled(1, 1, "a")
    assert places.take(1, "b", is_operator=True) == 0
    places.leave(0)
    places.leave(1)

    assert len(places) == 0


def test_table_without_places_refuses_all() -> None:
    places = Places[int](0, 0)
    for is_operator in (False, True):
        with pytest.raises(NoPlace):
            places.take(1, "a", is_operator=is_operator)
