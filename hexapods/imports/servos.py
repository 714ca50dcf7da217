"""The servos of a robot's joints: limits of angle and torque, gains, armature.

Whatever turned the joints in the file, here each has a position servo that gives its largest torque
at an error of 0.05 rad.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from hexapods.domain.text import counted
from hexapods.imports.choices import Choices
from hexapods.imports.compiling import Compiled
from hexapods.imports.notes import Notes

_FULL_TORQUE_RAD = 0.05
_KV_SHARE = 0.025
"""Velocity gain by position gain [s]."""
_ARMATURE_SHARE = 0.001
"""Least armature by torque limit; with less, stiff servos make standing feet creep."""
_NO_LIMIT_NM, _UNLIKELY_RATIO = 1000.0, 200.0
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
    torques = {joint: _torque(compiled.model, joint) for joint in joints}
    without = [joint for joint, torque in torques.items() if not _is_likely(torque, guess_nm)]
    if choices.servo_torque_nm is None and without:
        which = "all joints" if len(without) == len(joints) else counted(len(without), "joint")
        notes.guess(
            "servos",
            f"the largest torque of {which} is {guess_nm:.3g} N·m, by the robot's mass and size: "
            "the file gives none that is likely",
        )
    servos, raised = {}, 0
    for joint in joints:
        file_nm = torques[joint]
        torque = choices.servo_torque_nm
        if torque is None:
            torque = guess_nm if joint in without or file_nm is None else file_nm
        kp = choices.servo_kp or torque / _FULL_TORQUE_RAD
        dof = int(compiled.model.jnt_dofadr[joint])
        armature = float(compiled.model.dof_armature[dof])
        raised += armature < _ARMATURE_SHARE * torque
        servos[joint] = FoundServo(
            torque,
            kp,
            choices.servo_kv or _KV_SHARE * kp,
            max(armature, _ARMATURE_SHARE * torque),
            max(float(compiled.model.dof_damping[dof].max()), 0.0),
        )
    if raised:
        notes.repair(
            "servos",
            f"the armature of {counted(raised, 'joint')} was raised to {_ARMATURE_SHARE:g} of the "
            "torque limit: with less, stiff servos make standing feet creep",
        )
    _tell_of_actuators(compiled.model, joints, notes)
    return servos


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


def _tell_of_actuators(model: mujoco.MjModel, joints: Sequence[int], notes: Notes) -> None:
    actuators = [actuator for joint in joints for actuator in _actuators(model, joint)]
    motors = [actuator for actuator in actuators if _is_motor(model, actuator)]
    if not actuators:
        notes.repair("servos", "no joint had an actuator; each has a position servo now")
    elif motors:
        notes.repair("servos", f"{counted(len(motors), 'motor')} became position servos")
    else:
        notes.repair(
            "servos",
            f"servos have their largest torque at an error of {_FULL_TORQUE_RAD:g} rad, whatever "
            "gains the file gives",
        )
