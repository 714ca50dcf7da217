"""Places: an address gets a share, newcomers get in, an operator always does."""

import pytest

from app.limits.places import NoPlace, Places


def filled(places: int, per_address: int, *addresses: str) -> Places[int]:
    made = Places[int](places, per_address)
    for number, address in enumerate(addresses):
        assert made.take(number, address, is_operator=False) is None
    return made


def test_an_address_gets_its_share_and_no_more() -> None:
    places = filled(10, 3, "a", "a", "a")

    with pytest.raises(NoPlace, match="address full"):
        places.take(9, "a", is_operator=False)
    assert places.take(9, "b", is_operator=False) is None
    places.leave(0)
    assert places.take(10, "a", is_operator=False) is None


def test_where_all_is_taken_the_heaviest_address_gives_its_newest_to_one_with_fewer() -> None:
    places = filled(5, 4, "a", "a", "a", "b", "a")

    assert places.take(10, "c", is_operator=False) == 4
    assert places.take(11, "c", is_operator=False) == 2
    # Two each, and one: nobody has so much more that it would be fairer.
    for address in ("a", "b", "c"):
        with pytest.raises(NoPlace, match="full"):
            places.take(12, address, is_operator=False)
    assert len(places) == 5


def test_an_address_that_comes_anew_always_gets_in() -> None:
    places = filled(20, 16, *["a"] * 10, *["b"] * 10)
    for number in range(8):
        assert places.take(100 + number, f"new {number}", is_operator=False) is not None


def test_an_operator_takes_a_spectators_place_and_is_in_no_share() -> None:
    places = filled(3, 2, "a", "a", "b")

    assert places.take(10, "a", is_operator=True) == 1
    assert places.take(11, "a", is_operator=True) in (0, 2)
    assert 10 in places
    assert places.take(12, "b", is_operator=True) in (0, 2)
    assert len(places) == 3


def test_among_operators_the_first_makes_room_and_spectators_get_nothing() -> None:
    places = Places[int](2, 2)
    for number in (1, 2):
        assert places.take(number, "a", is_operator=True) is None

    with pytest.raises(NoPlace, match="full"):
        places.take(3, "b", is_operator=False)
    assert places.take(4, "a", is_operator=True) == 1


def test_one_that_lost_its_place_may_leave_too() -> None:
    places = filled(1, 1, "a")
    assert places.take(1, "b", is_operator=True) == 0
    places.leave(0)
    places.leave(1)

    assert len(places) == 0


def test_no_places_are_for_nobody() -> None:
    places = Places[int](0, 0)
    for is_operator in (False, True):
        with pytest.raises(NoPlace):
            places.take(1, "a", is_operator=is_operator)
