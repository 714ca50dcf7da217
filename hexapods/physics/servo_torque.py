"""Torque and mechanical work of the position servos, from the substeps of a simulated step."""

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from hexapods.domain.types import FloatArray, IntArray


class Effort(NamedTuple):
    """Torque and work of the servos up to each of k frames, since the frame before."""

    torque_nm: NDArray[np.float16]
    """Largest torque by magnitude of each servo, with its sign [N·m], (k, servos)."""
    work_j: NDArray[np.float32]
    """Positive mechanical work, summed over all servos [J], (k,)."""


def servo_effort(
    model: mujoco.MjModel,
    targets: FloatArray,
    angles: FloatArray,
    speeds: FloatArray,
    *,
    speeds_before: FloatArray,
    frames: IntArray,
) -> Effort:
    """Compute torque and work of the servos, by their control law and the integrator's.

    A servo's torque is kp (target − angle) − kv · speed, within its limits. MuJoCo's integrator
    `implicitfast` takes the speed at the end of a substep there, so `actuator_force`, which has the
    speed at its beginning, is not what accelerates the joint: at 4 ms its work is 45 % too large
    for stiff servos. Work is torque times the mean of both speeds, by which the work of all forces
    is the change of kinetic energy. Negative work is not subtracted: servos recover nothing.

    Args:
        model: its servos' gains and limits.
        targets: targets of the servos in each substep [rad], (n, servos).
        angles: angles of the joints after each substep [rad], (n, servos).
        speeds: speeds of the joints after each substep [rad/s], (n, servos).
        speeds_before: speeds of the joints before the first substep [rad/s], (servos,).
        frames: indices of the substeps after which a frame ends, ascending, (k,).
    """
    dt_s, kp = model.opt.timestep, model.actuator_gainprm[:, 0]
    limit = model.actuator_forcerange[:, 1]
    # The angle at the beginning of a substep is the one at its end less dt · speed.
    torque = kp * (targets - angles) + (kp * dt_s + model.actuator_biasprm[:, 2]) * speeds
    np.clip(torque, -limit, limit, out=torque)
    power = speeds.copy()
    power[1:] += speeds[:-1]
    power[0] += speeds_before
    power *= torque
    np.maximum(power, 0, out=power)
    begins = np.concatenate(([0], frames[:-1] + 1))
    work = np.add.reduceat(power, begins).sum(axis=1) * (dt_s / 2)
    high, low = np.maximum.reduceat(torque, begins), np.minimum.reduceat(torque, begins)
    largest = np.where(high > -low, high, low)
    return Effort(largest.astype(np.float16), work.astype(np.float32))
