"""A spreadsheet computes nothing that came out of a run."""

import pytest

from app.domain.text import is_formula, text_cell


@pytest.mark.parametrize("begin", ["=", "+", "-", "@", "\t", "\r", "\n", "＝"])
def test_text_that_would_be_computed_is_quoted(begin: str) -> None:
    assert is_formula(f"{begin}cmd|' /C calc'!A0")
    assert text_cell(f"{begin}1") == f"'{begin}1"
    assert not is_formula(text_cell(f"{begin}1+1"))


@pytest.mark.parametrize("number", ["-0.5", "+1", "1e-5", "-inf", "", "0.25"])
def test_numbers_stay_numbers(number: str) -> None:
    assert not is_formula(number)
