"""Promise 22: a hostile or damaged robot's file is refused in 5 s and 512 MB, and leaves nothing.

In full: 1,000 damaged files, each refused with a sentence or read as a valid robot, and 100 hostile
ones, of which some are meshes that are left out; and 12 programs that are killed (SIGKILL) while
they read, at another moment each. The gate's shorter form damages 20, and kills two. Limits of time
and memory are those of the process that reads; only `make soak` measures the time, since others may
keep a busy machine from its work.
"""

import io
import os
import re
import stat
import struct
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import psutil
import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.imports.child import read_robot_file
from hexapods.imports.imported import ImportedRobot
from tests.imports.damage import damaged
from tests.imports.meshes.gltf_files import document, glb
from tests.imports.robots import HOME, box_triangles, bug, dog, stl, zipped
from tests.promises.length import at_length

DAMAGED = at_length(20, 1000)
KILLED = at_length(2, 12)
NOTHING: Mapping[str, Any] = MappingProxyType({})
USUAL_S, LONGEST_S = 5.0, at_length(120.0, 40.0)
"""Most of them, and any one: on a busy machine a process gets its 5 s of the processor later."""
SURPRISED = "cannot be understood"
"""What is said of an error that nobody thought of."""


@pytest.fixture(autouse=True)
def leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Check that no file, no process and no open file is left."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(InvalidInput):  # starts the fork server, which stays
        read_robot_file(b"")
    files = psutil.Process().num_fds()
    yield tmp_path
    assert list(tmp_path.iterdir()) == []
    assert psutil.Process().num_fds() <= files
    running = psutil.Process().children(recursive=True)
    assert [process.name() for process in running if process.name() == "robot import"] == []


def outcome(data: bytes, name: str = "robot.xml") -> ImportedRobot | str:
    """Return the robot, or the sentence with which it is refused, after a check of it."""
    began_s = time.monotonic()
    try:
        result: ImportedRobot | str = read_robot_file(data, name)
    except InvalidInput as error:
        result = str(error)
        assert 10 < len(result) <= 1000
        assert "\n" not in result
        assert SURPRISED not in result
    assert time.monotonic() - began_s < LONGEST_S
    return result


@pytest.mark.timeout(at_length(300, 3600))
def test_damaged_files_are_refused_or_read_as_valid_robots() -> None:
    began_s = time.monotonic()
    outcomes = [outcome(data) for _, data in damaged(DAMAGED, np.random.default_rng(22))]

    assert time.monotonic() - began_s < DAMAGED * USUAL_S
    refused = [result for result in outcomes if isinstance(result, str)]
    # Some damage changes nothing that matters, and damaged meshes are left out.
    assert DAMAGED // 4 < len(refused) < DAMAGED


def laughs() -> str:
    entities = "".join(
        f'<!ENTITY l{n} "{f"&l{n - 1};" * 10}">' if n else '<!ENTITY l0 "ha">' for n in range(12)
    )
    return f'<!DOCTYPE mujoco [{entities}]><mujoco model="&l11;"/>'


def with_section(section: str) -> bytes:
    return dog(sections=section).encode()


def nested_replicates(depth: int) -> bytes:
    inner = '<geom size="0.1"/>'
    for _ in range(depth):
        inner = f'<replicate count="1000" offset="1 0 0">{inner}</replicate>'
    return with_section(f"<worldbody>{inner}</worldbody>")


def bomb() -> bytes:
    """Return a zip that unpacks to 320 MB."""
    buffer = io.BytesIO()
    with (
        zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive,
        archive.open("robot.xml", "w") as member,
    ):
        for _ in range(40):
            member.write(bytes(8_000_000))
    return buffer.getvalue()


def small_claim() -> bytes:
    """Return a bomb whose directory says that it is small."""
    data = bytearray(bomb())
    at = data.index(b"PK\1\2")
    data[at + 24 : at + 28] = struct.pack("<I", 100)
    return bytes(data)


def nested_zip() -> bytes:
    return zipped({"inner.zip": zipped({"robot.xml": dog()})})


def link(mode: int) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        info = zipfile.ZipInfo("robot.xml")
        info.external_attr = mode << 16
        archive.writestr(info, "/etc/passwd")
    return buffer.getvalue()


def with_mesh(content: bytes, ending: str = "stl", attributes: str = "") -> bytes:
    asset = f'<asset><mesh name="m" file="m.{ending}" {attributes}/></asset>'
    drawn = '<geom type="mesh" mesh="m"/>'
    return zipped({"dog.xml": dog(sections=asset, on_torso=drawn), f"m.{ending}": content})


def obj(lines: str) -> bytes:
    return with_mesh(lines.encode(), "obj")


def with_gltf(
    accessor: Mapping[str, Any] = NOTHING,
    view: Mapping[str, Any] = NOTHING,
    buffer: Mapping[str, Any] = NOTHING,
    **parts: Any,
) -> bytes:
    """Return a robot with a GLB of which some numbers are other ones."""
    text, content = document(box_triangles((0.1, 0.1, 0.1)))
    text["accessors"][0] |= accessor
    text["bufferViews"][0] |= view
    text["buffers"][0] |= buffer
    return with_mesh(glb(({**text, **parts}, content)), "glb")


def not_finite() -> bytes:
    triangles = box_triangles((1, 1, 1))
    triangles[0, 0, 0] = np.nan
    return with_mesh(stl(triangles))


def false_count(count: int) -> bytes:
    content = bytearray(stl(box_triangles((1, 1, 1))))
    content[80:84] = struct.pack("<I", count)
    return with_mesh(bytes(content))


def lies_about_members() -> bytes:
    data = bytearray(zipped({"robot.xml": dog()}))
    at = data.rindex(b"PK\5\6")
    data[at + 8 : at + 12] = struct.pack("<2H", 65_535, 65_535)
    return bytes(data)


def overlapping() -> bytes:
    """Return a zip whose directory lists one member under many names."""
    data = bytearray(zipped({"robot.xml": "<mujoco/>" * 1000}))
    start, end = data.index(b"PK\1\2"), data.rindex(b"PK\5\6")
    entry = bytes(data[start:end])
    entries = b"".join(
        entry.replace(b"robot.xml", b"rob%02d.xml" % number) for number in range(100)
    )
    tail = bytearray(data[end:])
    struct.pack_into("<2HI", tail, 8, 100, 100, len(entries))
    return bytes(data[:start]) + entries + bytes(tail)


def xacro(text: str) -> bytes:
    """Return a zip with a xacro, and with YAML that is no better."""
    laughs = "a0: &a0 [x]\n" + "".join(
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 12)
    )
    return zipped(
        {
            "robot.xacro": f"<robot>{text}</robot>",
            "laughs.yaml": laughs,
            "merged.yaml": "a: &a {x: 1}\nb:\n  <<: [*a, *a]\n",
            "deep.yaml": "[" * 100_000,
            "large.yaml": "[" + "0, " * 80_000 + "0]",
            "object.yaml": "a: !!python/object/apply:os.system ['true']\n",
        }
    )


def doubled(times: int, wraps: str) -> str:
    """Return properties that double each other, and a link with the last one."""
    properties = "".join(
        f'<xacro:property name="p{n}" value="{wraps.format(f"p{n - 1}")}"/>'
        for n in range(1, times)
    )
    first = '<xacro:property name="p0" value="ha"/>'
    return f'{first}{properties}<link name="${{p{times - 1}}}"/>'


def macros(depth: int, calls: int) -> str:
    """Return macros each of which calls the next several times."""
    return (
        "".join(
            f'<xacro:macro name="m{n}" params="">{f"<xacro:m{n + 1}/>" * calls}</xacro:macro>'
            for n in range(depth)
        )
        + f'<xacro:macro name="m{depth}" params=""><link name="l"/></xacro:macro><xacro:m0/>'
    )


HOSTILE_XACRO = {
    "an undefined property": '<link name="${base}"/>',
    "a macro that calls itself": (
        '<xacro:macro name="m" params=""><xacro:m/></xacro:macro><xacro:m/>'
    ),
    "a block that inserts itself": (
        '<xacro:property name="b"><xacro:insert_block name="b"/></xacro:property>'
        '<xacro:insert_block name="b"/>'
    ),
    "a billion macros": macros(9, 10),
    "a billion empty macros": macros(30, 2).replace('<link name="l"/>', ""),
    "a billion laughs": doubled(60, "${{{0} + {0}}}"),
    "a billion lists": doubled(60, "${{[{0}, {0}]}}"),
    "properties in a circle": (
        '<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/>'
        '<link name="${a}"/>'
    ),
    "a long chain of properties": doubled(3000, "${{{0}}}"),
    "a huge text": "<link name=\"${'x' * 10**9}\"/>",
    "a huge number": '<link name="${2**10**8}"/>',
    "a huge format": "<link name=\"${'%0999999999d' % 1}\"/>",
    "a huge range": '<link name="${len(range(10**15))}"/>',
    "a huge rounding": '<link name="${round(1, -10**9)}"/>',
    "an attribute of an object": "<link name=\"${''.__class__.__mro__}\"/>",
    "an import": "<link name=\"${__import__('os').getcwd()}\"/>",
    "a file": "<link name=\"${open('/etc/passwd').read()}\"/>",
    "an evaluation": "<link name=\"$(eval __import__('os'))\"/>",
    "an evaluation of an attribute": '<link name="$(eval 1 .__class__)"/>',
    "the environment": '<link name="$(env HOME)"/>',
    "a file above": '<xacro:include filename="../../../etc/passwd"/>',
    "a file of the system": '<xacro:include filename="$(find x)/../../etc/passwd"/>',
    "an include of itself": '<xacro:include filename="robot.xacro"/>',
    "YAML above": "<link name=\"${xacro.load_yaml('/etc/passwd')}\"/>",
    **{
        f"YAML that is {name}": f"<link name=\"${{xacro.load_yaml('{name}.yaml')}}\"/>"
        for name in ("laughs", "merged", "deep", "large", "object")
    },
    "a deep expression": f'<link v="${{{"(" * 900}1{")" * 900}}}"/>',
    "many expressions": "".join(f'<link v="${{{"+".join("1" * 200)}}}"/>' for _ in range(2000)),
    "params that are none": f'<xacro:macro name="m" params="{":=" * 9000}"/>',
    "an argument of its own": '<xacro:arg name="a" default="$(arg a)"/>',
    "an element with a name that is none": '<xacro:element xacro:name="a b=&quot;"/>',
}
HOSTILE: dict[str, Callable[[], bytes]] = {
    "nothing": lambda: b"",
    "zeros": lambda: bytes(1_000_000),
    "no document": lambda: b"\x7fELF" + os.urandom(5000),
    "a web page": lambda: b"<html><body>robot</body></html>",
    "a billion laughs": lambda: laughs().encode(),
    "an external entity": lambda: (
        b'<!DOCTYPE mujoco [<!ENTITY f SYSTEM "file:///etc/passwd">]><mujoco model="&f;"/>'
    ),
    "an external document type": lambda: b'<!DOCTYPE r SYSTEM "http://127.0.0.1:9/r"><robot/>',
    "a million elements": lambda: b"<mujoco>" + b"<geom/>" * 1_000_000 + b"</mujoco>",
    "a deep document": lambda: b"<mujoco>" * 500_000,
    "deep bodies": lambda: with_section(
        "<worldbody>" + "<body>" * 250 + "</body>" * 250 + "</worldbody>"
    ),
    "a long attribute": lambda: b'<mujoco model="' + b"x" * 3_000_000 + b'"/>',
    "many attributes": lambda: (
        b"<mujoco " + b" ".join(b'a%d="1"' % n for n in range(200_000)) + b"/>"
    ),
    "an include": lambda: with_section('<include file="/etc/passwd"/>'),
    "an include of itself": lambda: zipped(
        {"robot.xml": '<mujoco><include file="robot.xml"/></mujoco>'}
    ),
    "an attached model": lambda: with_section('<asset><model file="/etc/passwd"/></asset>'),
    "a billion geoms": lambda: nested_replicates(3),
    "10^30 geoms": lambda: nested_replicates(10),
    "a composite": lambda: with_section(
        '<worldbody><body><composite type="cloth" count="9999 9999 1"/></body></worldbody>'
    ),
    "a flexcomp": lambda: with_section(
        '<worldbody><flexcomp type="grid" count="999 999 999" name="f"/></worldbody>'
    ),
    "a plugin": lambda: with_section('<extension><plugin plugin="x"/></extension>'),
    "3,000 bodies": lambda: with_section("<worldbody>" + "<body/>" * 3000 + "</worldbody>"),
    "10,000 geoms": lambda: with_section(
        "<worldbody><body>" + '<geom size="1"/>' * 10_000 + "</body></worldbody>"
    ),
    "a huge sphere of a mesh": lambda: with_section(
        '<asset><mesh name="m" builtin="sphere" params="30"/></asset>'
    ),
    "a mesh of very many numbers": lambda: with_section(
        '<asset><mesh name="m" vertex="' + "0 " * 2_000_000 + '"/></asset>'
    ),
    "numbers that are none": lambda: dog().replace("0.3", "nan").encode(),
    "infinite numbers": lambda: dog().replace("0.3", "inf").encode(),
    "huge numbers": lambda: dog().replace("0.3", "1e308").encode(),
    "a leg of a kilometre": lambda: dog().replace('0 0 -0.2"', '0 0 -1000"').encode(),
    "a leg of an atom": lambda: re.sub(
        r"(0\.2|0\.16|0\.02|0\.05)\b(?= 0|\")", "1e-10", dog()
    ).encode(),
    "a joint without an axis": lambda: dog().replace('axis="1 0 0"', 'axis="0 0 0"').encode(),
    "13 legs": lambda: dog(
        {f"L{n}": (0.3 * np.cos(n / 2), 0.3 * np.sin(n / 2)) for n in range(13)}
    ).encode(),
    "a body without legs": lambda: b"<mujoco><worldbody><body/></worldbody></mujoco>",
    "links in a circle": lambda: (
        b'<robot><link name="r"/><link name="a"/><link name="b"/>'
        b'<joint name="1" type="fixed"><parent link="a"/><child link="b"/></joint>'
        b'<joint name="2" type="fixed"><parent link="b"/><child link="a"/></joint></robot>'
    ),
    "an include in a circle": lambda: zipped(
        {
            f"{name}.xml": f'<mujoco><include file="{other}.xml"/></mujoco>'
            for name, other in ("ab", "ba")
        }
    ),
    "an include of a billion elements": lambda: zipped(
        {
            f"{n}.xml": f"<mujoco>{'<body/>' * 15_000}<include file='{n + 1}.xml'/></mujoco>"
            for n in range(90)
        }
    ),
    "nested comments without end": lambda: b"<mujoco>" + b"<!-- -- " * 400_000,
    "many documents of many macros": lambda: zipped(
        {
            f"{n}.xacro": f"<robot n='{n}'>{macros(9, 10)}<link name='{n}'/></robot>"
            for n in range(60)
        }
    ),
    "an attribute without end": lambda: b"<mujoco " + b"a='b'c=\"" * 400_000,
    "a page of ampersands": lambda: b"<mujoco>" + b"&" * 4_000_000,
    **{f"xacro: {name}": partial(xacro, text) for name, text in HOSTILE_XACRO.items()},
    "a bomb": bomb,
    "a bomb that claims to be small": small_claim,
    "a zip in a zip": nested_zip,
    "a link": lambda: link(stat.S_IFLNK | 0o777),
    "a device": lambda: link(stat.S_IFBLK | 0o777),
    "a member above the zip": lambda: zipped({"../robot.xml": dog()}),
    "a zip of too many members": lambda: zipped({f"{n}.stl": "" for n in range(3000)}),
    "a zip that lies about its members": lies_about_members,
    "one member under many names": overlapping,
    "a zip that is cut short": lambda: zipped({"robot.xml": dog(keyframes={"home": HOME})})[:-40],
}


DAMAGED_MESHES: dict[str, Callable[[], bytes]] = {
    "a mesh of too many triangles": lambda: false_count(2**32 - 1),
    "a mesh of other triangles": lambda: false_count(1000),
    "a mesh that is not finite": not_finite,
    "a mesh of one triangle": lambda: with_mesh(stl(box_triangles((1, 1, 1))[:1])),
    "a mesh without corners": lambda: obj("f 1 2 3\n" * 1000),
    "a mesh with corners from nowhere": lambda: obj(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999999999\nf -5 -6 -7\n"
    ),
    "a mesh that names files": lambda: obj("mtllib /etc/passwd\nv 0 0 0\n"),
    "a glTF of far more rows": lambda: with_gltf(accessor={"count": 2**31}),
    "a glTF of rows beyond its buffer": lambda: with_gltf(view={"byteOffset": 2**31}),
    "a glTF of a buffer elsewhere": lambda: with_gltf(buffer={"uri": "/etc/passwd"}),
    "a glTF of a downloaded buffer": lambda: with_gltf(buffer={"uri": "http://127.0.0.1:9/a"}),
    "a glTF of vertices that are no floats": lambda: with_gltf(accessor={"componentType": 5122}),
    "a glTF whose nodes form a circle": lambda: with_gltf(nodes=[{"children": [0, 0]}]),
    "a glTF of a million instances": lambda: with_gltf(
        nodes=[{"children": [1] * 1000}, {"children": [2] * 1000}, {"mesh": 0}]
    ),
    "a glTF of very many primitives": lambda: with_gltf(
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}] * 100_000}]
    ),
    "a glTF of deep JSON": lambda: with_mesh(b"[" * 1_000_000, "gltf"),
    "a glTF of a number of a million digits": lambda: with_mesh(
        b'{"asset": ' + b"9" * 1_000_000 + b"}", "gltf"
    ),
}
"""Files of meshes that are left out of a robot, which is read without them."""


def shape(file: str) -> str:
    return f'<visual><geometry><mesh filename="{file}"/></geometry></visual>'


def test_at_least_a_hundred_hostile_files_are_tried() -> None:
    assert len(HOSTILE) + len(DAMAGED_MESHES) >= 100


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_are_refused(name: str) -> None:
    result = outcome(HOSTILE[name](), "robot.zip")

    assert isinstance(result, str), name
    assert "root:" not in result


@pytest.mark.parametrize("name", DAMAGED_MESHES)
def test_damaged_meshes_are_left_out(name: str) -> None:
    result = outcome(DAMAGED_MESHES[name](), "robot.zip")

    assert isinstance(result, ImportedRobot), result
    assert any("left out" in repair for repair in result.repairs)


@pytest.mark.parametrize(
    "section",
    [
        '<asset><texture name="t" builtin="flat" width="100000" height="100000"/></asset>',
        '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
        '<size memory="900G" nuserdata="1000000000"/>',
        '<sensor><user dim="1000000000"/></sensor>',
        '<visual><global offwidth="1000000000" offheight="1000000000"/></visual>',
    ],
)
def test_what_is_no_body_takes_no_memory(section: str) -> None:
    result = outcome(with_section(section))

    assert isinstance(result, ImportedRobot)


@pytest.mark.parametrize(
    "path",
    ["/etc/passwd", "../../../etc/passwd", "http://127.0.0.1:9/passwd", "file:///etc/passwd"],
)
def test_a_mesh_outside_of_the_zip_is_missing(path: str) -> None:
    result = outcome(zipped({"bug.urdf": bug(torso=shape(path)), "a.stl": ""}), "robot.zip")

    assert isinstance(result, ImportedRobot)
    assert any("passwd" in repair and "missing" in repair for repair in result.repairs)


LIBRARY = ("-c", "import hexapods as hx; hx.load_robot('bug.zip')")
COMMAND = ("-m", "app.cli", "robots", "import", "bug.zip", "--data", "data")


@pytest.mark.skipif(sys.platform != "linux", reason="the name of a process is set on Linux")
@pytest.mark.timeout(at_length(300, 1800))
@pytest.mark.parametrize("number", range(KILLED))
def test_nothing_is_left_when_the_program_that_reads_is_killed(
    number: int, leaves_nothing: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("program")
    mesh = stl(box_triangles((1, 1, 1), cells=200))
    (folder / "bug.zip").write_bytes(zipped({"bug.urdf": bug(torso=shape("a.stl")), "a.stl": mesh}))
    environment = {"TMPDIR": str(leaves_nothing), "PYTHONPATH": str(Path(__file__).parents[2])}
    program = psutil.Popen(
        [sys.executable, *(LIBRARY, COMMAND)[number % 2]],
        cwd=folder,
        env={**os.environ, **environment},
        stderr=subprocess.DEVNULL,
    )
    reader = None
    while reader is None and program.poll() is None:
        below = program.children(recursive=True)
        reader = next((child for child in below if child.name() == "robot import"), None)
    assert reader is not None
    time.sleep(number / KILLED)  # no longer than it reads

    below = program.children(recursive=True)
    program.kill()

    assert program.wait() == -9
    _, running = psutil.wait_procs(below, timeout=LONGEST_S)
    assert not running
