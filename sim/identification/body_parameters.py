"""A rigid body as the ten numbers in which its torques are linear, in Pinocchio's order.

    mass, mass times centre (3), then ixx ixy iyy ixz iyz izz about the origin of the frame it is given in.

Source: Atkeson, An, Hollerbach, Estimation of inertial parameters of manipulator loads and links, IJRR 5(3), 1986.
"""

import numpy as np
from numpy.typing import NDArray

from sim.arm.chain import Body
from sim.arm.frames import skew

Array = NDArray[np.float64]

PARAMETERS = 10
LEAST_SHARE = 1e-5
"""Of the largest axis of a pseudo-inertia: a published body may be as thin as a disc."""
_ROWS, _COLUMNS = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]  # of the six moments


def parameters_of(body: Body) -> Array:
    """The ten numbers (10,) of a body, in the frame that it is given in."""
    shift = skew(body.com)
    about = body.inertia - body.mass * shift @ shift
    return np.array([body.mass, *(body.mass * body.com), *about[_ROWS, _COLUMNS]])


def body_of(values: Array) -> Body:
    """The body of ten numbers (10,), whose mass is not 0."""
    mass, com = float(values[0]), values[1:4] / values[0]
    shift = skew(com)
    return Body(mass, com, _matrix(values[4:]) + mass * shift @ shift)


def moved(values: Array, R: Array, p: Array) -> Array:
    """The ten numbers (10,) of the same body in another frame, in which the frame that they are given in stands at `p`, `R`."""
    mass, moment = values[0], R @ values[1:4]
    step, turned = skew(p), skew(moment)
    about = R @ _matrix(values[4:]) @ R.T - step @ turned - turned @ step - mass * step @ step
    return np.array([mass, *(moment + mass * p), *about[_ROWS, _COLUMNS]])


def is_body(values: Array) -> bool:
    """Whether a body of positive mass everywhere can have these ten numbers (10,).

    The pseudo-inertia [[tr(I)/2 1 - I, h], [h', m]] is positive definite then, and only then.

    Source: Wensing, Kim, Slotine, Linear matrix inequalities for physically consistent inertial parameter identification, IEEE
    Robotics and Automation Letters 3(1), 2018.
    """
    return bool(np.linalg.eigvalsh(_pseudo_inertia(values))[0] > 0.0)


def distance(values: Array) -> Array:
    """The quadratic form D (10, 10) of how far a body is from this one: d² = x' D x for a step x of the ten numbers.

    d² = tr((P^-1 dP)²) / 2 of the pseudo-inertia P: the same in any frame and unit, relative to the body's own mass and size.
    A step with d < 0.7 always ends at a body.

    Source: Lee, Wensing, Park, Geometric robot dynamic identification: a convex programming approach, IEEE Transactions on
    Robotics 36(2), 2020.
    """
    size, axes = np.linalg.eigh(_pseudo_inertia(values))
    inverse = axes / np.maximum(size, LEAST_SHARE * size[-1]) @ axes.T
    steps = [inverse @ _pseudo_inertia(unit) for unit in np.eye(PARAMETERS)]
    return np.array([[0.5 * np.trace(a @ b) for b in steps] for a in steps])


def _pseudo_inertia(values: Array) -> Array:
    about = _matrix(values[4:])
    pseudo = np.zeros((4, 4))
    pseudo[:3, :3] = 0.5 * np.trace(about) * np.eye(3) - about
    pseudo[:3, 3] = pseudo[3, :3] = values[1:4]
    pseudo[3, 3] = values[0]
    return pseudo


def _matrix(six: Array) -> Array:
    matrix = np.zeros((3, 3))
    matrix[_ROWS, _COLUMNS] = six
    matrix[_COLUMNS, _ROWS] = six
    return matrix
