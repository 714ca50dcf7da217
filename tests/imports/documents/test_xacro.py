"""Robots in xacro: what is expanded as ROS does, and what is not there is told."""

import re

import pytest

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.imports.choices import Choices
from hexapods.imports.documents.expressions import Budget
from hexapods.imports.documents.upload import Upload
from hexapods.imports.documents.xacro import XacroExpansion
from hexapods.imports.documents.xml import Element, read_xml
from hexapods.imports.imported import RobotReading
from tests.imports.robots import box_triangles, bug, dog, inspect, read, stl, zipped
from tests.imports.robots_in_parts import in_xacro
from tests.imports.test_mjcf import mentions

FILES = in_xacro()
MAIN = FILES["repo/urdf/bug.urdf.xacro"]


def expanded(text: str, **files: str) -> Element:
    """Return a document without xacro, from a zip with other files by name without `.xacro`."""
    members = {"main.xacro": text, **{f"{name}.xacro": file for name, file in files.items()}}
    upload = Upload(zipped(members), "robot.zip")

    def parse(path: str) -> Element:
        return read_xml(upload.read(path, 1_000_000), path)

    return XacroExpansion("main.xacro", upload, parse, {}, Budget()).expanded().root


def values(text: str, **files: str) -> list[str]:
    """Return the attributes `v` of the elements `<a>` in an expanded document."""
    root = expanded(f"<robot>{text}</robot>", **files)
    return [element.attributes["v"] for element in root.all("a")]


def inspected(choices: Choices | None = None) -> RobotReading:
    return inspect(zipped(FILES), "repo.zip", choices or Choices())


def test_a_robot_in_xacro_is_the_robot_in_urdf() -> None:
    reading = inspected()

    robot = reading.valid_robot()
    assert robot.model == read(bug()).model
    assert reading.arguments == {"effort": "2.5", "sim": "false"}
    assert robot.file == "repo/urdf/bug.urdf.xacro"
    assert mentions(robot.repairs, "left out what is not in the zip, and what needs it: camera.xac")
    assert mentions(robot.repairs, "xacro:camera")


def test_arguments_are_chosen() -> None:
    reading = inspected(Choices(arguments={"effort": "1.5"}))

    assert reading.valid_robot().model.joints_of(1)[0].servo_torque_nm == 1.5
    assert reading.arguments["effort"] == "1.5"
    with pytest.raises(InvalidInput, match="has no argument 'power'; it has: effort, sim"):
        inspected(Choices(arguments={"power": "1"}))


def test_a_folder_of_the_documents_alone_is_found_by_the_ends_of_paths() -> None:
    files = {path.removeprefix("repo/"): text for path, text in FILES.items()}
    del files["package.xml"]

    assert read(zipped(files), "repo.zip").model == read(bug()).model


def test_a_robot_of_which_a_part_is_missing_is_refused_with_its_name() -> None:
    files = {path: text for path, text in FILES.items() if "leg.xacro" not in path}
    with pytest.raises(InvalidInput, match=r"missing from the zip: leg\.xacro.*xacro:leg"):
        read(zipped(files), "repo.zip")
    with pytest.raises(DamagedFile, match=r"includes leg\.xacro, which is another file: give both"):
        read(MAIN.replace("${xacro.load_yaml('$(find bug)/config/legs.yaml')}", ""), "bug.xacro")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # Numbers keep their type, texts are joined.
        ('<xacro:property name="n" value="2"/><a v="${n * 3}"/><a v="${n}.${n}"/>', ["6", "2.2"]),
        # A property is evaluated when it is needed, and keeps its value.
        (
            '<xacro:property name="b" value="${c + 1}"/><xacro:property name="c" value="1"/>'
            '<a v="${b}"/><xacro:property name="c" value="5"/><a v="${b}"/>',
            ["2", "2"],
        ),
        ('<xacro:property name="b" value="1" lazy_eval="false"/><a v="${b}"/>', ["1"]),
        ('<xacro:property name="b" default="1"/><a v="${b}"/>', ["1"]),
        (
            '<xacro:property name="b" value="3"/><xacro:property name="b" default="1"/>'
            '<a v="${b}"/>',
            ["3"],
        ),
        # Conditions.
        ('<xacro:if value="${1 < 2}"><a v="y"/></xacro:if>', ["y"]),
        ('<xacro:unless value="true"><a v="y"/></xacro:unless><a v="z"/>', ["z"]),
        ("<xacro:if value=\"${'a' == 'b' or not True}\"><a v='y'/></xacro:if>", []),
        # Escapes.
        ('<a v="$${x} $$(y) $"/>', ["${x} $(y) $"]),
        # Macros: defaults, forwarded properties, blocks, calls by name, local properties.
        (
            '<xacro:macro name="m" params="p q:=2 r:=^|7"><a v="${p}${q}${r}"/></xacro:macro>'
            '<xacro:m p="1"/><xacro:property name="r" value="9"/><xacro:m p="1" q="0"/>'
            '<xacro:call macro="${\'m\'}" p="x"/>',
            ["127", "109", "x29"],
        ),
        (
            "<xacro:macro name=\"m\" params=\"p:='a b' q:=${1 + 2} r:=''\"><a v='${p}${q}${r}'/>"
            "</xacro:macro><xacro:m/>",
            ["a b3"],
        ),
        (
            '<xacro:macro name="m" params="*one **two"><xacro:insert_block name="two"/>'
            '<xacro:insert_block name="one"/></xacro:macro>'
            '<xacro:m><a v="1"/><x><a v="2"/><a v="3"/></x></xacro:m>',
            ["2", "3", "1"],
        ),
        (
            '<xacro:property name="block"><a v="${k}"/></xacro:property>'
            '<xacro:property name="k" value="4"/><xacro:insert_block name="block"/>',
            ["4"],
        ),
        (
            '<xacro:macro name="m" params=""><xacro:property name="k" value="1"/>'
            '<xacro:property name="g" value="${k + 1}" scope="global"/>'
            '<xacro:property name="p" value="${k + 2}" scope="parent"/></xacro:macro>'
            '<xacro:property name="k" value="0"/><xacro:m/><a v="${k}${g}${p}"/>',
            ["023"],
        ),
        # Elements and attributes with computed names.
        ('<xacro:element xacro:name="${\'a\'}" v="1"/>', ["1"]),
        ('<b><xacro:attribute name="v" value="1"/></b><a v="2"/>', ["2"]),
        # Documents of before 2014, without prefixes.
        (
            '<property name="k" value="4"/><macro name="m" params="p"><a v="${p * k}"/></macro>'
            '<m p="2"/>',
            ["8"],
        ),
        # Commands.
        (
            '<xacro:arg name="s" default="x"/><a v="$(arg s)_$(optenv NOTHING some text)"/>',
            ["x_some text"],
        ),
        ('<a v="$(find pkg)/a.stl"/><a v="$(dirname)"/>', ["/pkg/a.stl", "/"]),
        ('<xacro:arg name="s" default="x"/><a v="$(eval s + \'y\')"/>', ["xy"]),
        (
            "<xacro:property name='d' value='${dict(a=1, b=[2, 3])}'/><a v='${d.b[1] + d.a}'/>",
            ["4"],
        ),
    ],
)
def test_it_expands_as_in_ros(text: str, expected: list[str]) -> None:
    assert values(text) == expected


def test_an_include_with_a_namespace_is_behind_a_dot() -> None:
    inner = (
        '<robot><xacro:property name="k" value="3"/>'
        '<xacro:macro name="m" params=""><a v="${k}"/></xacro:macro></robot>'
    )

    text = '<xacro:include filename="inner.xacro" ns="n"/><a v="${n.k + 1}"/><xacro:n.m/>'

    assert values(text, inner=inner) == ["4", "3"]


def test_names_that_look_like_commands_stay_names() -> None:
    for name in ("$(rm -rf ~)", "$5", "a$b"):
        urdf = bug().replace('name="bug"', f'name="{name}"')
        assert read(urdf, "bug.urdf").name == name
    assert read(dog().replace('model="dog"', 'model="${dog}"')).name == "${dog}"


def test_what_is_no_body_is_not_evaluated() -> None:
    root = expanded('<robot><gazebo><a v="${nothing}"/></gazebo><transmission v="${x}"/></robot>')

    assert root.children == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('<a v="${b}"/>', "<a> in line 1: 'b' is not defined, in 'b'"),
        ('<xacro:leg side="left"/>', "there is no macro leg"),
        ('<xacro:macro name="m" params="p"/><xacro:m/>', "the macro m needs p"),
        ('<xacro:macro name="m" params="*p"/><xacro:m/>', "the macro m needs *p"),
        ('<xacro:macro name="m" params="p"/><xacro:m q="1"/>', "no parameter q; it has: p"),
        ('<xacro:insert_block name="b"/>', "there is no block b"),
        ('<xacro:if value="perhaps"/>', "a condition must be true or false, not perhaps"),
        ('<a v="${1 +"/>', "is not closed"),
        ('<a v="${1 +}"/>', "it is no expression"),
        ('<a v="$(arg side)"/>', "the argument side has no default: choose its value"),
        ('<a v="$(anon x)"/>', "$(anon x) is not supported: expand it yourself"),
        ('<xacro:property name="a b" value="1"/>', "'a b' is no name of a property"),
        ('<xacro:element xacro:name="a b"/>', "'a b' is no name of an element"),
        ('<xacro:property value="1"/>', "it needs the attribute name"),
        ("<a v=\"${xacro.load_yaml('no.yaml')}\"/>", "no.yaml is missing from the upload"),
        ('<a v="${(lambda: 1)()}"/>', "a function of its own is not supported"),
    ],
)
def test_what_cannot_be_expanded_is_named(text: str, said: str) -> None:
    with pytest.raises(DamagedFile) as caught:
        values(text)
    assert said.replace("'", "") in str(caught.value).replace("'", "")
    assert re.search(r"<.+> .*in line 1", str(caught.value))


def test_messages_name_the_file_of_the_macro() -> None:
    inner = '<robot>\n<xacro:macro name="m" params="">\n<a v="${b}"/></xacro:macro></robot>'

    with pytest.raises(DamagedFile, match=r"<a> in line 3 of inner\.xacro: 'b' is not defined"):
        values('<xacro:include filename="inner.xacro"/><xacro:m/>', inner=inner)


def test_a_loop_by_a_macro_that_calls_itself_is_expanded() -> None:
    text = (
        '<xacro:macro name="loop" params="n"><a v="${n}"/><xacro:if value="${n > 1}">'
        '<xacro:loop n="${n - 1}"/></xacro:if></xacro:macro><xacro:loop n="50"/>'
    )

    assert values(text) == [str(n) for n in range(50, 0, -1)]


def test_a_mesh_with_an_unknown_folder_is_found_by_its_name() -> None:
    mesh = (
        '<visual><geometry><mesh filename="${ROOT}/meshes/hull.stl" scale="0.5 0.5 0.5"/>'
        "</geometry></visual>"
    )
    hull = stl(box_triangles((0.4, 0.2, 0.08)))

    robot = read(zipped({"bug.urdf": bug(torso=mesh), "hull.stl": hull}), "bug.zip")

    assert not any("missing" in repair for repair in robot.repairs)


def test_an_argument_that_is_not_declared_can_be_chosen() -> None:
    text = bug().replace('name="bug"', 'name="$(arg name)"')
    with pytest.raises(DamagedFile, match="the argument 'name' has no default"):
        read(text, "bug.urdf")

    reading = inspect(text, "bug.urdf", Choices(arguments={"name": "Rex"}))

    assert (reading.valid_robot().name, reading.arguments) == ("Rex", {"name": "Rex"})


def test_a_top_document_is_taken_and_not_its_parts() -> None:
    assert inspected().documents == ("repo/urdf/bug.urdf.xacro",)
    plain = {**FILES, "repo/bug.urdf": bug()}
    assert read(zipped(plain), "repo.zip").file == "repo/bug.urdf"
