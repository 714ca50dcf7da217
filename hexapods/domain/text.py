"""Text that users see: names, tags and notes, CSV cells, and how numbers are written."""

import sys
import unicodedata
from collections.abc import Iterable
from functools import cache

from hexapods.domain.errors import InvalidInput

MAX_NAME = 100
NAMES = (
    f"text of at most {MAX_NAME} characters, without control characters, marks of writing "
    "direction or other invisible characters"
)
"""Description of a valid name, for messages."""
MAX_TAG, MAX_TAGS = 30, 20
TAGS = (
    f"a list of at most {MAX_TAGS} tags, each text of at most {MAX_TAG} characters, without "
    "commas, control characters or other invisible characters"
)
"""Description of valid tags, for messages."""
TAG_SEPARATOR = ","
"""Separator of tags that are written in one line."""
MAX_NOTES = 4_000
NOTES = (
    f"text of at most {MAX_NOTES:,} characters, without control characters but line breaks and tabs"
)
"""Description of valid notes, for messages."""
MAX_MESSAGE = 10_000
"""Most characters of a stored error; exceptions of user-defined agents may be longer."""
NOTES_CONTROLS = "\t\n\r"
"""Control characters that notes may have."""
_INVISIBLE = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode categories: controls, format controls (bidirectional marks, joiners, tags), surrogates,
and separators of lines and paragraphs. With them a name could be spoofed to look like another."""
_BLANK_LETTERS = frozenset("\u115f\u1160\u3164\uffa0")
"""Hangul fillers: in a category of letters, but rendered as blank."""
_REPLACEMENT = "\ufffd"


def check_name(name: str) -> str:
    """Validate a name, and return it without leading and trailing whitespace.

    Raises:
        InvalidInput: if it is too long, or has an invisible character.
    """
    return _checked(name, MAX_NAME, f"a name must be {NAMES}")


def check_tags(tags: Iterable[str]) -> tuple[str, ...]:
    """Validate tags; return them stripped, without blank ones and repetitions.

    Tags that differ only in upper and lower case are the same; the first spelling stays.

    Raises:
        InvalidInput: if there are too many, one is too long, or has an invisible character.
    """
    valid = f"tags must be {TAGS}"
    unique: dict[str, str] = {}
    for tag in tags:
        text = _checked(tag, MAX_TAG, valid)
        if TAG_SEPARATOR in text:
            raise InvalidInput(f"{valid}; one is {text!r}")
        if text:
            unique.setdefault(text.casefold(), text)
    if len(unique) > MAX_TAGS:
        raise InvalidInput(f"{valid}; there are {len(unique):,}")
    return tuple(unique.values())


def check_notes(notes: str) -> str:
    """Validate notes; return them without surrounding whitespace, their line breaks as LF.

    Raises:
        InvalidInput: if they are too long, or have an invisible character.
    """
    return _checked(notes, MAX_NOTES, f"notes must be {NOTES}", NOTES_CONTROLS).replace(
        "\r\n", "\n"
    )


def _checked(text: str, limit: int, valid: str, also_allowed: str = "") -> str:
    if len(text) > limit:
        raise InvalidInput(f"{valid}; it has {len(text):,} characters")
    hidden = next(
        (
            character
            for character in text
            if _is_invisible(character) and character not in also_allowed
        ),
        None,
    )
    if hidden is not None:
        raise InvalidInput(f"{valid}; it has U+{ord(hidden):04X}")
    return text.strip()


@cache
def invisible_ranges() -> tuple[tuple[int, int], ...]:
    """Return the ranges of code points not allowed in a name, as sorted (first, last).

    Surrogates are excluded: they cannot occur in UTF-8.
    """
    ranges: list[tuple[int, int]] = []
    for point in range(sys.maxunicode + 1):
        if not _is_invisible(chr(point)) or 0xD800 <= point <= 0xDFFF:
            continue
        is_next = bool(ranges) and ranges[-1][1] == point - 1
        ranges.append((ranges.pop()[0] if is_next else point, point))
    return tuple(ranges)


def storable(text: str) -> str:
    """Replace NUL and lone surrogates, which databases reject, by U+FFFD."""
    whole = text.replace("\0", _REPLACEMENT)
    return whole.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def message(text: str) -> str:
    """Return the message of an error as it is stored, cut where it is too long."""
    whole = storable(text)
    return whole if len(whole) <= MAX_MESSAGE else f"{whole[: MAX_MESSAGE - 1]}…"


def visible(text: str, also_allowed: str = "") -> str:
    """Replace each invisible character by U+FFFD, the replacement character."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        _REPLACEMENT if _is_invisible(character) and character not in also_allowed else character
        for character in text
    )


def _is_invisible(character: str) -> bool:
    return unicodedata.category(character) in _INVISIBLE or character in _BLANK_LETTERS


_SMALLEST_GROUPED = 10_000
_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20")
"""First characters of spreadsheet formulas; the last four are full-width forms of the first."""


def text_cell(value: str) -> str:
    """Escape text for a CSV cell by a leading quote, if a spreadsheet would evaluate it.

    Prevents CSV (formula) injection.
    """
    return f"'{value}" if value.startswith(_FORMULA) else value


def is_formula(cell: str) -> bool:
    """Whether a spreadsheet would evaluate a cell as a formula; a signed number is none."""
    if not cell.startswith(_FORMULA):
        return False
    try:
        float(cell)
    except ValueError:
        return True
    return cell[0] not in "+-"


def whole(number: int) -> str:
    """Format a whole number, from 10 000 on in groups of digits with thin spaces between."""
    return f"{number:,}".replace(",", "\u202f") if abs(number) >= _SMALLEST_GROUPED else f"{number}"


def counted(number: int, noun: str, plural: str | None = None) -> str:
    """Format a count with its noun: `1 seed`, `30 seeds`."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"


def metres(value: float) -> str:
    """Format a distance to the centimetre, `0.36 m`; never `-0.00 m`, with U+2212 as the minus."""
    return f"{round(value, 2) + 0.0:.2f}\u00a0m".replace("-", "−")
