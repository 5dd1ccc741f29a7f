"""Mass and centre of what the arm carries, from wrist postures in which it stands, with their uncertainty.

At rest the flange exerts on what it carries, in F,

    f = m a + b_f,    t = h x a + b_t,    h = m c,    a = -R_BF^T g

with the sensor's offsets b. Both are linear: least squares over the postures give (m, b_f) and (h, b_t), and their residuals
give the standard uncertainties (GUM, type A). The scale of the sensor cannot show in its own readings; its uncertainty is added.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.equipment.load import Load
from pendant.tick.pose import ORIGIN, Vector

LEAST = 4
"""Least number of postures, as on a UR."""

SPREAD = 0.2
"""Least spread of the directions of gravity across their main one, root mean square of the sine: below it the centre of mass
along that direction cannot be told from an offset."""

MISFIT_FORCE, MISFIT_TORQUE = 1.0, 0.15
"""Largest residual [N], [N·m], root mean square: twice what a gain error of 1 % leaves of a full payload."""

GAIN = 0.006
"""Standard uncertainty of the sensor's scale: an error of 1 % at most, all of them equally likely."""

LIGHT = 0.1
"""Mass of a load below which its centre cannot be found [kg]."""

TOLERATED = 0.1
"""A fitted mass may be negative by at most this plus three standard uncertainties; then it is set to 0 [kg]."""


class Posture(NamedTuple):
    """What was measured in one posture, means over its time, in F."""

    a: Vector  # specific force: against gravity [m/s²]
    force: Vector  # of the flange on what it carries, as the sensor has it [N]
    torque: Vector  # at the flange origin [N·m]


class FittedPayload(NamedTuple):
    """The load beyond the known one, fitted to the postures, with standard uncertainties."""

    mass: float  # [kg]
    mass_deviation: float  # [kg]
    centre: Vector  # in F [m]
    centre_deviation: float  # of the axis known worst; 0 where the load is too light to have a centre [m]
    force_fit: float  # residual, root mean square [N]
    torque_fit: float  # [N·m]
    force_offset: Vector  # of the sensor, in F [N]
    torque_offset: Vector  # [N·m]
    postures: int

    @property
    def load(self) -> Load:
        """The load to configure."""
        return Load(mass=round(self.mass, 3), com=[round(x, 4) for x in self.centre])


def least_angle(count: int) -> float:
    """Least angle between the directions of gravity of any two of `count` postures [rad]: pi / (2 n), as on a UR."""
    return math.pi / (2 * max(count, LEAST))


def nearest(postures: Sequence[Posture], a: Vector) -> tuple[int, float]:
    """The posture whose direction of gravity in the flange is nearest to that of `a`: its number from 1, the angle [rad].

    Turning the arm about the vertical changes nothing that a force sensor could feel, so it is no other posture here.
    """
    angles = [_angle(posture.a, a) for posture in postures]
    number = min(range(len(angles)), key=angles.__getitem__)
    return number + 1, angles[number]


def _angle(a: Vector, b: Vector) -> float:
    cross = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return math.atan2(math.hypot(*cross), a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def solve(postures: Sequence[Posture], known: Sequence[Load] = ()) -> FittedPayload | str:
    """Mass and centre of what is carried beyond the `known` loads; or why they cannot be told, in a line.

    Args:
        postures: measured.
        known: loads in F that the sensor feels too: its own plate, the tool.
    """
    if len(postures) < LEAST:
        return f"{len(postures)} of at least {LEAST} postures"
    a = np.array([posture.a for posture in postures])
    spread = _spread(a)
    if spread < SPREAD:
        return f"the postures differ too little across one direction: {spread:.2f}, at least {SPREAD:.2f}; turn another wrist"
    count = len(postures)
    cross = _cross_matrices(a)
    force = np.array([posture.force for posture in postures])
    torque = np.array([posture.torque for posture in postures])
    for load in known:
        force = force - load.mass * a
        torque = torque - np.cross(np.array(load.com) * load.mass, a)
    offsets = np.tile(np.eye(3), (count, 1))
    (mass, *b_f), C_f, force_fit = _fit(np.hstack([a.reshape(-1, 1), offsets]), force.ravel())
    (*h, b_x, b_y, b_z), C_t, torque_fit = _fit(np.hstack([cross.reshape(-1, 3), offsets]), torque.ravel())
    if force_fit > MISFIT_FORCE or torque_fit > MISFIT_TORQUE:
        said = f"{force_fit:.2f} N, {torque_fit:.3f} N·m, at most {MISFIT_FORCE:g} N, {MISFIT_TORQUE:g} N·m"
        return f"no rigid load reads like this: residuals {said}; hands off, begin again"
    mass_deviation = math.sqrt(float(C_f[0, 0]) + (GAIN * mass) ** 2)
    if mass < -(TOLERATED + 3.0 * mass_deviation):
        return f"{-mass:.2f} kg less than the tool in use: choose the tool that is mounted"
    centre, centre_deviation = ORIGIN, 0.0
    if mass >= LIGHT:
        c = np.array(h) / mass
        centre = (float(c[0]), float(c[1]), float(c[2]))
        variances = np.diag(C_t)[:3] / mass**2 + (c * mass_deviation / mass) ** 2
        centre_deviation = math.sqrt(float(variances.max()))
    return FittedPayload(
        max(mass, 0.0),
        mass_deviation,
        centre,
        centre_deviation,
        force_fit,
        torque_fit,
        (b_f[0], b_f[1], b_f[2]),
        (b_x, b_y, b_z),
        count,
    )


def _spread(a: NDArray[np.float64]) -> float:
    """Root mean square of the sine between directions of gravity and the line that they lie nearest to, their mean taken off."""
    unit = a / np.linalg.norm(a, axis=1, keepdims=True)
    values = np.linalg.eigvalsh(np.cov(unit.T, bias=True))
    return math.sqrt(max(float(values[0] + values[1]), 0.0))


def _cross_matrices(a: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrices (n, 3, 3) whose product with h is h x a."""
    x, y, z = a.T
    nothing = np.zeros_like(x)
    rows = [[nothing, z, -y], [-z, nothing, x], [y, -x, nothing]]
    return np.moveaxis(np.array(rows), 2, 0)


def _fit(A: NDArray[np.float64], b: NDArray[np.float64]) -> tuple[list[float], NDArray[np.float64], float]:
    """Least squares: the unknowns, their covariance from the residuals, and the residuals' root mean square."""
    x = np.linalg.lstsq(A, b, rcond=None)[0]
    square = float(np.sum((A @ x - b) ** 2))
    freedom = A.shape[0] - A.shape[1]
    return x.tolist(), np.linalg.inv(A.T @ A) * (square / freedom), math.sqrt(square / A.shape[0])
