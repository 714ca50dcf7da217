"""Cells of CSV files that a spreadsheet would take for formulas (OWASP: CSV injection)."""

_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20")
"""With these a formula may begin; the last four are the full-width forms of the first."""


def text_cell(value: str) -> str:
    """Text as a cell: with a quote before it where it would be computed."""
    return f"'{value}" if value.startswith(_FORMULA) else value


def is_formula(cell: str) -> bool:
    """Whether a cell would be computed; a number with its sign would not."""
    if not cell.startswith(_FORMULA):
        return False
    try:
        float(cell)
    except ValueError:
        return True
    return cell[0] not in "+-"
