"""Text that people see: which characters a name may have, and what stands for the others."""

import sys
import unicodedata
from functools import cache

from app.domain.errors import InvalidInput

MAX_NAME = 100
NAMES = (
    f"text of at most {MAX_NAME} characters, without control characters, marks of writing "
    "direction or other invisible characters"
)
"""What a name may be."""
_INVISIBLE = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode categories: controls, format controls (bidirectional marks, joiners, tags), surrogates,
and separators of lines and paragraphs. A name with one reads as another than it is."""
_BLANK_LETTERS = frozenset("\u115f\u1160\u3164\uffa0")
"""Fillers of Hangul: letters by their category, and drawn as nothing."""
_REPLACEMENT = "\ufffd"


def check_name(name: str) -> str:
    """A name as it is kept, without spaces around it.

    Raises:
        InvalidInput: if it is too long, or has a character that cannot be seen.
    """
    if len(name) > MAX_NAME:
        raise InvalidInput(f"a name must be {NAMES}; it has {len(name):,} characters")
    hidden = next((character for character in name if _is_invisible(character)), None)
    if hidden is not None:
        raise InvalidInput(f"a name must be {NAMES}; it has U+{ord(hidden):04X}")
    return name.strip()


@cache
def invisible_ranges() -> tuple[tuple[int, int], ...]:
    """First and last code points of the characters that a name may not have, in order.

    Halves of surrogate pairs are left out: no UTF-8 has them.
    """
    found: list[tuple[int, int]] = []
    for point in range(sys.maxunicode + 1):
        if not _is_invisible(chr(point)) or 0xD800 <= point <= 0xDFFF:
            continue
        is_next = bool(found) and found[-1][1] == point - 1
        found.append((found.pop()[0] if is_next else point, point))
    return tuple(found)


def visible(text: str) -> str:
    """The text with a mark in place of each character that a name may not have."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(_REPLACEMENT if _is_invisible(one) else one for one in text)


def _is_invisible(character: str) -> bool:
    return unicodedata.category(character) in _INVISIBLE or character in _BLANK_LETTERS


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
