import re

import pytest

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.xml import (
    MAX_ATTRIBUTE,
    MAX_DEPTH,
    MAX_ELEMENTS,
    MAX_PARSED,
    check_kept,
    read_xml,
    write_xml,
)

LAUGHS = b'<!DOCTYPE a [<!ENTITY b "ha"><!ENTITY c "&b;&b;&b;">]><a name="&c;"/>'


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (LAUGHS, "line 1: a document type or an entity is not read"),
        (b'<!DOCTYPE a SYSTEM "file:///etc/passwd"><a/>', "a document type or an entity"),
        (b"<a>" * (MAX_DEPTH + 1), f"nested more than {MAX_DEPTH} deep"),
        (b"<a>" + b"<b/>" * MAX_PARSED, f"more than {MAX_PARSED:,} elements"),
        (b"<a " + b" ".join(b'b%d="1"' % n for n in range(70)) + b"/>", "more than 60 attributes"),
        (b"<a>\n<b>\n</a>", "line 3: </a> stands where <b> of line 2 is to be closed"),
        (b"\xff\xfe\x00", "is no whole XML document"),
        (b'<?xml version="1.0" encoding="utf-99"?><a/>', "XML document"),
        (b"", "is no whole XML document"),
    ],
)
def test_xml_that_exceeds_a_bound_is_refused(data: bytes, said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)) as raised:
        read_xml(data, "robot.xml")
    assert str(raised.value).count("robot.xml") == 1


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"<a>" + b"<b/>" * MAX_ELEMENTS + b"</a>", f"more than {MAX_ELEMENTS:,} elements"),
        (b'<a pos="' + b"1 " * MAX_ATTRIBUTE + b'"/>', "line 1: pos of <a> has 40,000 characters"),
        (b'<a name="' + b"x" * 300 + b'"/>', "name of <a> has 300 characters; it may have 200"),
    ],
)
def test_what_is_kept_has_bounds_of_its_own(data: bytes, said: str) -> None:
    root = read_xml(data, "robot.xml")

    with pytest.raises(DamagedFile, match=re.escape(said)):
        check_kept(root)


def test_a_document_keeps_its_lines() -> None:
    text = b"<?xml version='1.0'?>\n<!-- a\nrobot -->\n<a>\n\n  <b c='1'/> text\n</a>"

    written = write_xml(read_xml(text, "robot.xml"))

    assert written.text == '<a>\n<b c="1"/>\n</a>'
    assert [written.original_line(line) for line in (1, 2, 3)] == ["4", "6", "4"]
    assert written.original_line(4) is None


def test_names_stay_text() -> None:
    name = 'a" b="$(rm -rf /)" <&>'
    element = read_xml(b'<a name="a&quot; b=&quot;$(rm -rf /)&quot; &lt;&amp;&gt;"/>', "robot.xml")

    assert element.attributes == {"name": name}
    assert read_xml(write_xml(element).text.encode(), "again").attributes == {"name": name}
