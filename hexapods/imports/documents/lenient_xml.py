"""Repair XML that MuJoCo reads and a strict parser does not: its encoding, and its form.

MuJoCo's parser is TinyXML-2. It takes `--` in comments, a blank line before `<?xml`, attributes
without a blank between them, `<` and a lone `&` in values, and more than one root, of which the
first counts. What it does not take either is refused here with the reason and the line.
"""

import codecs
import re
from collections.abc import Iterator

from hexapods.domain.errors import DamagedFile
from hexapods.imports.notes import quoted

_DECLARED = re.compile(rb"<\?xml[^>]{0,200}?encoding\s*=\s*[\"']([\w.:-]{1,40})[\"']")
_ENCODINGS = re.compile(
    r"utf-8|utf-16(-[lb]e)?|utf-32(-[lb]e)?|ascii|iso8859-\d+|cp\d+|koi8-[ru]|mac-\w+|gb2312|gbk"
    r"|gb18030|big5(hkscs)?|hz|shift_jis\w*|euc_\w+|iso2022_\w+|johab|tis-620"
)
"""Names by which Python knows encodings of text; its others are no character sets."""
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (b"<\0", "utf-16-le"),
    (b"\0<", "utf-16-be"),
)
_MARKUP = (("<!--", "-->", "comment"), ("<?", "?>", "declaration"))
_CDATA, _END_OF_CDATA = "<![CDATA[", "]]>"
_TAG = re.compile(r"<(\s*)(/?)([^\s<>/=\"'&!?]+)")
_ATTRIBUTE = re.compile(r"(\s*)([^\s<>/=\"'&]+)\s*=\s*(\"[^\"]*\"|'[^']*')")
_END_OF_TAG = re.compile(r"\s*(/?)>")
_UNQUOTED = re.compile(r"\s*([^\s<>/=\"']+)\s*=\s*[^\s\"']")
_LONE_AMPERSAND = re.compile(r"&(?!(?:amp|lt|gt|quot|apos|#\d{1,7}|#x[0-9a-fA-F]{1,6});)")
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff\ud800-\udfff]")
_MAX_REPAIRS = 4


class Malformed(DamagedFile):
    """A document that no parser reads; the message begins with the line."""


def codec_of(data: bytes) -> str:
    """Return Python's name of the encoding of a document.

    Raises:
        Malformed: if it is unknown.
    """
    for mark, name in _MARKS:
        if data.startswith(mark):
            return name
    declared = _DECLARED.search(data[:1000])
    name = declared[1].decode() if declared else "utf-8"
    try:
        codec = codecs.lookup(name).name
    except LookupError:
        codec = ""
    if not _ENCODINGS.fullmatch(codec):
        raise Malformed(f"line 1: the encoding {quoted(name)} is unknown; save it as UTF-8")
    if codec.startswith(("utf-16", "utf-32")):
        return "utf-8"  # its declaration could not be read otherwise
    return codec


def decode(data: bytes) -> tuple[str, str | None]:
    """Return the text of a document, and a sentence if its encoding is not the one that it says.

    Raises:
        Malformed: if its encoding is unknown.
    """
    codec = codec_of(data)
    if codec == "gb2312":
        codec = "gb18030"  # which has all of its characters, and those that are used beside them
    if any(data.startswith(mark) for mark, _ in _MARKS):
        return data.decode(codec, "replace"), None
    try:
        return data.decode(codec), None
    except UnicodeError as error:
        line = data.count(b"\n", 0, getattr(error, "start", 0)) + 1
    try:
        text, other = data.decode("utf-8"), "UTF-8"
    except UnicodeError:
        text = "".join(map(_of_windows, data.decode("cp1252", "surrogateescape")))
        other = "Windows-1252"
    return text, f"line {line} is not in {codec.upper()}, and was read as {other}"


def _of_windows(character: str) -> str:
    return character if character < "\ud800" or character > "\udfff" else "\ufffd"


def well_formed(text: str) -> tuple[str, list[str]]:
    """Return a document as well-formed XML with the same lines, and what was repaired.

    Raises:
        Malformed: naming what is wrong, and the line.
    """
    scanner = _Scanner(text)
    return "".join(scanner.pieces()), scanner.repairs


class _Scanner:
    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0
        self._counted_to, self._lines = 0, 1
        self._open: list[tuple[str, int]] = []
        self._has_root = False
        self.repairs: list[str] = []

    def pieces(self) -> Iterator[str]:
        while self._at < len(self._text):
            start = self._text.find("<", self._at)
            yield self._between(self._text[self._at : start if start >= 0 else None])
            if start < 0:
                break
            self._at = start
            yield self._markup()
            if self._has_root and not self._open:
                if self._text[self._at :].strip("\0 \t\r\n"):
                    self._repair("what follows its first element is left out")
                return
        if self._open:
            name, line = self._open[-1]
            raise Malformed(
                f"line {line}: <{quoted(name)}> is not closed; the file may be cut short"
            )
        raise Malformed("line 1: it has no element")

    def _line(self) -> int:
        """Return the line at which the scanner is."""
        self._lines += self._text.count("\n", self._counted_to, self._at)
        self._counted_to = self._at
        return self._lines

    def _repair(self, what: str) -> None:
        if len(self.repairs) < _MAX_REPAIRS and what not in "; ".join(self.repairs):
            self.repairs.append(f"{what} (line {self._line()})")

    def _between(self, text: str) -> str:
        """Return the text between two tags."""
        if not self._open:
            if text.strip("\0\ufeff \t\r\n"):
                raise Malformed(f"line {self._line()}: there is text before the first element")
            return "\n" * text.count("\n")
        return self._escaped(text)

    def _escaped(self, text: str) -> str:
        text, count = _LONE_AMPERSAND.subn("&amp;", text)
        if count:
            self._repair("`&` is written for `&amp;`")
        text, count = _CONTROL.subn("", text)
        if count:
            self._repair("control characters are left out")
        return text

    def _markup(self) -> str:
        for start, end, kind in _MARKUP:
            if self._text.startswith(start, self._at):
                return self._skipped(len(start), end, kind)
        if self._text.startswith(_CDATA, self._at):
            return self._verbatim()
        if self._text.startswith("<!", self._at):
            raise Malformed(
                f"line {self._line()}: a document type or an entity is not read; write the text "
                "itself"
            )
        return self._tag()

    def _end(self, length: int, end: str, kind: str) -> int:
        found = self._text.find(end, self._at + length)
        if found < 0:
            raise Malformed(f"line {self._line()}: the {kind} that begins here does not end")
        return found + len(end)

    def _skipped(self, length: int, end: str, kind: str) -> str:
        """Return the line ends of a comment or a declaration."""
        stop = self._end(length, end, kind)
        text = self._text[self._at + length : stop - len(end)]
        if kind == "comment" and ("--" in text or text.endswith("-")):
            self._repair("`--` is in a comment")
        if kind == "declaration" and self._at:
            self._repair("something is before `<?xml`")
        self._at = stop
        return "\n" * text.count("\n")

    def _verbatim(self) -> str:
        stop = self._end(len(_CDATA), _END_OF_CDATA, "CDATA section")
        text = self._text[self._at : stop]
        self._at = stop
        return _CONTROL.sub("", text) if self._open else "\n" * text.count("\n")

    def _tag(self) -> str:
        tag = _TAG.match(self._text, self._at)
        if tag is None:
            raise Malformed(f"line {self._line()}: after `<` a name is missing")
        line, name = self._line(), tag[3]
        if tag[1]:
            self._repair("a blank is after `<`")
        blanks = [tag[1]]
        self._at = tag.end()
        attributes = "" if tag[2] else self._attributes(name)
        end = _END_OF_TAG.match(self._text, self._at)
        if end is None:
            raise self._no_end_of_tag(name)
        blanks.append(self._text[self._at : end.end()])
        self._at = end.end()
        if tag[2]:
            self._close(name, line)
        elif not end[1]:
            self._open.append((name, line))
        self._has_root = True
        lines = "\n" * sum(blank.count("\n") for blank in blanks)  # whole numbers
        return f"<{tag[2]}{name}{attributes}{lines}{end[1]}>"

    def _attributes(self, tag: str) -> str:
        pieces, names = [], set()
        while attribute := _ATTRIBUTE.match(self._text, self._at):
            blank, name, value = attribute.groups()
            if not blank:
                self._repair(f"no blank is before {quoted(name)} of <{quoted(tag)}>")
            if name in names:
                raise Malformed(f"line {self._line()}: <{quoted(tag)}> has {quoted(name)} twice")
            names.add(name)
            if "<" in value:
                self._repair("`<` is written for `&lt;`")
            plain = self._escaped(value).replace("<", "&lt;")
            lines = "\n" * blank.count("\n")
            pieces.append(f" {lines}{name}={plain}")
            self._at = attribute.end()
        return "".join(pieces)

    def _no_end_of_tag(self, name: str) -> Malformed:
        unquoted = _UNQUOTED.match(self._text, self._at)
        why = "is no attribute, nor the end of the tag"
        if unquoted:
            return Malformed(
                f"line {self._line()}: the value of {quoted(unquoted[1])} of <{quoted(name)}> "
                "needs quotes"
            )
        rest = self._text[self._at :][:20].split("\n")[0].strip()
        return Malformed(f"line {self._line()}: in <{quoted(name)}> {quoted(rest)!r} {why}")

    def _close(self, name: str, line: int) -> None:
        if not self._open:
            raise Malformed(f"line {line}: </{quoted(name)}> closes nothing")
        opened, opened_line = self._open.pop()
        if opened != name:
            raise Malformed(
                f"line {line}: </{quoted(name)}> stands where <{quoted(opened)}> of line "
                f"{opened_line} is to be closed"
            )
