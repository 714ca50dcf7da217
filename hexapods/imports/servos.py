"""The servos of a robot's joints: limits of angle and torque, gains, armature.

Whatever turned the joints in the file, here each has a position servo that gives its largest torque
at an error of 0.05 rad.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np

from hexapods.domain.text import counted
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import Compiled
from hexapods.imports.notes import Notes, listed, quoted

_FULL_TORQUE_RAD = 0.05
_KV_SHARE = 0.025
"""Velocity gain by position gain [s]."""
_ARMATURE_SHARE = 0.001
"""Least armature by torque limit; with less, stiff servos make standing feet creep."""
_NO_LIMIT_NM, _UNLIKELY_RATIO = 1000.0, 200.0
_USUAL_RAD_S = 2.5
"""Speed of a joint in a step, at which a servo must overcome the joint's damping."""
_GRAVITY = 9.81
_ARM_SHARE = 0.6
_WIDEST_RAD = 7.0
"""Limits farther out are none."""
_GUESSED_RAD = np.pi / 2
"""To each side of home, where there is no limit."""


@dataclass(frozen=True)
class FoundServo:
    """A servo; as in `ModelJoint`."""

    torque_nm: float
    kp: float
    kv: float
    armature: float
    damping: float
    friction_nm: float


def angle_limits(compiled: Compiled, joint: int) -> tuple[float, float] | None:
    """Return the lowest and highest angle of a joint; None if the file gives none."""
    model = compiled.model
    low, high = model.jnt_range[joint].tolist()
    if not model.jnt_limited[joint] or not -_WIDEST_RAD <= low < high <= _WIDEST_RAD:
        return None
    return low, high


def limits_around(home_rad: float) -> tuple[float, float]:
    """Return the limits of a joint for which the file gives none."""
    return max(home_rad - _GUESSED_RAD, -_WIDEST_RAD), min(home_rad + _GUESSED_RAD, _WIDEST_RAD)


def guessed_torque(mass_kg: float, leg_length_m: float, legs: int) -> float:
    """Return a torque limit that suits a robot: half of its legs carry it [N·m].

    Their forces have a share of the leg as their arm.
    """
    return _ARM_SHARE * mass_kg * _GRAVITY * leg_length_m / max(legs / 2, 1)


def find_servos(
    compiled: Compiled, joints: Sequence[int], guess_nm: float, choices: Choices, notes: Notes
) -> dict[int, FoundServo]:
    """Return the servo of each joint.

    Args:
        compiled: the model.
        joints: ids of all joints of legs.
        guess_nm: torque limit where the file gives none that is likely.
        choices: what a person decided.
        notes: gets what is guessed and repaired.
    """
    model = compiled.model
    torques = {joint: _torque(model, joint) for joint in joints}
    losses = {joint: _losses(model, joint) for joint in joints}
    guessed = {
        joint: guess_nm + losses[joint].at_speed_nm
        for joint, torque in torques.items()
        if not _is_likely(torque, guess_nm)
    }
    if choices.servo_torque_nm is None:
        _tell_of_torques(compiled, joints, guessed, guess_nm, notes)
    servos, raised = {}, 0
    for joint in joints:
        torque = choices.servo_torque_nm or guessed.get(joint) or torques[joint] or guess_nm
        kp = choices.servo_kp or torque / _FULL_TORQUE_RAD
        armature = float(model.dof_armature[int(model.jnt_dofadr[joint])])
        raised += armature < _ARMATURE_SHARE * torque
        servos[joint] = FoundServo(
            torque,
            kp,
            choices.servo_kv or _KV_SHARE * kp,
            max(armature, _ARMATURE_SHARE * torque),
            losses[joint].damping,
            losses[joint].friction_nm,
        )
    _tell_of_weak_servos(compiled, servos, notes)
    if raised:
        notes.repair(
            "servos",
            f"the armature of {counted(raised, 'joint')} was raised to {_ARMATURE_SHARE:g} of the "
            "torque limit: with less, stiff servos make standing feet creep",
        )
    _tell_of_actuators(compiled, joints, notes)
    return servos


class _Losses(NamedTuple):
    """Damping [N·m·s/rad] and dry friction of a joint."""

    damping: float
    friction_nm: float

    @property
    def at_speed_nm(self) -> float:
        """Torque that both take while the joint turns as in a step."""
        return self.friction_nm + _USUAL_RAD_S * self.damping


def _losses(model: mujoco.MjModel, joint: int) -> _Losses:
    dof = int(model.jnt_dofadr[joint])
    damping, friction_nm = model.dof_damping[dof].max(), model.dof_frictionloss[dof].max()
    return _Losses(max(float(damping), 0.0), max(float(friction_nm), 0.0))


def _tell_of_torques(
    compiled: Compiled,
    joints: Sequence[int],
    guessed: Mapping[int, float],
    guess_nm: float,
    notes: Notes,
) -> None:
    if not guessed:
        return
    which = "all joints" if len(guessed) == len(joints) else counted(len(guessed), "joint")
    least, most = min(guessed.values()), max(guessed.values())
    how_large = f"{most:.3g}" if f"{least:.3g}" == f"{most:.3g}" else f"{least:.3g} to {most:.3g}"
    is_lossy = most > guess_nm
    notes.guess(
        "servos",
        f"the largest torque of {which} is {how_large} N·m, by the robot's mass and size"
        f"{', and the damping and friction of its joints' if is_lossy else ''}: the file gives "
        "none that is likely",
        map(compiled.joint_name, guessed),
    )


def _tell_of_weak_servos(
    compiled: Compiled, servos: Mapping[int, FoundServo], notes: Notes
) -> None:
    """Tell of servos that can hardly turn their joints against damping and friction."""
    needs = {joint: _losses(compiled.model, joint).at_speed_nm for joint in servos}
    weak = [joint for joint, servo in servos.items() if servo.torque_nm < needs[joint]]
    if not weak:
        return
    joint = max(weak, key=lambda joint: needs[joint] / servos[joint].torque_nm)
    servo = servos[joint]
    enough_nm = float(f"{2 * max(needs[joint] for joint in weak):.2g}")
    notes.guess(
        "servos",
        f"{counted(len(weak), 'servo')} can hardly move: {quoted(compiled.joint_name(joint))} has "
        f"at most {servo.torque_nm:.3g} N·m against a damping of {servo.damping:.3g} N·m·s/rad and "
        f"a friction of {servo.friction_nm:.3g} N·m",
        map(compiled.joint_name, weak),
        Choices(servo_torque_nm=enough_nm),
    )


def _is_likely(torque_nm: float | None, guess_nm: float) -> bool:
    return (
        torque_nm is not None
        and 0 < torque_nm < _NO_LIMIT_NM
        and torque_nm < _UNLIKELY_RATIO * max(guess_nm, 1e-6)
    )


def _torque(model: mujoco.MjModel, joint: int) -> float | None:
    """Return the largest torque that the file gives a joint; None if it gives none."""
    torques = []
    if model.jnt_actfrclimited[joint]:
        torques.append(float(np.abs(model.jnt_actfrcrange[joint]).max()))
    for actuator in _actuators(model, joint):
        gear = abs(float(model.actuator_gear[actuator][0]))
        if model.actuator_forcelimited[actuator]:
            torques.append(gear * float(np.abs(model.actuator_forcerange[actuator]).max()))
        elif _is_motor(model, actuator) and model.actuator_ctrllimited[actuator]:
            gain = abs(float(model.actuator_gainprm[actuator][0]))
            torques.append(gear * gain * float(np.abs(model.actuator_ctrlrange[actuator]).max()))
    return min(torques, default=None)


def _actuators(model: mujoco.MjModel, joint: int) -> list[int]:
    return [
        actuator
        for actuator in range(model.nu)
        if int(model.actuator_trnid[actuator][0]) == joint
        and int(model.actuator_trntype[actuator]) == int(mujoco.mjtTrn.mjTRN_JOINT)
    ]


def _is_motor(model: mujoco.MjModel, actuator: int) -> bool:
    return int(model.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_NONE)


def _tell_of_actuators(compiled: Compiled, joints: Sequence[int], notes: Notes) -> None:
    model = compiled.model
    actuators = {joint: _actuators(model, joint) for joint in joints}
    passive = [compiled.joint_name(joint) for joint in joints if not actuators[joint]]
    motors = [
        actuator
        for of_joint in actuators.values()
        for actuator in of_joint
        if _is_motor(model, actuator)
    ]
    if len(passive) == len(joints):
        notes.repair("servos", "no joint had an actuator; each has a position servo now")
        return
    if passive:
        notes.repair(
            "servos",
            f"these joints had no actuator, and have a position servo now: {listed(passive)}",
            passive,
        )
    if motors:
        servos = "a position servo" if len(motors) == 1 else "position servos"
        notes.repair("servos", f"{counted(len(motors), 'motor')} became {servos}")
    else:
        notes.repair(
            "servos",
            f"servos have their largest torque at an error of {_FULL_TORQUE_RAD:g} rad, whatever "
            "gains the file gives",
        )
