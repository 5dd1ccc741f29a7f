"""A tick as two rows of numbers, for recordings: what the controller knew, and the truth; written in place, without garbage."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.guided.pull import NOT_TOLD, PullCauses
from pendant.tick.estimate import Estimate
from sim.compiled.kernel import kernel
from sim.exchange.true_forces import true_forces
from sim.plant.joint_state import SIGN_SPEED
from sim.plant.true_arm import Plant

Array = NDArray[np.float64]

FLANGE_POSE = 7  # numbers


class RecordedJoints(NamedTuple):
    """Of the estimate, (n,) each."""

    q: Array
    qd: Array
    qdd: Array
    theta: Array
    theta_d: Array
    tau_m: Array
    tau_J: Array
    tau_ext: Array
    friction: Array


class RecordedFlange(NamedTuple):
    """Of the estimate, at the flange."""

    w_sensor: Array
    F_user: Array
    v_F: Array
    a_F: Array
    p_BF: Array


class RecordedPlace(NamedTuple):
    """Where MuJoCo's bodies are in W, which of them the flange is, and what is attached to it."""

    positions: Array
    orientations: Array
    flange: int
    mass: float  # [kg]


def fill_rows(
    e: Estimate, plant: Plant, *, gain: float, configured: float, pull: PullCauses | None, known: Array, truth: Array, k: int
) -> None:
    """Write an estimate into row k of `known` (m, 9 n + 33 or more), the true state into row k of `truth` (m, 6 n + 14).

    Known, in this order: q, qd, qdd, theta, theta_d, tau_m, tau_J, tau_ext, friction (n each); w_sensor, F_user (6 each); a_F,
    p_BF (3 each); v_F (6); speeds of tcp and elbow, `gain` on the user's force, mass `configured`; of the `pull`
    who is felt, odds and share of a lost payload, odds of a step of the sensor: not a number where they are not known; the force
    on a link that the joints tell.

    Truth: q, qd, theta, tau_J, friction of both sides, temperature (n each); pose of the flange in W (7); sum of the hands'
    forces in W (3); mass of what is attached; 1 while anything is touched; forces on the tool and on a link.
    """
    joints = (e.q, e.qd, e.qdd, e.theta, e.theta_d, e.tau_m, e.tau_J, e.tau_ext, e.friction)
    flange = (e.w_sensor, e.F_user, e.v_F, e.a_F, e.p_BF)
    _known(joints, flange, (e.v_tcp, e.v_elbow, gain, configured, *_numbers(pull), e.link_force.force), known[k])
    place = (*plant.frames, plant.flange_body, plant.payload.load.mass)
    _truth(plant.record, plant.friction.record, place, truth[k])
    row = truth[k]
    at = 6 * e.q.size + FLANGE_POSE
    row[at + 4] = plant.touched
    row[at + 5], row[at + 6] = true_forces(plant)
    for _, _, (x, y, z), _ in plant.hands.touched:
        row[at] += x
        row[at + 1] += y
        row[at + 2] += z


def _numbers(pull: PullCauses | None) -> tuple[float, float, float, float]:
    """Of a pull: who is felt, then what is compared. Infinite odds would spoil the axes of every plot."""
    if pull is None:
        return math.nan, math.nan, math.nan, math.nan
    share = math.nan if pull.doubt == NOT_TOLD else pull.lost_share
    return float(pull.felt), _or_nan(pull.lost_odds), share, _or_nan(pull.step_odds)


def _or_nan(odds: float) -> float:
    return math.nan if odds == NOT_TOLD else odds


@kernel
def _known(joints, flange, numbers, out) -> None:
    joints = RecordedJoints(*joints)
    flange = RecordedFlange(*flange)
    q, qd, qdd, theta, theta_d, tau_m, tau_J, tau_ext, friction = joints
    n = q.size
    for i in range(n):
        out[i], out[n + i], out[2 * n + i] = q[i], qd[i], qdd[i]
        out[3 * n + i], out[4 * n + i] = theta[i], theta_d[i]
        out[5 * n + i], out[6 * n + i], out[7 * n + i], out[8 * n + i] = tau_m[i], tau_J[i], tau_ext[i], friction[i]
    at = 9 * n
    for i in range(6):
        out[at + i], out[at + 6 + i], out[at + 18 + i] = flange.w_sensor[i], flange.F_user[i], flange.v_F[i]
    for i in range(3):
        out[at + 12 + i], out[at + 15 + i] = flange.a_F[i], flange.p_BF[i]
    for i in range(len(numbers)):
        out[at + 24 + i] = numbers[i]


@kernel
def _truth(plant, friction, place, out) -> None:
    place = RecordedPlace(*place)
    own, rubs = plant[0], friction[0]
    n = own.q.size
    for i in range(n):
        out[i], out[n + i], out[2 * n + i], out[3 * n + i] = own.q[i], own.qd[i], own.theta[i], own.tau_J[i]
        sign = np.tanh(own.theta_d[i] / SIGN_SPEED)
        out[4 * n + i] = (own.friction_in[i] + rubs.output_coulomb[i]) * sign + rubs.output_viscous[i] * own.qd[i]
        out[5 * n + i] = own.temperature[i]
    at = 6 * n
    for i in range(3):
        out[at + i] = place.positions[place.flange, i]
        out[at + 7 + i] = 0.0
    for i in range(4):
        out[at + 3 + i] = place.orientations[place.flange, i]
    out[at + 10] = place.mass
