"""Write XML documents: numbers with all their digits, and names that every reader accepts."""

import re
from collections.abc import Iterable, Mapping
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from hexapods.domain.text import visible

_SEPARATORS = re.compile(r"[/\\]")


def numbers(values: Iterable[float]) -> str:
    """Return numbers as an attribute has them; each is the shortest text that gives it again."""
    return " ".join(
        repr(number) if number % 1 else str(int(number)) for number in map(_plain, values)
    )


def _plain(value: float) -> float:
    # Without the sign of a zero.
    return float(value) + 0.0


def add(parent: Element, tag: str, attributes: Mapping[str, str]) -> Element:
    """Add an element to its parent."""
    return SubElement(parent, tag, dict(attributes))


def name_of(text: str) -> str:
    """Return a name without invisible characters and slashes, which separate scopes elsewhere."""
    return _SEPARATORS.sub("_", visible(text)).strip() or "robot"


def document(root: Element) -> str:
    """Return an indented document."""
    indent(root)
    return tostring(root, encoding="unicode") + "\n"
