"""Guesses and repairs made while a robot was read, as sentences."""

from collections.abc import Iterable

from hexapods.domain.text import visible

MAX_NOTES, _MAX_NAME, _MAX_LISTED = 40, 60, 6


def quoted(name: str) -> str:
    """Return a name of the file fit for a message: short, and without invisible characters."""
    text = visible(name)
    return text if len(text) <= _MAX_NAME else f"{text[: _MAX_NAME - 1]}…"


def listed(names: Iterable[str]) -> str:
    """Return names of the file in a row, the first of them if there are many."""
    shown = [quoted(name) for name in names]
    more = len(shown) - _MAX_LISTED
    return ", ".join(shown[:_MAX_LISTED]) + (f" and {more:,} more" if more > 0 else "")


class Notes:
    """Collects guesses and repairs; the same sentence once, and not more than some.

    Attributes:
        guesses, repairs: the sentences.
    """

    def __init__(self) -> None:
        self.guesses: list[str] = []
        self.repairs: list[str] = []

    def guess(self, sentence: str) -> None:
        """Add a note about a guess."""
        _add(self.guesses, sentence)

    def repair(self, sentence: str) -> None:
        """Add a note about a repair."""
        _add(self.repairs, sentence)


def _add(sentences: list[str], sentence: str) -> None:
    if sentence not in sentences and len(sentences) < MAX_NOTES:
        sentences.append(sentence)
