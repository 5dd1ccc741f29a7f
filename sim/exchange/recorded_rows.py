"""A tick as two rows of numbers, for recordings: what the controller knew, and the truth; written in place, without garbage."""

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.tick.estimate import Estimate
from sim.plant.true_arm import SIGN_SPEED, Plant

Array = NDArray[np.float64]


def fill_rows(e: Estimate, plant: Plant, *, gain: float, configured: float, known: Array, truth: Array, k: int) -> None:
    """Write an estimate into row k of `known` (m, 9 n + 28 or more), the true state into row k of `truth` (m, 6 n + 11).

    Known, in this order: q, qd, qdd, theta, theta_d, tau_m, tau_J, tau_ext, friction (n each); w_sensor, F_user (6 each); a_F,
    p_BF (3 each); v_F (6); speeds of tcp and elbow, `gain` on the user's force, mass `configured`.

    Truth: q, qd, theta, tau_J, friction of both sides, temperature (n each); pose of the flange in W (7); sum of the hands'
    forces in W (3); mass of what is attached.
    """
    rubs = plant.friction
    joints = (e.q, e.qd, e.qdd, e.theta, e.theta_d, e.tau_m, e.tau_J, e.tau_ext, e.friction)
    _known(*joints, e.w_sensor, e.F_user, e.a_F, e.p_BF, e.v_F, e.v_tcp, e.v_elbow, gain, configured, known, k)
    state = (plant.q, plant.qd, plant.theta, plant.theta_d, plant.tau_J, plant.friction_in)
    rest = (rubs.output_coulomb, rubs.output_viscous, plant.temperature, *plant.frames)
    _truth(*state, *rest, plant.flange_body, plant.payload.load.mass, truth, k)
    for _, _, (x, y, z), _ in plant.hands.touched:
        row = truth[k]
        row[-4] += x
        row[-3] += y
        row[-2] += z


@numba.njit(cache=True)
def _known(
    q, qd, qdd, theta, theta_d, tau_m, tau_J, tau_ext, friction, w_sensor, F_user, a_F, p_BF, v_F, tcp, elbow, gain, mass, rows, k
) -> None:
    n, out = q.size, rows[k]
    for i in range(n):
        out[i], out[n + i], out[2 * n + i] = q[i], qd[i], qdd[i]
        out[3 * n + i], out[4 * n + i] = theta[i], theta_d[i]
        out[5 * n + i], out[6 * n + i], out[7 * n + i], out[8 * n + i] = tau_m[i], tau_J[i], tau_ext[i], friction[i]
    at = 9 * n
    for i in range(6):
        out[at + i], out[at + 6 + i], out[at + 18 + i] = w_sensor[i], F_user[i], v_F[i]
    for i in range(3):
        out[at + 12 + i], out[at + 15 + i] = a_F[i], p_BF[i]
    out[at + 24], out[at + 25], out[at + 26], out[at + 27] = tcp, elbow, gain, mass


@numba.njit(cache=True)
def _truth(
    q, qd, theta, theta_d, tau_J, friction_in, coulomb, viscous, temperature, places, turns, flange, mass, rows, k
) -> None:
    n, out = q.size, rows[k]
    for i in range(n):
        out[i], out[n + i], out[2 * n + i], out[3 * n + i] = q[i], qd[i], theta[i], tau_J[i]
        sign = np.tanh(theta_d[i] / SIGN_SPEED)
        out[4 * n + i] = (friction_in[i] + coulomb[i]) * sign + viscous[i] * qd[i]
        out[5 * n + i] = temperature[i]
    at = 6 * n
    for i in range(3):
        out[at + i] = places[flange, i]
        out[at + 7 + i] = 0.0
    for i in range(4):
        out[at + 3 + i] = turns[flange, i]
    out[at + 10] = mass
