"""How near the arm is to a singularity: the smallest singular value of its Jacobian, and where it grows (FD-4)."""

import math

import numpy as np
from numpy.typing import NDArray

from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.rigid_body.cholesky import factor, solve

Array = NDArray[np.float64]

LENGTH = 0.2
"""A turn counts as the way of a point so far off [m]."""

FLOOR = 1e-8
"""Added to the matrix that is inverted [m²], so that it has an inverse in a singularity, too."""

SMALLEST = 1e-5
"""Below this value its gradient is nowhere [m]."""

STEEPEST = 150.0
"""Damping towards a singularity over the inertia of the rotors that it acts on, at most [1/s]."""

EASED = 0.3
"""Below this share of `too_near` the resistance ends: in the singularity itself the way on is the way back."""

ITERATIONS = 3
"""Of the inverse iteration in an update; the direction found lives on, and turns slowly."""

WATCHED = 5
"""Ticks between two looks where nothing but a picture needs the value, which changes with the posture only."""


class Singularity:
    """Follows the direction in which the flange is hardest to move.

    Attributes:
        value: smallest singular value of the flange's Jacobian, turns as ways [m]; infinite for arms of fewer than six joints.
        gradient: of the value by the joint angles (n,) [m/rad].

    Source: inverse iteration on J J^T; the derivative of a singular value is u^T dJ v.
    """

    def __init__(self, rotor: Array) -> None:
        """`rotor`: inertia of the joints' rotors (n,) [kg·m²]."""
        self.value = math.inf
        self._record = record(gradient=rotor.shape, rotor=rotor.shape)
        self._record["rotor"] = rotor
        self.gradient = self._record["gradient"][0]
        self._u = np.full(6, 1.0 / math.sqrt(6.0))

    def forget(self) -> None:
        """Nothing is known of the posture."""
        self.value = math.inf

    def update(self, jacobian: Array) -> None:
        """One tick. `jacobian`: of the flange (6, n), linear first."""
        if self.gradient.size >= 6:
            self.value = _smallest(jacobian, self._u, self.gradient)

    def watch(self, jacobian: Array, tick: int) -> None:
        """One tick in which how near it is is merely told."""
        if tick % WATCHED == 0:
            self.update(jacobian)

    def resist(self, near: float, too_near: float, *, speed: Array, static: Array, torque: Array) -> None:
        """Resist motion towards the singularity: damp it, and take away what drives it on. The way back is free.

        Args:
            near: value below which it begins [m].
            too_near: value below which nothing is left of what drives it on [m].
            speed: of the motors (n,) [rad/s].
            static: torque (n,) [N·m] that drives nothing: gravity, walls, ends of ranges.
            torque: (n,) [N·m] all that the law asks for; changed in place.
        """
        if self.value < near:
            share = min((near - self.value) / (near - too_near), self.value / (EASED * too_near), 1.0)
            _resist(self._record, share, speed, (static, torque))


@kernel
def _resist(singularity, share, speed, torques) -> None:
    gradient, rotor = singularity[0].gradient, singularity[0].rotor
    static, torque = torques
    mobility, rate, driven = 0.0, 0.0, 0.0
    for i in range(torque.size):
        mobility += gradient[i] * gradient[i] / rotor[i]
        rate += gradient[i] * speed[i]
        driven += gradient[i] * (torque[i] - static[i]) / rotor[i]
    if mobility == 0.0:
        return
    size = STEEPEST * min(rate, 0.0) + min(driven, 0.0)
    for i in range(torque.size):
        torque[i] -= share * size * gradient[i] / mobility


@kernel
def _smallest(jacobian, u, gradient) -> float:
    n = gradient.size
    scaled = np.empty((6, n))
    for k in range(3):
        for i in range(n):
            scaled[k, i], scaled[3 + k, i] = jacobian[k, i], LENGTH * jacobian[3 + k, i]
    a = np.empty((6, 6))
    for j in range(6):
        for k in range(j + 1):
            total = FLOOR if j == k else 0.0
            for i in range(n):
                total += scaled[j, i] * scaled[k, i]
            a[j, k] = total
    factor(a, 6)
    # A little of every direction stays in play: what has become the smallest is found however it lies.
    for k in range(6):
        u[k] += 1e-3 if k % 2 else -1e-3
    for _ in range(ITERATIONS):
        solve(a, u, 6)
        size = 0.0
        for k in range(6):
            size += u[k] * u[k]
        size = math.sqrt(size)
        for k in range(6):
            u[k] /= size
    return _grows(jacobian, scaled, u, gradient)


@kernel
def _grows(jacobian, scaled, u, gradient) -> float:
    """The singular value of the direction u, and its gradient."""
    n = gradient.size
    v = np.zeros(n)
    square = 0.0
    for i in range(n):
        for k in range(6):
            v[i] += u[k] * scaled[k, i]
        square += v[i] * v[i]
        gradient[i] = 0.0
    value = math.sqrt(square)
    if value < SMALLEST:
        return value
    for i in range(n):
        for j in range(n):
            # How column j changes as joint i turns: the joints after i are carried around with all they have, those before i see
            # the flange move.
            first, axis = (j, i) if i <= j else (i, j)
            lx, ly, lz = jacobian[0, first], jacobian[1, first], jacobian[2, first]
            wx, wy, wz = jacobian[3, axis], jacobian[4, axis], jacobian[5, axis]
            along = u[0] * (wy * lz - wz * ly) + u[1] * (wz * lx - wx * lz) + u[2] * (wx * ly - wy * lx)
            if i <= j:
                ax, ay, az = jacobian[3, j], jacobian[4, j], jacobian[5, j]
                turned = u[3] * (wy * az - wz * ay) + u[4] * (wz * ax - wx * az) + u[5] * (wx * ay - wy * ax)
                along += LENGTH * turned
            gradient[i] += along * v[j] / value
    return value
