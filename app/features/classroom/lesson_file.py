"""Lessons as YAML files, as teachers keep and share them."""

from typing import Any

from app.features.classroom.lesson import Lesson, plain, read_lesson
from hexapods.domain.errors import InvalidInput
from hexapods.domain.plain_yaml import MAX_NODES, nodes_of, read_plain, write_plain

MEDIA_TYPE = "application/yaml"
MAX_BYTES = 256 * 1024


def read_file(content: bytes, name: str) -> Lesson:
    """Read a lesson from a YAML file.

    Args:
        content: of the file.
        name: of the file, for messages.

    Raises:
        InvalidInput: if it is no YAML, has aliases or tags, is too large, or is no lesson.
    """
    if len(content) > MAX_BYTES:
        raise InvalidInput(f"{name} is larger than {MAX_BYTES // 1024} kB, the most of a lesson")
    return read_lesson(read_plain(content, name, "lesson"))


def read_plain_values(data: Any) -> Lesson:
    """Read a lesson from plain values, such as those of JSON; as a file it can be read, too.

    Raises:
        InvalidInput: if it has too many names and values for a file, or is no lesson.
    """
    try:
        count = nodes_of(data)
    except RecursionError:
        count = 0  # which `read_lesson` refuses
    if count > MAX_NODES:
        raise InvalidInput(f"the lesson has more than {MAX_NODES:,} names and values")
    return read_lesson(data)


def write_file(lesson: Lesson) -> str:
    """Return a lesson as a YAML file."""
    return write_plain(plain(lesson))
