"""Reads XML of strangers within bounds, and writes it with the line of each element kept.

What is not well-formed is repaired by `lenient_xml` where MuJoCo reads it too. Entities, document
types and processing of other files do not exist here: each is refused, or ignored by the parser.
MuJoCo's own parser sees only what `Document.text` wrote.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.lenient_xml import Malformed, codec_of, decode, well_formed
from hexapods.imports.documents.upload import last_part
from hexapods.imports.notes import quoted

MAX_ELEMENTS = 20_000
"""Elements that are kept of a document."""
MAX_PARSED = 100_000
"""Elements of a document, with those that are left out."""
MAX_DEPTH = 200
MAX_ATTRIBUTES = 60
MAX_ATTRIBUTE = 20_000
"""Characters of an attribute."""
MAX_NUMBERS = 1_000_000
"""Characters of an attribute that holds the vertices or faces of a mesh."""
_LISTS = frozenset({"vertex", "face", "normal", "texcoord"})
MAX_NAME = 200


@dataclass(eq=False)
class Element:
    """An element of a document.

    Attributes:
        tag: its name.
        line: its line in the document.
        attributes: by name.
        children: in order.
        text: what is in it, of the tags whose text is kept.
        file: path of the document that it is from, if that was included by another.
    """

    tag: str
    line: int
    attributes: dict[str, str] = field(default_factory=dict)
    children: list["Element"] = field(default_factory=list)
    text: str = ""
    file: str = ""

    def __iter__(self) -> Iterator["Element"]:
        return iter(self.children)

    def all(self, *tags: str) -> Iterator["Element"]:
        """Iterate over all elements below this one that have one of these tags, in order."""
        waiting = self.children[::-1]
        while waiting:
            element = waiting.pop()
            if element.tag in tags or not tags:
                yield element
            waiting.extend(element.children[::-1])

    def first(self, tag: str) -> "Element | None":
        """Return the first child of this tag."""
        return next((child for child in self.children if child.tag == tag), None)

    def keep(self, keeps: Callable[["Element"], bool]) -> None:
        """Remove the elements below this one that are not to be kept, with all below them."""
        self.children = [child for child in self.children if keeps(child)]
        for child in self.children:
            child.keep(keeps)

    @property
    def place(self) -> str:
        """Its tag, name and line, for messages: `<geom> "foot" in line 12`."""
        name = self.attributes.get("name", "")
        return f"<{quoted(self.tag)}>{f' {quoted(name)}' if name else ''} in line {self.where}"

    @property
    def where(self) -> str:
        """Its line, and the document if that was included: `12 of leg.xml`."""
        return f"{self.line} of {quoted(last_part(self.file))}" if self.file else str(self.line)


def read_xml(
    data: bytes, label: str, texts: Collection[str] = (), repairs: list[str] | None = None
) -> Element:
    """Parse a document, also one that is not well-formed if MuJoCo reads it.

    Args:
        data: the document.
        label: its name for messages.
        texts: tags of elements whose text is kept.
        repairs: receives a sentence if it is not well-formed.

    Raises:
        DamagedFile: if it cannot be parsed, or exceeds a bound.
    """
    try:
        root, kinds = _parsed(data, label, texts)
    except Malformed as error:
        raise DamagedFile(f"{quoted(label)} is no whole XML document: {error}") from error
    if repairs is not None and kinds:
        repairs.append(f"{quoted(label)} is no proper XML, but could be read: {'; '.join(kinds)}")
    return root


def _parsed(data: bytes, label: str, texts: Collection[str]) -> tuple[Element, list[str]]:
    """Return the root of a document, and what was repaired.

    Raises:
        Malformed: if it cannot be parsed.
        DamagedFile: if it exceeds a bound.
    """
    codec_of(data)
    try:
        return _DocumentReader(label, texts).read(data), []
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, DamagedFile):  # of a handler, and a ValueError too
            raise
    text, of_encoding = decode(data)
    text, kinds = well_formed(text)
    try:
        root = _DocumentReader(label, texts).read(text.encode(), "utf-8")
    except expat.ExpatError as error:
        why = expat.ErrorString(error.code)
        raise Malformed(f"line {error.lineno}: {why}") from error
    return root, [*([of_encoding] if of_encoding else []), *kinds]


class _DocumentReader:
    def __init__(self, label: str, texts: Collection[str]) -> None:
        self._label, self._texts = quoted(label), texts
        self._parts: list[str] | None = None
        self._root: Element | None = None
        self._open: list[Element] = []
        self._count = 0

    def read(self, data: bytes, encoding: str | None = None) -> Element:
        """Parse a document; `encoding` counts more than what it says.

        Raises:
            ExpatError, ValueError, LookupError: if it is not well-formed, or its encoding unknown.
            DamagedFile: if it exceeds a bound.
        """
        self._parser = expat.ParserCreate(encoding)
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        if self._texts:
            self._parser.buffer_text = True
            self._parser.CharacterDataHandler = self._read_text
        self._parser.StartDoctypeDeclHandler = self._refuse_types
        self._parser.EntityDeclHandler = self._refuse_types
        self._parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
        self._parser.Parse(data, True)
        if self._root is None:
            raise DamagedFile(f"{self._label} has no element")
        return self._root

    def _problem(self, what: str) -> DamagedFile:
        return DamagedFile(f"{self._label}, line {self._parser.CurrentLineNumber}: {what}")

    def _refuse_types(self, *_: object) -> None:
        raise self._problem("a document type or an entity is not read; write the text itself")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > MAX_PARSED:
            raise self._problem(f"it has more than {MAX_PARSED:,} elements")
        if len(self._open) >= MAX_DEPTH:
            raise self._problem(f"elements are nested more than {MAX_DEPTH} deep")
        if len(attributes) > MAX_ATTRIBUTES:
            raise self._problem(f"<{quoted(tag)}> has more than {MAX_ATTRIBUTES} attributes")
        element = Element(tag, self._parser.CurrentLineNumber, dict(attributes))
        if self._open:
            self._open[-1].children.append(element)
        else:
            self._root = element
        self._open.append(element)
        self._parts = [] if tag in self._texts else None

    def _read_text(self, text: str) -> None:
        if self._parts is not None:
            self._parts.append(text)

    def _end(self, _: str) -> None:
        element = self._open.pop()
        if self._parts is not None:
            element.text = "".join(self._parts)
            self._parts = None


def check_kept(root: Element) -> None:
    """Check the bounds of what was kept of a document.

    Raises:
        DamagedFile: if it has too many elements, or an attribute is too long.
    """
    for number, element in enumerate([root, *root.all()], start=1):
        if number > MAX_ELEMENTS:
            raise DamagedFile(f"it has more than {MAX_ELEMENTS:,} elements")
        for name, value in element.attributes.items():
            most = MAX_NUMBERS if name in _LISTS else MAX_ATTRIBUTE
            most = MAX_NAME if name in ("name", "class") else most
            if len(value) > most:
                raise DamagedFile(
                    f"line {element.line}: {quoted(name)} of <{quoted(element.tag)}> has "
                    f"{len(value):,} characters; it may have {most:,}"
                )


@dataclass(frozen=True)
class Document:
    """A document as MuJoCo reads it, each tag in a line of its own.

    Attributes:
        text: the document.
        lines: line in the original of each line, with the document if that was included.
    """

    text: str
    lines: tuple[str, ...]

    def original_line(self, line: int) -> str | None:
        """Return the line in the original of a line, from 1."""
        return self.lines[line - 1] if 0 < line <= len(self.lines) else None


def write_xml(root: Element) -> Document:
    """Write a document."""
    texts: list[str] = []
    lines: list[str] = []

    def write(element: Element) -> None:
        pairs = "".join(
            f" {name}={quoteattr(' '.join(value.split()))}"
            for name, value in element.attributes.items()
        )
        texts.append(f"<{element.tag}{pairs}{'' if element.children else '/'}>")
        lines.append(element.where)
        for child in element.children:
            write(child)
        if element.children:
            texts.append(f"</{element.tag}>")
            lines.append(element.where)

    write(root)
    return Document("\n".join(texts), tuple(lines))
