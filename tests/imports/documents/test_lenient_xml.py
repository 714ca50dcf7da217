"""XML that MuJoCo reads and a strict parser refuses: its form, and its encoding."""

import re

import mujoco
import pytest

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.xml import read_xml
from tests.imports.robots import bug, dog, read

TEXT = """<mujoco>
<worldbody>
<body name="a"><freejoint/><geom name="g" size="1"/></body>
</worldbody>
</mujoco>"""

REPAIRED = {
    "dashes in a comment": (TEXT.replace("<worldbody>", "<worldbody><!-- ---- legs ---- -->"), "2"),
    "a comment that ends with three dashes": (TEXT.replace("<body", "<!-- x ---><body"), "3"),
    "a blank line first": ('\n\n<?xml version="1.0"?>\n' + TEXT, "3"),
    "two declarations": ('<?xml version="1.0"?>\n<?xml version="1.0"?>\n' + TEXT, "2"),
    "no blank between attributes": (TEXT.replace('"g" size', '"g"size'), "3"),
    "a lone ampersand": (TEXT.replace('"g"', '"g & h"'), "3"),
    "an entity of HTML": (TEXT.replace('"g"', '"g&nbsp;h"'), "3"),
    "an angle bracket in a value": (TEXT.replace('"g"', '"g < h"'), "3"),
    "a control character": (TEXT.replace('"g"', '"g\x02"'), "3"),
    "a blank in a tag": (TEXT.replace("<worldbody>", "< worldbody>"), "2"),
    "a second root": (TEXT + "\n<mujoco/>", "5"),
    "text between elements": (TEXT.replace("<worldbody>", "<worldbody> legs & feet"), "2"),
}


@pytest.mark.parametrize("kind", REPAIRED)
def test_what_mujoco_reads_is_read_and_told(kind: str) -> None:
    text, line = REPAIRED[kind]
    repairs: list[str] = []

    root = read_xml(text.encode(), "robot.xml", repairs=repairs)

    assert [body.attributes["name"] for body in root.all("body")] == ["a"]
    assert next(root.all("body")).line == text[: text.index("<body")].count("\n") + 1
    assert len(repairs) == 1
    assert f"(line {line})" in repairs[0]
    assert mujoco.MjModel.from_xml_string(text).nbody == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (TEXT.replace("</mujoco>", ""), "line 1: <mujoco> is not closed; the file may be cut"),
        (TEXT.replace("</worldbody>", "</Worldbody>"), "line 4: </Worldbody> stands where <worldb"),
        (TEXT.replace('"1"', "1"), "line 3: the value of size of <geom> needs quotes"),
        (TEXT.replace('size="1"', 'size="1" size="2"'), "line 3: <geom> has size twice"),
        (TEXT.replace("<body", "<!-- <body"), "line 3: the comment that begins here does not end"),
        (TEXT.replace('size="1"', 'size="1'), "line 3: in <geom> 'size=\"1/></body>'"),
        ("legs\n" + TEXT, "line 1: there is text before the first element"),
        (TEXT.replace("<freejoint/>", "<>"), "line 3: after `<` a name is missing"),
        ("</mujoco>", "</mujoco> closes nothing"),
        ("just text", "line 1: there is text before the first element"),
        ("\n\n<!-- a -- b --><!DOCTYPE a>" + TEXT, "line 3: a document type or an entity"),
    ],
)
def test_what_nothing_reads_is_refused_with_the_reason(text: str, said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        read_xml(text.encode(), "robot.xml")


@pytest.mark.parametrize(
    ("encoding", "declared", "name"),
    [
        ("utf-8", None, "腿"),
        ("utf-8-sig", None, "腿"),
        ("utf-16", None, "腿"),
        ("utf-16-le", None, "腿"),
        ("utf-16-be", "UTF-16", "腿"),
        ("utf-32", None, "腿"),
        ("latin-1", "ISO-8859-1", "Füße"),
        ("cp1252", "windows-1252", "Füße–"),
        ("gb2312", "GB2312", "腿"),
        ("gbk", "gb2312", "镕"),
        ("gb18030", "GB18030", "腿"),
        ("big5", "Big5", "腿"),
        ("shift_jis", "Shift_JIS", "脚"),
        ("euc_kr", "EUC-KR", "다리"),
        ("koi8-r", "KOI8-R", "нога"),
        # Programs in C# write this.
        ("utf-8", "utf-16", "腿"),
    ],
)
def test_each_encoding_is_read(encoding: str, declared: str | None, name: str) -> None:
    head = f'<?xml version="1.0" encoding="{declared}"?>\n' if declared else ""

    root = read_xml(f'{head}<a name="{name}"/>'.encode(encoding), "robot.xml")

    assert root.attributes == {"name": name}


def test_bytes_that_are_not_in_the_declared_encoding_are_told() -> None:
    repairs: list[str] = []

    root = read_xml('<a>\n<b name="Füße"/></a>'.encode("cp1252"), "robot.xml", repairs=repairs)

    assert root.children[0].attributes == {"name": "Füße"}
    assert "line 2 is not in UTF-8, and was read as Windows-1252" in repairs[0]


def test_utf_8_that_is_declared_as_something_else_is_read() -> None:
    repairs: list[str] = []

    text = '<?xml version="1.0" encoding="GB2312"?><a name="腿éÿ"/>'
    root = read_xml(text.encode(), "robot.xml", repairs=repairs)

    assert root.attributes == {"name": "腿éÿ"}
    assert "line 1 is not in GB18030, and was read as UTF-8" in repairs[0]


@pytest.mark.parametrize("name", ["utf-99", "unicode_escape", "idna", "rot13", "zlib", "utf-7"])
def test_what_is_no_character_set_is_refused(name: str) -> None:
    text = f'<?xml version="1.0" encoding="{name}"?><a b="\\x41"/>'

    with pytest.raises(DamagedFile, match=f"the encoding {name} is unknown; save it as UTF-8"):
        read_xml(text.encode(), "robot.xml")


def test_robots_of_careless_editors_are_read() -> None:
    text = dog().replace("<worldbody>", "<worldbody><!-- ---- legs ---- -->")
    careless = f"\n{text}".replace('name="box" type', 'name="box"type')

    robot = read(careless)

    assert robot.model == read(dog()).model
    assert any("`--` is in a comment (line 4)" in repair for repair in robot.repairs)
    chinese = bug().replace("tibia_lf", "胫节").replace("1.0", '1.0" encoding="GB2312')
    assert "胫节" in [leg.foot for leg in read(chinese.encode("gb2312")).legs]
