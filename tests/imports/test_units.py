import math
import re
from dataclasses import replace

import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.imports.child import read_robot_file
from hexapods.imports.choices import Choices
from hexapods.imports.imported import ImportedRobot
from hexapods.imports.notes import Note
from tests.imports.robots import FOUR, HOME, SIX, box_triangles, bug, dog, read, stl, zipped

MESH = '<visual><origin xyz="0.01 0 0"/><geometry><mesh filename="box.stl"/></geometry></visual>'
BOX = stl(box_triangles((0.1, 0.04, 0.02)))


def turned(robot: str, quaternion: str) -> str:
    """Return the dog in a file in which another axis is up."""
    return robot.replace('pos="0 0 0.4"', f'pos="0 0 0.4" quat="{quaternion}"')


def offsets(robot: ImportedRobot) -> np.ndarray:
    """Return the place of each link in its parent, (links, 3) [m]."""
    return np.array([link.at_m for link in robot.model.links])


@pytest.mark.parametrize("text", [dog(keyframes={"home": HOME}), bug(torso=MESH, femur=MESH)])
def test_scale_multiplies_lengths_and_keeps_masses(text: str) -> None:
    files = zipped({"robot.xml": text, "box.stl": BOX})
    robot, scaled = read(files), read(files, choices=Choices(scale=0.5))

    assert offsets(scaled) == pytest.approx(0.5 * offsets(robot), abs=1e-12)
    assert scaled.body_height_m == pytest.approx(0.5 * robot.body_height_m, rel=1e-3)
    assert scaled.mass_kg == pytest.approx(robot.mass_kg, rel=1e-9)
    for link, other in zip(robot.model.links, scaled.model.links, strict=True):
        assert other.center_m == pytest.approx(0.5 * np.array(link.center_m), abs=1e-9)
        # Least inertia is added to each.
        assert other.inertia == pytest.approx(0.25 * np.array(link.inertia), abs=1e-8)
        assert [geom.kind for geom in other.geoms] == [geom.kind for geom in link.geoms]
        for geom, small in zip(link.geoms, other.geoms, strict=True):
            assert small.size_m == pytest.approx(0.5 * np.array(geom.size_m), rel=1e-6)
            assert small.at_m == pytest.approx(0.5 * np.array(geom.at_m), abs=1e-6)
        if link.mesh is not None and other.mesh is not None:
            vertices, halved = link.mesh.arrays()[0], other.mesh.arrays()[0]
            assert halved == pytest.approx(0.5 * vertices, abs=1e-6)
    for foot, small_foot in zip(robot.model.feet, scaled.model.feet, strict=True):
        assert small_foot.at_m == pytest.approx(0.5 * np.array(foot.at_m), abs=1e-4)


def test_masses_by_density_follow_the_lengths() -> None:
    dense = re.sub(r' mass="[^"]*"', ' density="1000"', dog(keyframes={"home": HOME}))
    robot, scaled = read(dense), read(dense, choices=Choices(scale=0.5))

    assert scaled.mass_kg == pytest.approx(robot.mass_kg / 8, rel=1e-6)


def test_a_mass_is_shared_by_the_links_as_before() -> None:
    robot, light = read(bug()), read(bug(), choices=Choices(mass_kg=0.33))

    assert light.mass_kg == pytest.approx(0.33)
    for link, other in zip(robot.model.links, light.model.links, strict=True):
        assert other.mass_kg == pytest.approx(0.1 * link.mass_kg)
        assert other.inertia == pytest.approx(0.1 * np.array(link.inertia))


@pytest.mark.parametrize(
    ("up", "quaternion", "forward"),
    [
        ("y", "1 -1 0 0", "x"),  # the dog's z is the file's y
        ("-y", "1 1 0 0", "x"),
        ("-z", "0 1 0 0", "x"),
        ("x", "1 0 1 0", "-z"),
        ("-x", "1 0 -1 0", "z"),
    ],
)
def test_another_axis_is_up(up: str, quaternion: str, forward: str) -> None:
    robot = read(dog())
    choices = Choices(up=up)  # type: ignore[arg-type]
    other = read(turned(dog(base=""), quaternion), choices=choices)
    free = read(turned(dog(), quaternion), choices=choices)

    assert f"forward is {forward} of the file's frame" in " ".join(other.guesses)
    for turned_robot in (other, free):
        assert [leg.foot for leg in turned_robot.legs] == [leg.foot for leg in robot.legs]
        assert turned_robot.body_height_m == pytest.approx(robot.body_height_m, abs=1e-3)
        assert offsets(turned_robot) == pytest.approx(offsets(robot), abs=1e-9)


def test_forward_is_an_axis_that_is_horizontal() -> None:
    with pytest.raises(InvalidInput, match=r"must be x, y, -x, -y or an angle .* z of the file is"):
        read(dog(), choices=Choices(forward="z"))
    with pytest.raises(InvalidInput, match="must be x, z, -x, -z or an angle"):
        read(turned(dog(), "1 -1 0 0"), choices=Choices(up="y", forward="-y"))

    sideways = read(turned(dog(), "1 -1 0 0"), choices=Choices(up="y", forward="z"))
    assert sideways.forward_deg == -90


def test_limits_are_read_in_degrees() -> None:
    in_degrees = bug(limit='<limit lower="-90" upper="60" effort="{effort}" velocity="5"/>')
    robot = read(in_degrees, choices=Choices(angle_unit="deg"))

    for joint in robot.model.joints_of(1):
        assert joint.limits_rad == pytest.approx((-np.pi / 2, np.pi / 3))


@pytest.mark.parametrize("scale", [0, -1.0, 1001.0, float("nan")])
def test_a_scale_without_sense_is_refused(scale: float) -> None:
    with pytest.raises(InvalidInput, match=r"scale: Input should be .* (0\.001|1000|number)"):
        read_robot_file(dog(FOUR).encode(), "dog.xml", Choices(scale=scale))


def test_a_scale_that_makes_no_robot_says_so() -> None:
    with pytest.raises(InvalidInput, match=r"leg 1 .* is 45 m long.*`scale` reads the lengths"):
        read(dog(), choices=Choices(scale=100))
    with pytest.raises(InvalidInput, match=r"the foot tibia_.. has a radius of 0\.0008 m"):
        read(bug(), choices=Choices(scale=0.1))


IN_DEGREES = '<limit lower="-90" upper="60" effort="{effort}" velocity="5"/>'


def about(robot: ImportedRobot, words: str) -> Note:
    """Return the only note that has some words."""
    (note,) = [note for note in robot.notes if words in note.text]
    return note


def test_limits_that_can_only_be_in_degrees_are_read_so() -> None:
    robot = read(bug(limit=IN_DEGREES))

    assert robot.model.joints_of(1)[1].limits_rad == pytest.approx((-np.pi / 2, np.pi / 3))
    note = about(robot, "limits of joints are in degrees, such as -90 to 60 of j_coxa_lf")
    assert (len(note.parts), note.offer) == (18, Choices(angle_unit="rad"))
    in_radians = read(bug(limit=IN_DEGREES), choices=Choices(angle_unit="rad"))
    assert about(in_radians, "all joints have no limits in the file").parts


@pytest.mark.parametrize(("limit", "is_asked"), [(90, True), (10, False), (1000, False)])
def test_limits_that_may_be_in_degrees_are_asked_for(limit: int, is_asked: bool) -> None:
    text = bug()
    for leg in SIX:
        text = re.sub(
            rf'(name="j_coxa_{leg}.*?lower=)"[^"]*" upper="[^"]*"',
            rf'\1"-{limit}" upper="{limit}"',
            text,
        )
    robot = read(text)

    assert robot.model.joints_of(1)[1].limits_rad == (-1.6, 1.6)
    offers = [note.offer for note in robot.notes if "are all limits in degrees" in note.text]
    assert offers == [Choices(angle_unit="deg")] * is_asked


@pytest.mark.parametrize(
    ("up", "quaternion"), [("y", "1 -1 0 0"), ("-y", "1 1 0 0"), ("-x", "1 0 -1 0")]
)
def test_the_axis_that_is_up_is_found_by_the_legs(up: str, quaternion: str) -> None:
    text = turned(dog(keyframes={"home": HOME}), quaternion)
    robot = read(text)

    assert about(robot, f"{up} of the file is up: with z up it has no legs").topic == "base"
    assert robot == replace(
        read(text, choices=Choices(up=up)),  # type: ignore[arg-type]
        notes=robot.notes,
    )


def test_legs_that_are_mounted_one_above_the_other_are_asked_for() -> None:
    ring = {f"leg{n}": (0.1 * math.cos(t), 0.1 * math.sin(t)) for n, t in enumerate(np.arange(6))}
    text = bug(ring).replace(
        '<link name="base_link">',
        '<link name="root"/><joint name="turn" '
        'type="fixed"><parent link="root"/><child link="base_link"/><origin rpy="-1.5708 0 0"/>'
        '</joint><link name="base_link">',
    )
    with pytest.raises(InvalidInput, match="or choose the axis that is up, such as y"):
        read(text)

    assert len(read(text, choices=Choices(up="y")).legs) == 6


def test_a_two_legged_robot_is_not_asked_whether_it_lies() -> None:
    with pytest.raises(InvalidInput) as refusal:
        read(dog({"FL": (0.0, 0.1), "FR": (0.0, -0.1)}))

    assert "up" not in str(refusal.value)


@pytest.mark.parametrize(
    ("scale", "offer"), [(10, Choices(scale=0.1)), (1, None), (0.1, Choices(scale=10))]
)
def test_a_robot_whose_size_does_not_fit_its_mass_is_offered_a_scale(
    scale: float, offer: Choices | None
) -> None:
    robot = read(dog(keyframes={"home": HOME}), choices=Choices(scale=scale))

    offers = {note.text: note.offer for note in robot.notes if note.topic == "size"}
    texts = {
        10: "it stands 3.1 m high and weighs 8.4 kg: read it at 1:10?",
        0.1: "it stands 31 mm high and weighs 8.4 kg: read it at 10:1?",
    }
    assert offers == ({} if offer is None else {texts[scale]: offer})


def test_a_robot_in_grams_is_offered_a_mass() -> None:
    heavy = re.sub(r'mass="([^"]*)"', lambda mass: f'mass="{1000 * float(mass[1])}"', dog())
    with pytest.raises(InvalidInput, match=r"body trunk weighs 5,000 kg.*choose `mass_kg`"):
        read(heavy)


def test_masses_by_density_of_a_large_robot_are_refused_with_a_scale() -> None:
    dense = re.sub(r' mass="[^"]*"', ' density="1000"', dog(keyframes={"home": HOME}))
    large = re.sub(
        r' (size|pos|fromto)="([^"]*)"',
        lambda found: (
            f' {found[1]}="'
            + " ".join(str(10 * float(number)) for number in found[2].split())
            + '"'
        ),
        dense,
    )

    with pytest.raises(InvalidInput, match=r"body trunk weighs 6,\d{3} kg.* `scale` reads"):
        read(large)
    assert read(large, choices=Choices(scale=0.1)).mass_kg < 20


def test_limits_are_exchanged_where_the_lower_is_above_the_upper() -> None:
    upside_down = '<limit lower="1.5" upper="-1.2" effort="{effort}" velocity="5"/>'
    robot = read(bug(limit=upside_down))

    assert robot.model.joints_of(1)[1].limits_rad == (-1.2, 1.5)
    note = about(robot, "lower limits above upper ones were exchanged, such as 1.5 and -1.2 of")
    assert len(note.parts) == 18
    assert not any("have no limits" in text for text in robot.guesses)
