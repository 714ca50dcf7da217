"""What a file has that MuJoCo or a robot here cannot have is left out and told."""

import re

import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.imports.imported import ImportedRobot
from hexapods.imports.notes import Note
from tests.imports.robots import HOME, INERTIAL, bug, dog, link, read, zipped
from tests.imports.test_mjcf import mentions

TENDONS = (
    '<tendon><fixed name="t"><joint joint="FL_thigh_joint" coef="1"/>'
    '<joint joint="FL_calf_joint" coef="1"/></fixed></tendon>'
)


def note_with(robot: ImportedRobot, words: str) -> Note:
    """Return the only note that has some words."""
    (note,) = (note for note in robot.notes if words in note.text)
    return note


class TestActuators:
    @pytest.mark.parametrize(
        "actuator",
        [
            '<general name="lift" tendon="t"/>',
            '<motor name="lift" site="s" gear="0 0 1 0 0 0"/>',
            '<adhesion name="lift" body="FL_calf" ctrlrange="0 1"/>',
            '<muscle name="lift" joint="FL_hip_joint"/>',
        ],
    )
    def test_those_of_no_joint_are_left_out_with_what_they_act_on(self, actuator: str) -> None:
        sensor = '<sensor><actuatorfrc actuator="lift"/></sensor>'
        text = dog(
            keyframes={"home": HOME + '" ctrl="0 0 0 0 0 0 0 0 0 0 0 0 1'},
            on_shank='<site name="{leg}_s"/>',
            sections=f"<actuator>{actuator}</actuator>{TENDONS}{sensor}",
        ).replace('"FL_s"', '"s"')

        robot = read(text)

        assert len(robot.legs) == 4
        note = note_with(robot, "left out 1 actuator that no servo of a joint can replace")
        assert note.text.endswith(": lift")
        assert robot.model.joints_of(1)[0].servo_torque_nm == 20

    def test_those_of_joints_in_their_parents_frame_are_those_of_joints(self) -> None:
        actuator = '<position jointinparent="{joint}" kp="40" forcerange="-20 20"/>'

        robot = read(dog(actuators=actuator))

        assert robot == read(dog())

    def test_an_actuator_of_no_joint_of_the_file_stays_an_error(self) -> None:
        with pytest.raises(InvalidInput, match="MuJoCo refuses the file"):
            read(dog(sections='<actuator><motor joint="nowhere"/></actuator>'))


class TestCoupledJoints:
    def test_in_mjcf_they_are_told(self) -> None:
        equality = '<equality><joint joint1="FL_calf_joint" joint2="FL_thigh_joint"/></equality>'

        note = note_with(read(dog(sections=equality)), "each joint has a servo of its own")

        assert note.parts == ("FL_calf_joint", "FL_thigh_joint")

    def test_in_urdf_they_are_told(self) -> None:
        mimic = '<mimic joint="j_femur_lf" multiplier="-1"/></joint>'
        before, after = bug().split('<joint name="j_tibia_lf"')

        robot = read(f'{before}<joint name="j_tibia_lf"{after.replace("</joint>", mimic, 1)}')

        note = note_with(robot, "<mimic> is not followed, each joint has a servo of its own")
        assert note.parts == ("j_tibia_lf",)


class TestShapesOfSizeZero:
    def test_in_urdf_they_are_left_out(self) -> None:
        dot = '<visual><geometry><sphere radius="0.0"/></geometry></visual>'
        flat = '<visual><geometry><box size="0.1 0 0.1"/></geometry></visual>'

        robot = read(bug(inertial=INERTIAL + dot, torso=flat))

        note = note_with(robot, "shapes of size 0 were left out")
        assert note.parts[0] == "base_link"
        assert "femur_rm" in note.parts
        assert robot.model.links[0].mass_kg == pytest.approx(1.5)

    def test_in_mjcf_their_mass_stays_with_the_body(self) -> None:
        dot = (
            '<geom type="sphere" size="0" mass="0.3"/>'
            '<body name="flag" pos="0 0 .1"><geom type="cylinder" size="0 .1" mass=".2"/></body>'
            '<site name="mark" size="0"/>'
        )

        robot = read(dog(on_torso=dot))

        assert note_with(robot, "shapes of size 0 were left out").parts == ("trunk", "flag")
        assert robot.mass_kg == pytest.approx(8.9)

    def test_a_capsule_without_length_is_a_ball(self) -> None:
        foot = '<geom name="{leg}" type="capsule" size="0.02 0" pos="0 0 -0.2" mass="0.05"/>'
        point = foot.replace('size="0.02 0" pos="0 0 -0.2"', 'size="0.02" fromto="0 0 -.2 0 0 -.2"')

        for text in (dog(foot=foot), dog(foot=point)):
            robot = read(text)

            assert robot.model.feet == read(dog()).model.feet
            assert not mentions(robot.repairs, "size 0")


class TestPlaceholderMasses:
    @pytest.mark.parametrize("kg", ["1e-7", "1e-5", "0.00002", "1e-4"])
    def test_they_are_guessed_as_masses_of_0_are(self, kg: str) -> None:
        box = '<collision><geometry><box size=".06 .04 .04"/></geometry></collision>'

        def weighing(kg: str) -> ImportedRobot:
            inertial = INERTIAL.replace('"0.1"', f'"{kg}"')
            return read(bug(inertial=inertial + box, torso_inertial=inertial))

        robot = weighing(kg)

        assert robot.model == weighing("0").model
        (note,) = (note for note in robot.notes if note.topic == "masses")
        assert "guessed by" in note.text
        assert len(note.parts) == 19

    def test_light_links_that_all_differ_are_no_placeholders(self) -> None:
        text = dog()
        for number in range(4):
            text = re.sub(r'mass="0\.[1-4]"', f'mass="{1e-5 * (1 + number):g}"', text, count=3)
        numbers = iter(range(100))
        text = re.sub(r'mass="\de-05"', lambda _: f'mass="{1e-5 * (2 + next(numbers)):g}"', text)

        robot = read(text)

        assert robot.mass_kg == pytest.approx(5.2, rel=0.01)
        assert not mentions(robot.guesses, "placeholders")

    def test_slanted_rods_of_real_masses_stay(self) -> None:
        rod = (
            '<collision><origin rpy="0.8 0.8 0.8"/><geometry>'
            '<box size="0.2 0.005 0.005"/></geometry></collision>'
        )

        robot = read(bug(inertial=INERTIAL.replace('"0.1"', '"0.0075"') + rod))

        assert robot.mass_kg == pytest.approx(1.5 + 18 * 0.0075)

    def test_light_links_of_real_masses_stay(self) -> None:
        robot = read(bug(inertial=INERTIAL.replace('"0.1"', '"0.004"')))

        assert robot.mass_kg == pytest.approx(1.5 + 18 * 0.004)


class TestLeftOutElements:
    def test_limits_of_characters_and_elements_count_what_is_kept(self) -> None:
        heights = '<asset><hfield name="h" nrow="200" ncol="200" size="1 1 1 1" elevation="'
        names = "".join(f'<text name="t{n}" data="x"/>' for n in range(30_000))
        sections = f'{heights}{"0.25 " * 40_000}"/></asset><custom>{names}</custom>'

        assert len(read(dog(sections=sections)).legs) == 4

    def test_of_elements_that_are_there_twice_the_first_counts(self) -> None:
        second = INERTIAL.replace("0.1", "9")
        text = bug().replace("</robot>", f"{link('spare', INERTIAL + second)}</robot>")
        text = text.replace(INERTIAL, INERTIAL + second, 2).replace(
            "</robot>",
            '<joint name="j" type="fixed"><parent link="base_link"/><child link="spare"/>'
            '<origin xyz="0 0 .02 7" rpy="0 0 0 1"/><origin xyz="5 5 5"/></joint></robot>',
        )

        robot = read(text)

        assert robot.mass_kg == pytest.approx(3.4)
        assert note_with(robot, "the first count").parts == ("coxa_lf", "femur_lf", "spare", "j")

    def test_of_links_and_joints_that_are_there_twice_the_first_count(self) -> None:
        again = link("femur_lf", INERTIAL.replace("0.1", "9")) + (
            '<joint name="j_femur_lf" type="fixed"><parent link="coxa_lf"/>'
            '<child link="femur_lf"/></joint>'
        )

        robot = read(bug(more=again))

        assert note_with(robot, "are there twice").parts == ("femur_lf", "j_femur_lf")
        assert robot.model == read(bug()).model

    def test_two_joints_of_one_name_are_refused_as_by_mujoco(self) -> None:
        with pytest.raises(InvalidInput, match=r"MuJoCo refuses the file .*repeated name"):
            read(dog().replace('joint name="FL_hip_joint"', 'joint name="FR_hip_joint"'))


class TestSeveralTrees:
    def test_the_one_with_the_most_joints_is_the_robot(self) -> None:
        robot = read(bug(more=link("camera")))

        note = note_with(robot, "left out what is not joined to the robot")
        assert note.text.endswith("which begins at base_link: camera")
        assert robot.model == read(bug()).model

    def test_what_floats_below_a_footprint_is_the_robot(self) -> None:
        more = (
            '<link name="base_footprint"/><joint name="f" type="floating">'
            '<parent link="base_footprint"/><child link="base_link"/></joint>'
        )

        robot = read(bug(more=more))

        assert robot.model == read(bug()).model
        assert not mentions(robot.repairs, "left out what is not joined")
        assert not mentions(robot.repairs, "fixed to the world")

    def test_what_stands_above_a_floating_robot_is_told(self) -> None:
        more = (
            link("ground", INERTIAL) + '<joint name="f" type="floating">'
            '<parent link="ground"/><child link="base_link"/></joint>'
        )

        robot = read(bug(more=more))

        assert robot.model == read(bug()).model
        assert mentions(robot.repairs, "which begins at base_link: ground")


class TestMissingMeshes:
    def test_masses_of_their_geoms_stay(self) -> None:
        text = dog(
            foot='<geom type="mesh" mesh="m" mass="0.05"/>',
            on_torso='<body name="pack"><geom type="mesh" mesh="m" mass="1"/></body>',
            sections='<asset><mesh name="m" file="m.stl"/></asset>',
        )

        robot = read(text)

        assert robot.mass_kg == pytest.approx(5 + 4 * 0.85 + 1)
        assert mentions(robot.repairs, "1 mesh is missing from the upload")

    def test_last_links_without_any_shape_are_told(self) -> None:
        text = dog(
            foot='<geom type="mesh" mesh="m" mass="0.05"/>',
            sections='<asset><mesh name="m" file="m.stl"/></asset>',
        )
        text = re.sub(r'<geom type="capsule" fromto="0 0 -0.02[^>]*>', "", text)

        note = note_with(read(text), "it is not known how long the last links are")

        assert set(note.parts) == {f"{leg}_calf" for leg in ("FL", "FR", "RL", "RR")}

    def test_a_class_may_name_the_mesh(self) -> None:
        classes = (
            '<default><default class="hull"><geom type="mesh" mesh="m"/></default></default>'
            '<asset><mesh name="m" file="m.stl"/></asset>'
        )

        robot = read(dog(on_torso='<geom class="hull" mass="0.5"/>', sections=classes))

        assert robot.mass_kg == pytest.approx(8.9)

    def test_a_refusal_names_them(self) -> None:
        mesh = '<visual><geometry><mesh filename="m.stl"/></geometry></visual>'
        text = bug(inertial=mesh, torso_inertial=mesh, torso="", femur="", tip="")

        with pytest.raises(InvalidInput) as raised:
            read(zipped({"bug.urdf": text}))

        assert "no link has a mass" in str(raised.value)
        assert "1 mesh is missing from the upload" in str(raised.value)
        assert "m.stl" in str(raised.value)
