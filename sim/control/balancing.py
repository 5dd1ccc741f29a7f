"""Balancing a refused arm: the gravity torque adapts to a load that nobody told of, while it moves the arm (FD-10)."""

import math

import numpy as np
from numpy.typing import NDArray

from pendant.freedrive.adaptive_gravity import Balance
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import TICK

Array = NDArray[np.float64]

TIME = 0.05
"""Time constant of the adaptation [s]: slow against the arm's own swinging at 5 Hz and more, which the measurement includes."""

DAMPING = 120.0
"""Damping over the inertia of the rotors [1/s]; from 300 on the delay of the measurement makes it chatter."""

STIFFNESS = 3000.0
"""Torque for the way of a joint over the inertia of its rotor, without the flange's sensor [1/s²]: with the damping it does not
swing."""

STILL, MOVING = 0.005, 0.02
"""Speed of a joint up to which nothing adapts, and from which on it adapts in full [rad/s]."""

ARM = 0.2
"""Lever of the largest torque at the flange, with the weight of the largest payload [m]."""


class Balancing:
    """Torque on top of that of the configured payload.

    It begins with what the motors bear already, so that nothing jumps, and adapts to the load that the flange's sensor feels, but
    only while that load moves the arm: the power of what is not balanced yet must be positive. So it cannot push at what the arm
    rests on, nor at a hand that holds it; and when a hand that it took for a payload lets go, it goes back.

    Without that sensor it grows with the way of each joint instead: what the joints feel is too coarse, and what they have borne
    for long they take for an error of their own.

    A load F moves the flange by about F TIME / D before it is balanced, with the damping D = DAMPING x the rotors' inertia at the
    flange: the impulse of the load that is not balanced yet is F TIME, and the damping must take it all. Friction makes it less.

    Attributes:
        torque: (n,) [N·m]; kept at the end for whoever holds the arm then.

    Args:
        rated: torque of the joints (n,) [N·m].
        rotor: their inertia referred to the output, as believed (n,) [kg·m²].
        payload: the largest [kg].
    """

    def __init__(self, rated: Array, rotor: Array, payload: float) -> None:
        self._rated, self._damping, self._stiffness = rated, DAMPING * rotor, STIFFNESS * rotor
        self._force = GRAVITY * payload
        self._begun = False
        self.torque = np.zeros(rated.size)

    def start(self) -> None:
        """Free-drive begins."""
        self._begun = False
        self.torque[:] = 0.0

    def add(self, estimate: Estimate, balance: Balance, jacobian: Array, torque: Array) -> None:
        """Add it to `torque` (n,) [N·m], what else the free-drive law asks for.

        Args:
            estimate: this tick's.
            balance: what is known of the load.
            jacobian: of the flange (6, n), linear first, axes of B.
        """
        own, speed = self.torque, estimate.theta_d
        if not self._begun:
            self._begun = True
            own[:] = estimate.tau_m - torque
        if balance.force:
            missing = self._load(estimate, balance, jacobian) - own
            if float(missing @ speed) < 0.0:
                fast = (float(np.abs(speed).max()) - STILL) / (MOVING - STILL)
                own += TICK / TIME * min(max(fast, 0.0), 1.0) * missing
        else:
            own -= TICK * self._stiffness * speed
        np.clip(own, -self._rated, self._rated, out=own)
        torque += own
        torque -= self._damping * speed

    def _load(self, estimate: Estimate, balance: Balance, jacobian: Array) -> Array:
        """What would balance the load (n,) [N·m]: a force along gravity, and the torque across it that goes with it."""
        up, force, torque = np.array(balance.up), estimate.F_user[:3], estimate.F_user[3:]
        along = min(max(float(force @ up), -self._force), self._force)
        across = torque - float(torque @ up) * up
        size = math.sqrt(float(across @ across))
        if size > ARM * self._force:
            across *= ARM * self._force / size
        return -(along * (up @ jacobian[:3]) + across @ jacobian[3:])
