"""Names contain no invisible characters, and numbers are written as on the page."""

import unicodedata

import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.domain.text import (
    MAX_NOTES,
    MAX_TAG,
    MAX_TAGS,
    check_name,
    check_notes,
    check_tags,
    metres,
    visible,
    whole,
)

BIDI = [*map(chr, range(0x202A, 0x202F)), *map(chr, range(0x2066, 0x206A)), "\u200e", "\u200f"]
HIDDEN = [*BIDI, "\u061c", "\u200b", "\u200d", "\u2060", "\ufeff", "\u00ad", "\U000e0041", "\u2028"]


@pytest.mark.parametrize("mark", [*HIDDEN, "\x00", "\x1b", "\x7f", "\ud800", "\u3164"])
def test_an_invisible_character_is_refused_and_named(mark: str) -> None:
    with pytest.raises(InvalidInput, match=rf"invisible.*U\+{ord(mark):04X}"):
        check_name(f"a{mark}b")
    assert visible(f"a{mark}b") == "a\ufffdb"


@pytest.mark.parametrize("name", ["", "Ä ß 蜘蛛 🕷 ❤️ ِعربي עברית", "=1+1", "<b>", "x" * 100])
def test_all_other_characters_are_allowed_in_names(name: str) -> None:
    assert check_name(name) == name
    assert visible(name) == name
    assert all(unicodedata.category(character) != "Cf" for character in name)


def test_a_long_name_is_refused() -> None:
    with pytest.raises(InvalidInput, match="at most 100"):
        check_name("x" * 101)


def test_tags_are_kept_once_without_blanks_in_the_first_spelling() -> None:
    assert check_tags([" ice ", "Ice", "", "  ", "limp leg 1", "Öl", "öl"]) == (
        "ice",
        "limp leg 1",
        "Öl",
    )
    for bad in (["x" * (MAX_TAG + 1)], ["a\nb"], ["a,b"], [f"{n}" for n in range(MAX_TAGS + 1)]):
        with pytest.raises(InvalidInput, match="at most 20 tags, each text of at most 30"):
            check_tags(bad)


def test_notes_have_lines_and_nothing_invisible() -> None:
    notes = "first\r\n\tsecond\n"
    assert check_notes(notes) == "first\n\tsecond"
    for bad in ("a\u202eb", "\x1b[2J", "x" * (MAX_NOTES + 1)):
        with pytest.raises(InvalidInput, match="at most 4,000 characters"):
            check_notes(bad)


def test_digits_are_grouped_from_ten_thousand_on_without_commas() -> None:
    assert [whole(number) for number in (0, 1000, 9999, 10_000, -1_234_567)] == [
        "0",
        "1000",
        "9999",
        "10\u202f000",
        "-1\u202f234\u202f567",
    ]


def test_distances_have_a_true_minus_and_no_negative_zero() -> None:
    assert [metres(value) for value in (0.376, -0.012, -0.001)] == [
        "0.38\u00a0m",
        "−0.01\u00a0m",
        "0.00\u00a0m",
    ]
