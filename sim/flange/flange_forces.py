"""The user's wrench on the flange from its force/torque sensor, the force that the joints feel there, and the acceleration."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.chain import Body
from sim.arm.frames import skew
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.rigid_body.dynamics import Dynamics
from sim.rigid_body.newton_euler import cross
from sim.sensing.sensors import Sample

Array = NDArray[np.float64]

TURN_BANDWIDTH = 60.0
"""Of the angular acceleration, which is the gyro's difference [Hz]. The wrists of a guided arm swing at 40 to 60 Hz: what a load
needs there and is not known of in time would seem a hand's, be helped, and make them swing more."""

DAMPING = 0.1  # lever arm below which the joints feel no force [m]


class Felt(NamedTuple):
    """What the sensors at the flange and the joints feel in a tick."""

    wrench: Array  # (6,) what the flange exerts on what it carries, in F [N, N·m]
    tool_side: Array  # specific force (3,) behind the sensor, in F [m/s²]
    gyro: Array  # (3,) there [rad/s]
    arm_side: Array  # specific force (3,) before the sensor, in F [m/s²]
    tau_ext: Array  # external torques of the joints (n,) [N·m]


class FlangeForces:
    """Both forces, each in its own way; written in place.

    Attributes:
        F_user: the user's wrench (6,) in axes of B at the flange origin: force [N], torque [N·m]; zeros while the sensor is out.
        F_joints: the force (3,) in B that explains the joints' external torques best [N].
        model: record of the rigid model that both stand on.
        passed: of the variance of the gyro's difference, if it is noise, so much is left in the angular acceleration.
        a_felt: what the accelerometer on the arm's side feels beyond gravity (3,), axes of B [m/s²].
        record: all of it, for other kernels.

    Args:
        dynamics: the controller's rigid model, whose recursion has been run in this tick.
    """

    def __init__(self, dynamics: Dynamics) -> None:
        self._dynamics, self.model = dynamics, dynamics.recursion.record
        self.record = record(
            apart=(dynamics.recursion.jacobian.shape[1],),  # torques that F_user makes beyond what the joints feel [N·m]
            F_user=(6,),
            F_joints=(3,),
            a_felt=(3,),
            gyro=(3,),  # its last value
            turn=(3,),  # smoothed angular acceleration
            smoothing=(),
            specific=(3,),  # force behind the sensor, in F [m/s²]
            missing=(6,),  # of what the load needs in its motion: F_user in axes of F
            gravity=(3,),
            mass=(),
            com=(3,),
            inertia=(3, 3),  # about the flange
        )
        own = self._own = self.record[0]
        self.F_user, self.F_joints, self.a_felt = own["F_user"], own["F_joints"], own["a_felt"]
        own["smoothing"] = smoothing = 1.0 - math.exp(-2.0 * math.pi * TURN_BANDWIDTH * TICK)
        self.passed = smoothing**2 / (2.0 - smoothing)
        own["gravity"] = dynamics.gravity_B
        self.set_load(dynamics.load)

    def set_load(self, load: Body) -> None:
        """Take `load` (in F) as everything beyond the flange."""
        own = self._own
        own["mass"], own["com"], own["inertia"] = load.mass, load.com, about_flange(load)

    def update(self, sample: Sample, q: Array, motion: Array, tau_ext: Array) -> None:
        """One tick.

        Args:
            sample: its measurements.
            q: joint angles (n,) [rad].
            motion: (3, n), of which rows 1 and 2 count: speed [rad/s] and acceleration [rad/s²].
            tau_ext: external torques of the joints (n,) [N·m].
        """
        rigid, own, differentiated = self._dynamics.recursion, self._own, sample.acceleration_valid
        force = sample.acceleration_tool
        if sample.wrench_valid and not differentiated:
            # The model stands in; its values stay for the differentiation to go on from.
            force, own["turn"] = self._dynamics.specific_force(q, motion[1], motion[2])
            own["gyro"] = rigid.R.T @ rigid.v_F[3:]
        felt = (sample.wrench, force, sample.gyro_tool, sample.acceleration_flange, tau_ext)
        _update(self.record, self.model, felt, (sample.wrench_valid, differentiated))


def about_flange(body: Body) -> Array:
    """Inertia (3, 3) of a body in F about the flange's origin [kg·m²]."""
    turned = skew(body.com)
    return body.inertia - body.mass * turned @ turned


@kernel
def _update(forces, model, felt, valid) -> None:
    felt = Felt(*felt)
    own, rigid = forces[0], model[0]
    R, specific, gravity, a_felt = rigid.R, felt.arm_side, own.gravity, own.a_felt
    wrench_valid, differentiated = valid
    best_force(rigid.jacobian, felt.tau_ext, own.F_joints)
    for k in range(3):
        a_felt[k] = R[k, 0] * specific[0] + R[k, 1] * specific[1] + R[k, 2] * specific[2] + gravity[k]
    if differentiated:
        _differentiate(felt.gyro, own.gyro, own.turn, own.smoothing)
    if wrench_valid:
        own.specific[:] = felt.tool_side
        _user_wrench(own, felt.wrench, R)
    else:
        own.F_user[:] = 0.0
    for i in range(own.apart.size):
        own.apart[i] = -felt.tau_ext[i]
        for k in range(6):
            own.apart[i] += rigid.jacobian[k, i] * own.F_user[k]


@kernel
def best_force(jacobian, tau_ext, out) -> None:
    """The force f on the flange with the least |J^T f - tau_ext|² + |damping f|²: a pure force, the damping for singularities."""
    a = np.zeros((3, 3))
    b = np.zeros(3)
    for j in range(3):
        for i in range(tau_ext.size):
            b[j] += jacobian[j, i] * tau_ext[i]
            for k in range(3):
                a[j, k] += jacobian[j, i] * jacobian[k, i]
        a[j, j] += DAMPING * DAMPING
    c0 = a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1]
    c1 = a[1, 2] * a[2, 0] - a[1, 0] * a[2, 2]
    c2 = a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0]
    determinant = a[0, 0] * c0 + a[0, 1] * c1 + a[0, 2] * c2
    d1 = a[0, 2] * a[2, 1] - a[0, 1] * a[2, 2]
    d2 = a[0, 1] * a[2, 0] - a[0, 0] * a[2, 1]
    e1 = a[0, 0] * a[2, 2] - a[0, 2] * a[2, 0]
    e2 = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
    f12 = a[0, 2] * a[1, 0] - a[0, 0] * a[1, 2]
    g = a[0, 1] * a[1, 2] - a[0, 2] * a[1, 1]
    out[0] = (c0 * b[0] + d1 * b[1] + g * b[2]) / determinant
    out[1] = (c1 * b[0] + e1 * b[1] + f12 * b[2]) / determinant
    out[2] = (c2 * b[0] + d2 * b[1] + e2 * b[2]) / determinant


@kernel
def _differentiate(gyro, last, turn, smoothing) -> None:
    for k in range(3):
        turn[k] += smoothing * ((gyro[k] - last[k]) / TICK - turn[k])
        last[k] = gyro[k]


@kernel
def _user_wrench(own, measured, R) -> None:
    """F_user: minus what the flange exerts beyond what the configured load needs, in axes of B."""
    rest, out = own.missing, own.F_user
    needed((own.mass, own.com, own.inertia), (own.specific, own.gyro, own.turn), rest)
    for k in range(6):
        rest[k] -= measured[k]
    turn_both(R, rest, out)


@kernel
def turn_both(R, wrench, out) -> None:
    """Force and torque of a wrench in other axes; `out` may be the wrench."""
    for k in range(0, 6, 3):
        x, y, z = wrench[k], wrench[k + 1], wrench[k + 2]
        for j in range(3):
            out[k + j] = R[j, 0] * x + R[j, 1] * y + R[j, 2] * z


@kernel
def needed(body, motion, out) -> None:
    """The wrench that a body beyond the flange sensor needs in its motion, in F.

    It moves with the tool-side face: its force is m (a + turn x c + w x (w x c)), its torque about the flange origin
    c x m a + J turn + w x J w, with a the specific force there, w the gyro and turn the angular acceleration.
    """
    mass, com, inertia = body
    force, gyro, turn = motion
    tangential = cross(turn, com)
    normal = cross(gyro, cross(gyro, com))
    lever = cross(com, force)
    spin, torque = np.empty(3), np.empty(3)
    for k in range(3):
        spin[k] = inertia[k, 0] * gyro[0] + inertia[k, 1] * gyro[1] + inertia[k, 2] * gyro[2]
        torque[k] = inertia[k, 0] * turn[0] + inertia[k, 1] * turn[1] + inertia[k, 2] * turn[2]
    whirl = cross(gyro, spin)
    for k in range(3):
        out[k] = mass * (force[k] + tangential[k] + normal[k])
        out[3 + k] = mass * lever[k] + torque[k] + whirl[k]
