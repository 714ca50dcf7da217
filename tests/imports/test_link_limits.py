"""What is too heavy or too large is told in the words of the file; meshes in mm are scaled."""

import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput
from tests.imports.robots import box_triangles, bug, dog, read, stl, zipped
from tests.imports.test_urdf import decoded

VISUAL = '<visual><geometry><mesh filename="{file}"{scale}/></geometry></visual>'
HULL, ROD = box_triangles((200, 100, 40)), box_triangles((8, 2, 2))


def in_millimetres(scale: str = "", meshes: float = 1.0) -> bytes:
    """Return a hexapod whose meshes are in millimetres; a small one is not larger than a robot."""
    return zipped(
        {
            "bug.urdf": bug(
                torso=VISUAL.format(file="hull.stl", scale=scale),
                femur=VISUAL.format(file="rod.stl", scale=scale),
            ),
            "hull.stl": stl(HULL * meshes),
            "rod.stl": stl(ROD * meshes),
        }
    )


def test_meshes_in_millimetres_are_scaled_and_told() -> None:
    robot = read(in_millimetres())

    (note,) = (note for note in robot.notes if "were read in millimetres" in note.text)
    assert "up to 200 m large" in note.text
    assert {"base_link", "femur_rf"} <= set(note.parts)
    told_so = read(in_millimetres(' scale="0.001 0.001 0.001"'))
    assert not any("millimetres" in note.text for note in told_so.notes)
    assert robot.model == told_so.model
    vertices, _ = decoded(robot.model.links[0].mesh)
    assert np.ptp(vertices, axis=0) == pytest.approx([0.1, 0.2, 0.04], rel=1e-3)


@pytest.mark.parametrize(
    ("on_torso", "said"),
    [
        ('<geom type="box" size="1 1 .5"/>', "body trunk weighs 4,005 kg, with what is fixed"),
        ('<geom type="box" size="1 1 .5"/>', "Shapes without a mass have 1,000 kg/m³"),
        ('<geom type="box" size="20 1 1" mass="1" pos="0 0 2"/>', "trunk has a size of 20 m"),
        (
            '<geom type="box" size="1 1 1" mass="1" pos="30 0 2" contype="0" conaffinity="0"/>',
            "what is drawn of body trunk reaches 31 m",
        ),
    ],
)
def test_what_is_too_large_is_told_in_the_words_of_the_file(on_torso: str, said: str) -> None:
    with pytest.raises(InvalidInput) as raised:
        read(dog(on_torso=on_torso))

    assert said in str(raised.value)
    assert "damaged" not in str(raised.value)


def test_a_guessed_mass_is_never_less_than_a_link_can_have() -> None:
    dot = '<collision><geometry><sphere radius="0.0005"/></geometry></collision>'

    robot = read(bug(inertial=dot, femur=""))

    assert min(link.mass_kg for link in robot.model.links) >= 1e-6
