"""Read what an exported robot's file says of it beyond its format: it is then the same robot again.

A URDF has the element `<hexapods>`: attributes, and an element `servo` for each joint. An MJCF file
has the attributes as texts and numbers in `<custom>`, and the rest at its usual places. Files of
other programs have neither.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from hexapods.domain.body import MAX_LEGS, MIN_LEGS
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import GaitSpec, read_gait
from hexapods.domain.model_robot import ModelRobot
from hexapods.domain.robot import RANGES
from hexapods.domain.robot_model import MAX_ANGLE_RAD, ModelJoint, ModelLink, RobotModel
from hexapods.imports.choices import Choices
from hexapods.imports.documents.xml import Element
from hexapods.imports.exported_pose import HOME_KEY, ExportedPose
from hexapods.imports.imported import ImportedRobot

PREFIX = "hexapods_"
"""Begins the names of settings in MJCF."""
_ELEMENT = "hexapods"
_FRAME_FORWARD_DEG = 90.0
_FREE = 7
"""Numbers of the torso in `qpos`."""


@dataclass(frozen=True)
class ServoSettings:
    """Servo of a joint; as in `ModelJoint`.

    Attributes:
        torque_nm: None if the file does not say.
    """

    kp: float
    kv: float
    armature: float
    torque_nm: float | None


@dataclass(frozen=True)
class ExportedSettings:
    """Settings of an exported robot.

    Attributes:
        feet: names of the feet in the file, in the order of the legs.
        gait: which legs move together; None to find one.
        numbers: values of fields in `ModelRobot.changeable`.
        servos: the servos, by the names of their joints.
        home_rad: angles of the joints with which it stands.
    """

    feet: tuple[str, ...]
    gait: str | GaitSpec | None
    numbers: Mapping[str, float]
    servos: Mapping[str, ServoSettings]
    home_rad: Mapping[str, float]

    def fill(self, choices: Choices) -> Choices:
        """Return choices with the settings for what a person has not chosen."""
        filled = choices
        if filled.keyframe is None:
            filled = replace(filled, keyframe=HOME_KEY)
        if self._keeps_frame(choices):
            gait = self.gait if choices.gait is None else choices.gait
            filled = replace(filled, feet=self.feet, forward=_FRAME_FORWARD_DEG, gait=gait)
        return filled

    def pose(self, choices: Choices) -> ExportedPose:
        """Return what it says of frame and stance, if a person has not chosen another frame."""
        return ExportedPose(self._keeps_frame(choices), self.home_rad)

    def _keeps_frame(self, choices: Choices) -> bool:
        return choices.feet is None and choices.forward is None

    def apply(self, imported: ImportedRobot, choices: Choices) -> ImportedRobot:
        """Return the robot with its servos, the names of its joints, and its numbers.

        Raises:
            InvalidInput: if they are no valid robot.
        """
        links, places = list[ModelLink](), dict[int, int]()
        for link in imported.model.links:
            if link.joint is not None:
                place = places.get(link.leg, 0)
                places[link.leg] = place + 1
                name = imported.legs[link.leg - 1].joints[place]
                joint = self._joint(link.joint, link.leg, name, choices)
                link = replace(link, joint=joint)  # noqa: PLW2901
            links.append(link)
        model = RobotModel(tuple(links), imported.model.feet)
        applied = replace(
            imported,
            model=model,
            numbers=dict(self.numbers),
            notes=tuple(note for note in imported.notes if note.topic != "servos"),
        )
        applied.robot(imported.name)  # raises where they do not go together
        return applied

    def _joint(self, joint: ModelJoint, leg: int, name: str, choices: Choices) -> ModelJoint:
        """Return a joint with its servo, and the name that it had when the file was written."""
        servo = self.servos.get(name)
        if name.startswith(f"leg{leg}_"):
            joint = replace(joint, name=name.removeprefix(f"leg{leg}_"))
        if servo is None:
            return joint
        if choices.keyframe is None and choices.home_rad is None and choices.body_height_m is None:
            # Not moved to level the feet: they stood like this.
            joint = replace(joint, home_rad=self.home_rad.get(name, joint.home_rad))
        values = {
            "servo_kp": (choices.servo_kp, servo.kp),
            "servo_kv": (choices.servo_kv, servo.kv),
            "servo_torque_nm": (choices.servo_torque_nm, servo.torque_nm),
        }
        changes: dict[str, Any] = {
            name: value for name, (chosen, value) in values.items() if chosen is None and value
        }
        return replace(joint, armature=servo.armature, **changes)


def read_exported_settings(root: Element) -> ExportedSettings | None:
    """Return the settings in a document; None if it has none, or they are not whole."""
    is_mjcf = root.tag == "mujoco"
    values = dict(_in_custom(root)) if is_mjcf else dict(_in_element(root))
    feet = tuple(values.get("feet", "").split())
    if not MIN_LEGS <= len(feet) <= MAX_LEGS or not {*feet} <= _names(root):
        return None
    try:
        return ExportedSettings(
            feet,
            _gait(values.get("gait")),
            {
                name: _number(values[name], RANGES[name])
                for name in ModelRobot.changeable
                if name in values and name in RANGES and not name.startswith("servo_")
            },
            dict(_servos_of_mjcf(root) if is_mjcf else _servos_of_urdf(root)),
            _home_of_mjcf(root) if is_mjcf else _home_of_urdf(root),
        )
    except (ValueError, KeyError, RecursionError, InvalidInput):
        return None


def _in_custom(root: Element) -> Iterator[tuple[str, str]]:
    for section in root:
        if section.tag == "custom":
            for element in section:
                name, data = element.attributes.get("name", ""), element.attributes.get("data", "")
                if name.startswith(PREFIX):
                    yield name.removeprefix(PREFIX), data


def _in_element(root: Element) -> Iterator[tuple[str, str]]:
    element = root.first(_ELEMENT)
    if element is not None:
        yield from element.attributes.items()


def _names(root: Element) -> set[str]:
    return {element.attributes.get("name", "") for element in root.all("link", "body", "geom")}


def _gait(text: str | None) -> str | GaitSpec | None:
    if text is None:
        return None
    return read_gait(json.loads(text) if text.startswith("{") else text)


def _servos_of_urdf(root: Element) -> Iterator[tuple[str, ServoSettings]]:
    efforts = {}
    for joint in root.all("joint"):
        limit = joint.first("limit")
        if limit is not None and "effort" in limit.attributes:
            efforts[joint.attributes.get("name", "")] = _positive(limit.attributes["effort"])
    for name, servo in _servo_elements(root):
        kp, kv, armature = (_positive(servo[value]) for value in ("kp", "kv", "armature"))
        yield name, ServoSettings(kp, kv, armature, efforts.get(name))


def _servo_elements(root: Element) -> Iterator[tuple[str, Mapping[str, str]]]:
    element = root.first(_ELEMENT)
    for servo in () if element is None else element:
        if servo.tag == "servo":
            yield servo.attributes["joint"], servo.attributes


def _home_of_urdf(root: Element) -> dict[str, float]:
    return {name: _angle(servo["home"]) for name, servo in _servo_elements(root)}


def _home_of_mjcf(root: Element) -> dict[str, float]:
    """Return the angles in the keyframe; none if it is of other joints than those in the file."""
    joints = [joint.attributes.get("name", "") for joint in root.all("joint")]
    for key in root.all("key"):
        qpos = key.attributes.get("qpos", "").split()
        if key.attributes.get("name") == HOME_KEY and len(qpos) == _FREE + len(joints):
            return dict(zip(joints, map(_angle, qpos[_FREE:]), strict=True))
    return {}


def _angle(text: str) -> float:
    return _number(text, (-MAX_ANGLE_RAD, MAX_ANGLE_RAD))


def _servos_of_mjcf(root: Element) -> Iterator[tuple[str, ServoSettings]]:
    armatures = {
        joint.attributes.get("name", ""): _positive(joint.attributes["armature"])
        for joint in root.all("joint")
        if "armature" in joint.attributes
    }
    for servo in root.all("position"):
        name = servo.attributes.get("joint", "")
        if name in armatures and {"kp", "kv", "forcerange"} <= {*servo.attributes}:
            kp, kv = _positive(servo.attributes["kp"]), _positive(servo.attributes["kv"])
            torque_nm = _positive(servo.attributes["forcerange"].split()[-1])
            yield name, ServoSettings(kp, kv, armatures[name], torque_nm)


def _positive(text: str) -> float:
    return _number(text, (1e-12, 1e6))


def _number(text: str, limits: tuple[float, float]) -> float:
    """Return the number of an attribute.

    Raises:
        ValueError: if it is none within these limits.
    """
    value = float(text)
    if not limits[0] <= value <= limits[1]:
        raise ValueError(text)
    return value
