"""Presses of a class by step: who counts, how often, what is too early and too late."""

import pytest

from app.features.classroom.press_book import PressBook
from app.storage.errors import Conflict

EVERYBODY = {1, 2, 3}


def test_a_step_gets_the_mean_of_those_who_pressed() -> None:
    book = PressBook()
    for seed, at_step, value in ((1, 4.2, 1), (2, 4.6, 1), (3, 4.7, -1)):
        book.add(seed, at_step, value, shown=4.7)
    (press,) = book.close(5.6, EVERYBODY)

    assert (press.step, press.at_step, press.value) == (4, 4.5, 0.3333)
    assert (press.plus, press.minus) == (2, 1)
    assert book.close(9.0, EVERYBODY) == []


def test_a_pupil_counts_once_a_step_with_the_last_press() -> None:
    book = PressBook()
    for value in (1, 1, 1, -1):
        book.add(1, 4.5, value, shown=4.5)
    book.add(2, 4.5, 1, shown=4.5)
    (press,) = book.close(6.0, EVERYBODY)

    assert (press.plus, press.minus, press.value) == (1, 1, 0.0)


def test_who_has_left_does_not_count() -> None:
    book = PressBook()
    book.add(1, 4.5, 1, shown=4.5)
    book.add(2, 4.5, -1, shown=4.5)
    (press,) = book.close(6.0, {2})

    assert (press.plus, press.minus) == (0, 1)


def test_a_step_of_which_all_have_left_teaches_nothing() -> None:
    book = PressBook()
    book.add(1, 4.5, 1, shown=4.5)

    assert book.close(6.0, set()) == []


def test_a_step_stays_open_for_half_a_step() -> None:
    book = PressBook()
    book.add(1, 4.9, 1, shown=5.4)
    assert book.close(5.4, EVERYBODY) == []
    assert len(book.close(5.5, EVERYBODY)) == 1


@pytest.mark.parametrize(
    ("at_step", "shown", "words"),
    [(3.5, 6.0, "over"), (0.0, 90.0, "over"), (7.1, 6.0, "not shown yet")],
)
def test_moments_that_nobody_sees_are_refused(at_step: float, shown: float, words: str) -> None:
    with pytest.raises(Conflict, match=words):
        PressBook().add(1, at_step, 1, shown)


def test_a_step_that_was_closed_takes_no_more_presses() -> None:
    book = PressBook()
    book.close(5.5, EVERYBODY)
    with pytest.raises(Conflict, match="over"):
        book.add(1, 4.9, 1, shown=5.5)
