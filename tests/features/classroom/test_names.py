"""Codes and names: drawn from an injected generator, distinct, and readable from far."""

import random

import pytest

from app.features.classroom.names import (
    ALPHABET,
    CODE_LENGTH,
    in_groups,
    new_code,
    new_name,
    normalized,
)


def test_codes_have_no_letters_that_look_alike() -> None:
    assert len(ALPHABET) == 32
    assert not set(ALPHABET) & set("0O1I")
    codes: set[str] = set()
    choose = random.Random(1).choice
    for _ in range(500):
        codes.add(new_code(choose, codes))
    assert len(codes) == 500
    assert all(len(code) == CODE_LENGTH and set(code) <= set(ALPHABET) for code in codes)
    assert new_code(random.Random(7).choice, ()) == new_code(random.Random(7).choice, ())


def test_a_code_that_is_taken_is_not_given_again() -> None:
    letters = iter("AAAAAAAABBBBBBBB")
    assert new_code(lambda words: next(letters), {"AAAAAAAA"}) == "BBBBBBBB"


def test_names_are_distinct() -> None:
    names: set[str] = set()
    choose = random.Random(2).choice
    for _ in range(1000):
        names.add(new_name(choose, names))
    assert len(names) == 1000
    assert all(name.replace(" ", "").isalpha() for name in names)


@pytest.mark.parametrize(
    "typed",
    ["abcd2345", "ABCD 2345", "abcd-2345", " ABCD  2345 ", "ABCD\u20112345", "ABCD\u00a02345"],
)
def test_a_code_is_the_same_however_it_is_typed(typed: str) -> None:
    assert normalized(typed) == "ABCD2345"
    assert normalized(in_groups("ABCD2345")) == "ABCD2345"
