"""Codes and names: drawn from an injected generator, distinct, and readable from far."""

import random

from app.classroom.names import ALPHABET, CODE_LENGTH, new_code, new_name, normalized


def test_codes_have_no_letters_that_look_alike() -> None:
    assert len(ALPHABET) == 32
    assert not set(ALPHABET) & set("0O1I")
    codes: set[str] = set()
    choose = random.Random(1).choice
    for _ in range(500):
        codes.add(new_code(choose, codes))
    assert len(codes) == 500
    assert all(len(one) == CODE_LENGTH and set(one) <= set(ALPHABET) for one in codes)
    assert new_code(random.Random(7).choice, ()) == new_code(random.Random(7).choice, ())


def test_a_code_that_is_taken_is_not_given_again() -> None:
    letters = iter("AAAAAABBBBBB")
    assert new_code(lambda words: next(letters), {"AAAAAA"}) == "BBBBBB"


def test_a_code_may_be_typed_in_any_way() -> None:
    assert normalized("km4-t7 q") == "KM4T7Q"


def test_names_are_distinct() -> None:
    names: set[str] = set()
    choose = random.Random(2).choice
    for _ in range(1000):
        names.add(new_name(choose, names))
    assert len(names) == 1000
    assert all(one.replace(" ", "").isalpha() for one in names)
