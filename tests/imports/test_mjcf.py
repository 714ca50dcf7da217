import re

import numpy as np
import pytest

from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import resolve
from hexapods.imports.choices import Choices
from tests.imports.robots import FOUR, HOME, dog, read
from tests.imports.same_motion import compare, feet_and_center


def mentions(sentences: tuple[str, ...], words: str) -> bool:
    return any(words in sentence for sentence in sentences)


def test_a_quadruped_is_read_with_its_legs_numbered_from_the_front_right() -> None:
    robot = read(dog(keyframes={"home": HOME}))

    assert [leg.foot for leg in robot.legs] == ["FR", "FL", "RL", "RR"]
    assert robot.legs[0].joints[0] == "FR_hip_joint"
    assert [joint.name for joint in robot.model.joints_of(1)] == ["hip", "thigh", "calf"]
    assert (robot.name, robot.file_format, robot.gait) == ("dog", "mjcf", "trot")
    assert robot.mass_kg == pytest.approx(5 + 4 * 0.85)
    assert robot.forward_deg == 0
    assert robot.keyframes == ("home",)
    assert robot.reaches_grid
    assert robot.body_height_m == pytest.approx(2 * 0.2 * np.cos(0.7), abs=1e-6)
    assert robot.model.feet[0].radius_m == pytest.approx(0.02)
    assert mentions(robot.guesses, "keyframe home")
    assert mentions(robot.guesses, "by the names of the legs in front and behind")


def test_it_moves_as_in_mujoco() -> None:
    text = dog(keyframes={"home": HOME})

    worst = compare(
        read(text),
        text,
        rng=np.random.default_rng(0),
        is_base="trunk",
        foot_of={leg: leg for leg in FOUR},
    )

    assert worst < 1e-9


def test_angles_count_from_where_the_file_does() -> None:
    # With `ref` the body is drawn as at that angle, not at 0.
    text = dog().replace('_thigh_joint" axis', '_thigh_joint" ref="0.5" axis')

    worst = compare(
        read(text),
        text,
        rng=np.random.default_rng(0),
        is_base="trunk",
        foot_of={leg: leg for leg in FOUR},
    )

    assert worst < 1e-9


def test_the_feet_are_on_the_sides_that_they_are_on_in_the_file() -> None:
    robot = read(dog(keyframes={"home": HOME}))
    home = {
        (leg, joint.name): joint.home_rad
        for leg in range(1, 5)
        for joint in robot.model.joints_of(leg)
    }

    feet, _ = feet_and_center(robot, home)

    # Right and left, forward and back; body y is forward.
    assert np.sign(feet[:, :2]).tolist() == [[1, 1], [-1, 1], [-1, -1], [1, -1]]
    assert np.ptp(feet[:, 2]) < 1e-6


def test_motors_become_servos_with_their_torque() -> None:
    motor = '<motor joint="{joint}" gear="3" ctrlrange="-7 7"/>'

    robot = read(dog(actuators=motor))
    joint = robot.model.joints_of(1)[0]

    assert joint.servo_torque_nm == pytest.approx(21)
    assert joint.servo_kp == pytest.approx(21 / 0.05)
    assert joint.servo_kv == pytest.approx(0.025 * 21 / 0.05)
    assert joint.armature == pytest.approx(0.021)
    assert mentions(robot.repairs, "12 motors became position servos")
    assert mentions(robot.repairs, "armature of 12 joints was raised")


@pytest.mark.parametrize(
    "actuators",
    ["", '<motor joint="{joint}"/>', '<position joint="{joint}" forcerange="-1000 1000"/>'],
)
def test_without_a_torque_limit_one_is_guessed(actuators: str) -> None:
    robot = read(dog(actuators=actuators))

    assert mentions(robot.guesses, "largest torque of all joints is")
    assert 2 < robot.model.joints_of(1)[0].servo_torque_nm < 50


def test_a_welded_base_becomes_free() -> None:
    robot = read(dog(base=""))

    assert mentions(robot.repairs, "trunk was fixed to the world")
    assert robot.mass_kg == pytest.approx(8.4)


def test_an_arm_holds() -> None:
    arm = """<body name="arm_lower" pos="0.1 0 0.06"><joint name="shoulder" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.1 0 0.1" size="0.02" mass="0.5"/>
      <body name="arm_upper" pos="0.1 0 0.1"><joint name="elbow" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.1 0 0" size="0.02" mass="0.4"/></body></body>"""

    robot = read(dog(on_torso=arm))

    assert len(robot.legs) == 4
    assert mentions(robot.repairs, "joints of no leg, which hold: shoulder, elbow")
    assert robot.model.links[0].mass_kg == pytest.approx(5.9)
    assert "arm_upper" in robot.feet


def test_wheels_are_locked_and_become_feet() -> None:
    wheel = """<body name="{leg}_wheel" pos="0 0 -0.2"><joint name="{leg}_wheel" axis="0 1 0"/>
      <geom type="cylinder" size="0.05 0.01" euler="1.5707963 0 0" mass="0.1"/></body>"""

    robot = read(dog(foot="", on_shank=wheel))

    assert [len(leg.joints) for leg in robot.legs] == [3, 3, 3, 3]
    assert mentions(robot.repairs, "wheels, which were locked: FL_wheel")
    assert robot.model.feet[0].radius_m == pytest.approx(0.05, rel=0.02)


def test_a_spine_is_locked_and_the_legs_behind_it_found() -> None:
    text = dog()
    front, behind = text.split('<body name="RL_hip"')
    text = (
        f'{front}<body name="rump"><joint name="spine" axis="0 0 1" range="-1 1"/>'
        f'<geom type="sphere" size="0.05" mass="0.2"/><body name="RL_hip"{behind}'
    ).replace("</body></worldbody>", "</body></body></worldbody>")

    robot = read(text)

    assert len(robot.legs) == 4
    assert mentions(robot.repairs, "joints of no leg, which hold: spine")


def test_a_crouch_is_no_home() -> None:
    # Hips lifted and knees folded so that the torso lies on the ground.
    crouch = "0 0 0.1 1 0 0 0" + 4 * " 0 1.5 -2.69"

    robot = read(dog(keyframes={"home": crouch}))

    assert mentions(robot.guesses, "with bent knees, as was searched: in keyframe home")
    assert robot.reaches_grid
    assert robot.body_height_m > 0.2


def test_the_second_keyframe_is_taken_if_the_first_is_none() -> None:
    crouch = "0 0 0.1 1 0 0 0" + 4 * " 0 1.5 -2.69"

    robot = read(dog(keyframes={"home": crouch, "stand": HOME}))

    assert mentions(robot.guesses, "as in keyframe stand")


def test_uneven_feet_are_levelled() -> None:
    uneven = "0 0 0.3 1 0 0 0 0 0.7 -1.4 0 0.7 -1.4 0 0.7 -1.3 0 0.7 -1.4"

    robot = read(dog(keyframes={"home": uneven}))
    home = {
        (leg, joint.name): joint.home_rad
        for leg in range(1, 5)
        for joint in robot.model.joints_of(leg)
    }

    assert mentions(robot.repairs, "mm uneven; now level")
    assert np.ptp(feet_and_center(robot, home)[0][:, 2]) < 1e-4


def test_joints_without_limits_get_some() -> None:
    robot = read(dog(limits=False))

    assert mentions(robot.guesses, "all joints have no limits in the file")
    for joint in robot.model.joints_of(2):
        assert np.ptp(joint.limits_rad) == pytest.approx(np.pi)


def test_elements_without_a_name_get_one() -> None:
    text = re.sub(r' name="\w+"', "", dog(actuators=""))

    robot = read(text)

    assert len(robot.legs) == 4
    assert len({leg.foot for leg in robot.legs}) == 4
    assert mentions(robot.guesses, "as in most files, since no name tells")


def test_two_joints_of_one_body_are_two_links() -> None:
    text = dog(actuators="")
    # The hip's joint moves to the thigh's body.
    for leg in FOUR:
        text = text.replace(
            f'<joint name="{leg}_hip_joint" axis="1 0 0" range="-0.8 0.8"/>', ""
        ).replace(
            f'<joint name="{leg}_thigh_joint"',
            f'<joint name="{leg}_hip_joint" axis="1 0 0" range="-0.8 0.8"/>'
            f'<joint name="{leg}_thigh_joint"',
        )

    robot = read(text)

    assert [joint.name for joint in robot.model.joints_of(1)] == ["hip", "thigh", "calf"]
    assert sum(link.mass_kg for link in robot.model.links) == pytest.approx(8.4, abs=1e-4)
    worst = compare(
        robot,
        text,
        rng=np.random.default_rng(0),
        is_base="trunk",
        foot_of={leg: leg for leg in FOUR},
    )
    assert worst < 1e-6


def test_closed_loops_are_left_out_and_noted() -> None:
    loop = (
        '<equality><connect body1="FL_calf" body2="FR_calf" anchor="0 0 0"/></equality>'
        '<sensor><gyro site="none"/></sensor>'
    )

    assert mentions(read(dog(sections=loop)).repairs, "left out what connects bodies")


def test_impossible_inertias_are_replaced() -> None:
    inertial = '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.5"/>'

    robot = read(dog(on_torso=f'<body name="pack" pos="0 0 0.1">{inertial}</body>'))

    assert mentions(robot.repairs, "inertias that no body can have")
    assert robot.mass_kg == pytest.approx(9.4)


def test_what_stands_beside_the_robot_is_left_out() -> None:
    ball = '<worldbody><body name="ball"><freejoint/><geom size="0.1"/></body></worldbody>'

    robot = read(dog(sections=ball))

    assert mentions(robot.repairs, "not joined to the robot: ball")
    assert robot.mass_kg == pytest.approx(8.4)


class TestChoices:
    def test_forward(self) -> None:
        robot = read(dog(keyframes={"home": HOME}), choices=Choices(forward="-x"))

        assert robot.forward_deg == 180
        assert [leg.foot for leg in robot.legs] == ["RL", "RR", "FR", "FL"]
        assert not mentions(robot.guesses, "forward")

    def test_feet(self) -> None:
        on_shank = '<body name="{leg}_end" pos="0 0 -0.19"><site name="{leg}_site"/></body>'
        names = ("FL_site", "RR_end", "FR", "RL_calf")

        robot = read(dog(on_shank=on_shank), choices=Choices(feet=names))

        assert {leg.foot for leg in robot.legs} == {*names}
        assert not mentions(robot.guesses, "legs are the chains")

    def test_home_and_keyframe(self) -> None:
        text = dog(keyframes={"home": HOME, "low": "0 0 0.3 1 0 0 0" + 4 * " 0 1.1 -2.2"})

        low = read(text, choices=Choices(keyframe="low"))
        changed = read(text, choices=Choices(home_rad={"FR_hip_joint": 0.1}))

        assert low.model.joints_of(1)[1].home_rad == pytest.approx(1.1)
        assert changed.model.joints_of(1)[0].home_rad == 0.1
        assert changed.model.joints_of(2)[0].home_rad == 0

    def test_gait_and_servos(self) -> None:
        robot = read(
            dog(), choices=Choices(gait="pace", servo_torque_nm=9, servo_kp=100, servo_kv=3)
        )
        joint = robot.model.joints_of(3)[2]

        assert robot.gait == "pace"
        assert (joint.servo_torque_nm, joint.servo_kp, joint.servo_kv) == (9, 100, 3)
        assert not mentions(robot.guesses, "torque")

    @pytest.mark.parametrize(
        ("choices", "said"),
        [
            (Choices(forward="up"), "forward must be x, y, -x, -y or an angle"),
            (Choices(feet=("FL", "FR", "tail")), "no body, geom or site 'tail'"),
            (Choices(feet=("FL", "FR", "box")), "box cannot be a foot"),
            (Choices(feet=("FL", "FL_calf", "RR")), "leg to FL has 0 hinges of its own"),
            (Choices(keyframe="sit"), "no keyframe 'sit'; it has: home"),
            (Choices(home_rad={"knee": 0.1}), "no leg has a joint 'knee'"),
            (Choices(home_rad={"FR_hip_joint": 2}), "of leg 1 must be from -0.8 to 0.8 rad"),
            (Choices(gait="tripod"), "tripod makes no sense"),
        ],
    )
    def test_impossible_ones_are_refused(self, choices: Choices, said: str) -> None:
        with pytest.raises(InvalidInput, match=re.escape(said)):
            read(dog(keyframes={"home": HOME}), choices=choices)


@pytest.mark.parametrize(("count", "groups"), [(3, 3), (5, 3), (6, 2), (7, 3), (8, 2), (12, 2)])
def test_any_number_of_legs_gets_groups_that_go_forward(count: int, groups: int) -> None:
    angles = [2 * np.pi * (number + 0.5) / count for number in range(count)]
    mounts = {f"L{n}": (0.3 * np.cos(a), 0.3 * np.sin(a)) for n, a in enumerate(angles)}

    robot = read(dog(mounts))
    places = [np.add(link.at_m, 0) for link in robot.model.links if link.parent == 0]
    azimuths = [float(np.degrees(np.arctan2(y, x))) for x, y, _ in places]
    gait = resolve(robot.gait, azimuths)

    assert len(robot.legs) == count
    assert len(gait.groups) == groups
    assert gait.forward_deg == pytest.approx(90, abs=1)
    turns = np.diff([*azimuths, azimuths[0]]) % 360
    assert turns.sum() == pytest.approx(360)


@pytest.mark.parametrize("count", [2, 13])
def test_other_numbers_of_legs_are_refused(count: int) -> None:
    angles = [2 * np.pi * (number + 0.5) / count for number in range(count)]
    mounts = {f"L{n}": (0.3 * np.cos(a), 0.3 * np.sin(a)) for n, a in enumerate(angles)}

    with pytest.raises(InvalidInput, match=f"found {count} legs"):
        read(dog(mounts))
