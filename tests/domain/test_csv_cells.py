"""Text cells of CSV files are escaped against formula injection."""

import pytest

from hexapods.domain.text import is_formula, text_cell


@pytest.mark.parametrize("begin", ["=", "+", "-", "@", "\t", "\r", "\n", "＝"])
def test_text_that_a_spreadsheet_would_evaluate_is_quoted(begin: str) -> None:
    assert is_formula(f"{begin}cmd|' /C calc'!A0")
    assert text_cell(f"{begin}1") == f"'{begin}1"
    assert not is_formula(text_cell(f"{begin}1+1"))


@pytest.mark.parametrize("number", ["-0.5", "+1", "1e-5", "-inf", "", "0.25"])
def test_signed_numbers_are_not_formulas(number: str) -> None:
    assert not is_formula(number)
