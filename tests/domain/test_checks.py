"""Whole numbers and formats of files: what is not valid is refused with what is."""

import json
from pathlib import Path
from typing import Any

import pytest

from hexapods.domain.checks import check_format, check_whole, parse_number
from hexapods.domain.errors import InvalidInput, OtherFormat


@pytest.mark.parametrize("value", [1, 5, 10_000])
def test_whole_number_in_its_range_is_accepted(value: int) -> None:
    check_whole("seeds", value, 1, 10_000)


@pytest.mark.parametrize(
    ("value", "high", "sentence"),
    [
        (0, 10_000, "seeds must be from 1 to 10,000, not 0"),
        (20_000, 10_000, "seeds must be from 1 to 10,000, not 20,000"),
        (0, None, "seeds must be at least 1, not 0"),
        (2.0, 10_000, "seeds must be a whole number, not 2.0"),
        (True, 10_000, "seeds must be a whole number, not True"),
        ("2", 10_000, "seeds must be a whole number, not '2'"),
    ],
)
def test_anything_else_is_refused_in_a_sentence(
    value: Any, high: int | None, sentence: str
) -> None:
    with pytest.raises(InvalidInput) as refused:
        check_whole("seeds", value, 1, high)
    assert str(refused.value) == sentence


NUMBERS = json.loads((Path(__file__).parents[1] / "cases" / "numbers.json").read_text("utf-8"))
"""How a number may be written; the page's test of typed text reads them too."""


@pytest.mark.parametrize("case", NUMBERS, ids=lambda case: repr(case["text"]))
def test_numbers_are_read_as_the_page_reads_them(case: dict[str, Any]) -> None:
    expected = case["text"] if case["value"] is None else case["value"]
    assert parse_number(case["text"], case["is_whole"]) == expected


def test_the_format_that_is_read_is_accepted() -> None:
    check_format("walk.json", 2, 2)
    check_format("robot.json", "hexapods-robot-1", "hexapods-robot-1")


@pytest.mark.parametrize("version", [1, 3, 2.0, True, "2", None, [2] * 1_000])
def test_any_other_format_is_refused_with_what_to_do(version: object) -> None:
    with pytest.raises(OtherFormat) as error:
        check_format("walk.json", version, 2)
    sentence = str(error.value)
    assert sentence.startswith(f"walk.json has format {repr(version)[:40]}; this version reads 2 ")
    assert "leaves the file as it is" in sentence
    assert len(sentence) < 250
