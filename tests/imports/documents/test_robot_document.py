"""Includes of MJCF, and which of several documents is the robot."""

import re

import pytest

from hexapods.domain.errors import DamagedFile, InvalidInput
from hexapods.imports.choices import Choices
from tests.imports.robots import HOME, bug, dog, inspect, read, zipped
from tests.imports.robots_in_parts import in_parts
from tests.imports.test_mjcf import mentions

DOG = dog(keyframes={"home": HOME})
_, BODIES, SECTIONS = in_parts().values()


def including(*files: str) -> str:
    includes = "".join(f'<include file="{file}"/>' for file in files)
    return f"<mujoco>{includes}</mujoco>"


def test_a_robot_in_several_files_is_one_robot() -> None:
    robot = read(zipped(in_parts()), "dog.zip")

    assert robot.model == read(DOG).model
    assert robot.file == "dog/scene.xml"


def test_an_include_stands_within_an_element_and_within_an_included_file() -> None:
    leg = DOG.index('<body name="RR_hip"')
    end = DOG.rindex("</body>", 0, DOG.index("</worldbody>"))
    files = {
        "main.xml": f'{DOG[:leg]}<include file="leg.xml"/>{DOG[end:]}',
        "leg.xml": '<mujocoinclude><include file="inner/rr.xml"/></mujocoinclude>',
        "inner/rr.xml": f"<x>{DOG[leg:end]}</x>",
    }

    assert read(zipped(files), "dog.zip").model == read(DOG).model


def test_a_nested_include_is_beside_the_main_document_or_else_beside_the_including_one() -> None:
    # MuJoCo looks beside the main document first.
    files = {
        "main.xml": including("parts/bodies.xml", "parts/all.xml"),
        "parts/bodies.xml": BODIES,
        "parts/all.xml": including("sections.xml"),
        "parts/sections.xml": "<mujoco/>",
        "sections.xml": SECTIONS,
    }
    assert read(zipped(files), "dog.zip").model == read(DOG).model

    files["parts/sections.xml"] = files.pop("sections.xml")
    assert read(zipped(files), "dog.zip").model == read(DOG).model


def test_messages_name_the_included_file() -> None:
    files = {"main.xml": including("bodies.xml"), "bodies.xml": DOG.replace("0.3", "nan", 1)}

    with pytest.raises(InvalidInput, match=r"in line \d+ of bodies\.xml: .* must be finite"):
        read(zipped(files), "dog.zip", Choices(file="main.xml"))


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"a.xml": including("a.xml")}, "a.xml is included already"),
        ({"a.xml": including("b.xml"), "b.xml": including("a.xml")}, "is included already"),
        ({"a.xml": including("b.xml", "b.xml"), "b.xml": BODIES}, "MuJoCo allows it once"),
        ({"a.xml": including("c.xml"), "b.xml": "<a/>"}, "c.xml is not in the zip; add it"),
        (
            {"a.xml": including("/etc/passwd"), "b.xml": "<a/>"},
            "<include> in line 1: passwd is not in the zip",
        ),
        ({"a.xml": including("b.xml"), "b.xml": "<mujoco>"}, "b.xml is no whole XML document"),
        (
            {
                "a.xml": including(*(f"{n}.xml" for n in range(101))),
                **{f"{n}.xml": "<mujoco/>" for n in range(101)},
            },
            "it includes more than 100 files",
        ),
        (
            {
                "a.xml": including("b.xml", "c.xml"),
                "b.xml": f"<a>{'<b/>' * 60_000}</a>",
                "c.xml": f"<a>{'<b/>' * 60_000}</a>",
            },
            "with what it includes it has more than 100,000 elements",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_includes_that_lead_nowhere_are_refused(files: dict[str, str], said: str) -> None:
    with pytest.raises(DamagedFile, match=re.escape(said)):
        read(zipped(files), "dog.zip", Choices(file="a.xml"))


def test_a_lone_document_with_an_include_says_how_to_make_one_document() -> None:
    with pytest.raises(
        DamagedFile, match=r"it includes legs\.xml, which is another file.*from_file"
    ):
        read(including("../legs.xml"), "robot.xml")


def test_of_as_many_joints_the_mjcf_is_taken_and_the_whole_one() -> None:
    urdf = bug({"FL": (0.2, 0.1), "FR": (0.2, -0.1), "RL": (-0.2, 0.1), "RR": (-0.2, -0.1)})
    files = {"a.urdf": urdf, "longer/dog.xml": DOG, "scene.xml": including("longer/dog.xml")}

    reading = inspect(zipped(files), "robot.zip")

    robot = reading.valid_robot()
    assert robot.file == "longer/dog.xml"
    assert reading.documents == ("longer/dog.xml", "scene.xml", "a.urdf")
    guess = next(note for note in robot.notes if note.topic == "file")
    assert guess.text == "of the documents in the zip the robot is dog.xml, not: scene.xml, a.urdf"
    assert guess.offer == Choices(file="scene.xml")
    files["longer/dog.xml"] = BODIES
    files["scene.xml"] = including("longer/dog.xml", "more.xml")
    files["more.xml"] = SECTIONS
    assert read(zipped(files), "robot.zip").file == "scene.xml"


def test_fixed_joints_do_not_count() -> None:
    fixed = "".join(
        f'<link name="f{n}"/><joint name="f{n}" type="fixed"><parent link="base_link"/>'
        f'<child link="f{n}"/></joint>'
        for n in range(30)
    )
    files = {"a.urdf": bug({leg: (0.1, y) for leg, y in (("l", 0.1), ("r", -0.1))}, more=fixed)}

    assert read(zipped({**files, "bug.urdf": bug()}), "robot.zip").file == "bug.urdf"


def test_names_are_the_last_parts_of_paths_and_no_persons() -> None:
    for named, name in (
        ("/home/ada/robots/Rex", "Rex"),
        (r"C:\Users\ada\Rex", "Rex"),
        ("/home/ada", "file"),
        (r"C:\Users\ada", "file"),
        ("Rex", "Rex"),
    ):
        text = DOG.replace('model="dog"', f'model="{named}"')
        assert read(text, "/home/ada/file.xml").name == name


def test_a_folder_with_a_small_robot_and_one_that_cannot_be_read_tells_of_that() -> None:
    files = {
        "gripper.urdf": bug({"lf": (0.1, 0.1)}),
        "hexapod.xacro": '<robot><xacro:leg side="left"/></robot>',
    }

    with pytest.raises(DamagedFile, match="there is no macro 'leg'"):
        read(zipped(files), "robot.zip")
    assert mentions(read(zipped({**files, "bug.urdf": bug()}), "robot.zip").guesses, "gripper.urdf")


def test_of_documents_of_which_the_one_with_the_bodies_is_damaged_that_is_told() -> None:
    files = {"dog/bodies.xml": BODIES[:-20], "dog/sections.xml": SECTIONS}

    with pytest.raises(DamagedFile, match=r"bodies\.xml is no whole XML document"):
        read(zipped(files), "dog.zip")


def test_a_lone_document_is_the_only_choice() -> None:
    assert read(dog(), "dog.xml", Choices(file="dog.xml")).name == "dog"
    with pytest.raises(InvalidInput, match=r"dog\.xml is one document, and no zip that has 'cat"):
        read(dog(), "dog.xml", Choices(file="cat.xml"))
