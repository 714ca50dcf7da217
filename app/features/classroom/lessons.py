"""Finds lessons: those that come with the server, and those that were stored on it.

A built-in lesson is one file, in English. Its texts in another language are in the catalogue of
that language, by the English ones: what is asked, run and opened is stated once.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

from app.features.classroom.lesson import Lesson, plain, read_lesson
from app.features.classroom.lesson_file import read_file
from app.features.classroom.lesson_rows import LessonRows
from app.storage.database.stored_rows import DecodedRows
from app.storage.errors import Busy, NotFound
from hexapods.domain.errors import UnknownName

MAX_LESSONS = 500
"""Lessons stored at most."""
ID_DIGITS = 12
ENGLISH = "en"
_FOLDER = Path(__file__).with_name("built_in")
_RETRY_S = 60
_NO_TEXTS = frozenset({"language", "state", "show", "may", "go", "teach", "kind"})
"""Members of a lesson that name parts of the page and settings."""


@dataclass(frozen=True)
class FoundLesson:
    """A lesson by its id.

    Attributes:
        id: of a built-in lesson its name; else a hash of its content, the same on every server.
        lesson: the document.
        is_built_in: whether it comes with the server, so that it cannot be deleted.
    """

    id: str
    lesson: Lesson
    is_built_in: bool


class Lessons:
    """The lessons of a server. Thread-safe."""

    def __init__(self, rows: LessonRows) -> None:
        """Use the rows of a database."""
        self._rows = rows

    def add(self, lesson: Lesson) -> FoundLesson:
        """Store a lesson, unless it is stored already.

        Raises:
            Busy: if there are too many.
            StorageFull, StorageFailed: if it cannot be stored.
        """
        document = plain(lesson)
        stored = FoundLesson(_content_id(document), lesson, is_built_in=False)
        is_stored = bool(self._rows.read(_stored, stored.id).sound)
        if not is_stored and not self._rows.put(stored.id, lesson.title, document, MAX_LESSONS):
            raise Busy(f"{MAX_LESSONS} lessons are stored, which is the most; delete one", _RETRY_S)
        return stored

    def get(self, lesson_id: str, language: str = ENGLISH) -> FoundLesson:
        """Return a lesson, a built-in one in a language; others have one.

        Raises:
            NotFound: if there is none of this id, or it cannot be read.
            UnknownName: if the built-in ones are not in that language.
        """
        built_in_lesson = built_in(language).get(lesson_id)
        if built_in_lesson is not None:
            return FoundLesson(lesson_id, built_in_lesson, is_built_in=True)
        return _sound(self._rows.read(_stored, lesson_id), lesson_id)

    def all(self, language: str = ENGLISH) -> list[FoundLesson]:
        """Return all lessons that can be read: the built-in ones, then the stored, newest first.

        Raises:
            UnknownName: if the built-in ones are not in that language.
        """
        lessons = [
            FoundLesson(lesson_id, lesson, is_built_in=True)
            for lesson_id, lesson in built_in(language).items()
        ]
        return lessons + self._rows.read(_stored).sound

    def delete(self, lesson_id: str) -> datetime | None:
        """Delete a stored lesson so that it can be restored; rooms that have it keep it.

        Returns:
            until when; None if it is gone at once, as the disk is full.

        Raises:
            NotFound: if there is no stored lesson of this id.
        """
        return self._rows.delete(lesson_id)

    def restore(self, lesson_id: str) -> FoundLesson:
        """Bring back a stored lesson that was deleted lately; one that is there stays.

        Raises:
            NotFound: if there is no such lesson, or it was deleted too long ago.
        """
        return _sound(self._rows.restore(lesson_id, _stored), lesson_id)


@cache
def languages() -> tuple[str, ...]:
    """Return the languages of the built-in lessons, English first."""
    return (ENGLISH, *sorted(path.stem for path in _FOLDER.glob("languages/*.json")))


@cache
def built_in(language: str = ENGLISH) -> Mapping[str, Lesson]:
    """Return the lessons that come with the server, by id, in a language.

    Raises:
        UnknownName: if they are not in that language.
    """
    if language == ENGLISH:
        return {
            path.stem: read_file(path.read_bytes(), path.name)
            for path in sorted(_FOLDER.glob("*.yaml"))
        }
    if language not in languages():
        raise UnknownName("language of the built-in lessons", language[:40], languages())
    catalogue = json.loads((_FOLDER / f"languages/{language}.json").read_text("utf-8"))
    return {
        lesson_id: read_lesson({**_translated(plain(lesson), catalogue), "language": language})
        for lesson_id, lesson in built_in().items()
    }


def in_all_languages(stored: FoundLesson) -> list[Lesson]:
    """Return a lesson in each language that it is in."""
    if not stored.is_built_in:
        return [stored.lesson]
    return [built_in(language)[stored.id] for language in languages()]


def _translated(document: Any, catalogue: Mapping[str, str]) -> Any:
    """Return the document of a lesson with its texts as a catalogue has them."""
    if isinstance(document, str):
        return catalogue.get(document, document)
    if isinstance(document, list):
        return [_translated(item, catalogue) for item in document]
    if not isinstance(document, dict):
        return document
    return {
        name: value if name in _NO_TEXTS else _translated(value, catalogue)
        for name, value in document.items()
    }


def _sound(rows: DecodedRows, lesson_id: str) -> FoundLesson:
    for row in rows.damaged:
        raise NotFound(f"the lesson {lesson_id} is damaged: {row.damaged}; delete it")
    if not rows.sound:
        raise NotFound(f"there is no lesson {lesson_id!r}; GET /api/v1/lessons lists all")
    stored: FoundLesson = rows.sound[0]
    return stored


def _stored(**row: Any) -> FoundLesson:
    return FoundLesson(row["id"], read_lesson(row["document"]), is_built_in=False)


def _content_id(document: Mapping[str, object]) -> str:
    text = json.dumps(document, sort_keys=True, ensure_ascii=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:ID_DIGITS]
