"""A tick as one row of numbers, for recordings: what the controller knew, and the truth; written in place, without garbage."""

import numba
import numpy as np
from numpy.typing import NDArray

from pendant.estimate import Estimate
from sim.plant import SIGN_SPEED, Plant

Array = NDArray[np.float64]


def fill_estimate(e: Estimate, out: Array) -> None:
    """Write the arrays of an estimate into `out` (9 n + 24,).

    In this order: q, qd, qdd, theta, theta_d, tau_m, tau_J, tau_ext, friction (n each); w_sensor, F_user (6 each); a_F, p_BF
    (3 each); v_F (6).
    """
    joints = (e.q, e.qd, e.qdd, e.theta, e.theta_d, e.tau_m, e.tau_J, e.tau_ext, e.friction)
    _fill_estimate(*joints, e.w_sensor, e.F_user, e.a_F, e.p_BF, e.v_F, out)


def fill_truth(plant: Plant, out: Array) -> None:
    """Write the true state into `out` (6 n + 7,).

    In this order: q, qd, theta, tau_J, friction of both sides, temperature (n each); pose of the flange in W (7).
    """
    rubs, data, flange = plant.friction, plant.data, plant.flange_body
    state = (plant.q, plant.qd, plant.theta, plant.theta_d, plant.tau_J, plant.friction_in)
    rest = (rubs.output_coulomb, rubs.output_viscous, plant.temperature, data.xpos, data.xquat)
    _fill_truth(*state, *rest, flange, out)


@numba.njit(cache=True)
def _fill_estimate(q, qd, qdd, theta, theta_d, tau_m, tau_J, tau_ext, friction, w_sensor, F_user, a_F, p_BF, v_F, out) -> None:
    n = q.size
    for i in range(n):
        out[i], out[n + i], out[2 * n + i] = q[i], qd[i], qdd[i]
        out[3 * n + i], out[4 * n + i] = theta[i], theta_d[i]
        out[5 * n + i], out[6 * n + i], out[7 * n + i], out[8 * n + i] = tau_m[i], tau_J[i], tau_ext[i], friction[i]
    for i in range(6):
        out[9 * n + i], out[9 * n + 6 + i], out[9 * n + 18 + i] = w_sensor[i], F_user[i], v_F[i]
    for i in range(3):
        out[9 * n + 12 + i], out[9 * n + 15 + i] = a_F[i], p_BF[i]


@numba.njit(cache=True)
def _fill_truth(q, qd, theta, theta_d, tau_J, friction_in, coulomb, viscous, temperature, places, turns, flange, out) -> None:
    n = q.size
    for i in range(n):
        out[i], out[n + i], out[2 * n + i], out[3 * n + i] = q[i], qd[i], theta[i], tau_J[i]
        sign = np.tanh(theta_d[i] / SIGN_SPEED)
        out[4 * n + i] = (friction_in[i] + coulomb[i]) * sign + viscous[i] * qd[i]
        out[5 * n + i] = temperature[i]
    for i in range(3):
        out[6 * n + i] = places[flange, i]
    for i in range(4):
        out[6 * n + 3 + i] = turns[flange, i]
