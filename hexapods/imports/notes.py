"""Guesses and repairs made while a robot was read: sentences, with what each is about."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from hexapods.domain.records import Record
from hexapods.domain.text import visible
from hexapods.imports.choices import Choices

Topic = Literal[
    "file",
    "links",
    "base",
    "legs",
    "forward",
    "groups",
    "stance",
    "joints",
    "servos",
    "masses",
    "size",
    "shapes",
    "meshes",
]

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


@dataclass(frozen=True)
class Note(Record):
    """A guess or a repair, as a sentence with what it is about.

    Attributes:
        kind: a guess is to be confirmed or corrected, a repair changed what the file says.
        topic: what it is about; for most guesses `Choices` has a field by which to correct it.
        text: the sentence, which names what is in the file.
        parts: names in the file of the bodies and joints that it is about; empty for the whole.
        offer: a choice that the sentence offers instead; None where it offers none.
    """

    kind: Literal["guess", "repair"]
    topic: Topic
    text: str
    parts: tuple[str, ...] = ()
    offer: Choices | None = None


class Notes:
    """Collects guesses and repairs; the same sentence once, and not more than some of each kind."""

    def __init__(self) -> None:
        self._notes: list[Note] = []

    def guess(
        self,
        topic: Topic,
        text: str,
        parts: Iterable[str] = (),
        offer: Choices | None = None,
    ) -> None:
        """Add a note about a guess."""
        self._add(Note("guess", topic, text, tuple(parts), offer))

    def repair(
        self,
        topic: Topic,
        text: str,
        parts: Iterable[str] = (),
        offer: Choices | None = None,
    ) -> None:
        """Add a note about a repair."""
        self._add(Note("repair", topic, text, tuple(parts), offer))

    def copy(self) -> "Notes":
        """Return a collection that begins with the same notes."""
        notes = Notes()
        notes._notes = self._notes.copy()
        return notes

    def collected(self) -> tuple[Note, ...]:
        """Return the notes in the order in which they were made."""
        return tuple(self._notes)

    def _add(self, note: Note) -> None:
        alike = [other for other in self._notes if other.kind == note.kind]
        if len(alike) < MAX_NOTES and all(other.text != note.text for other in alike):
            self._notes.append(note)
