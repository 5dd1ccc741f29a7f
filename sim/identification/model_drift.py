"""Where an arm would be by its model, had that gone on its own for a short time: what the model does not explain, as an angle."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from pendant.tick.modes import TICK
from sim.estimation.adaptive_friction import GATE
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

HORIZON = 0.3
"""For which the model goes on its own [s]: a torque of a tenth of what an arm weighs moves it by centimetres then, so it can be
seen; in a longer time the arms would be so far apart that the model would have another weight to bear."""


class ModelDrift:
    """How far n joints of the model part from those measured, moved by the measured torques over `HORIZON`.

    The model is begun at the measured angles and speeds of `HORIZON` ago. To first order it parts from what was measured by

        M(q) d'' = r,    so    d(t) = M^-1 integral from t - HORIZON to t of (t - s) r(s) ds

    with M of links and rotors, and r what the model leaves of the measured torque; of a joint that stands, what is more than
    friction at rest may hold.

    Args:
        dynamics: rigid model.
        rotor: inertias of the rotors, referred to the output (n,) [kg·m²].
    """

    def __init__(self, dynamics: Dynamics, rotor: Array) -> None:
        self._dynamics, self._rotor = dynamics, np.diag(rotor)
        count = round(HORIZON / TICK)
        self._weights = TICK * TICK * np.arange(1.0, count + 1.0)
        self._before = np.zeros((count - 1, len(rotor)))

    def begin(self) -> None:
        """A stretch begins: what was before it counts no more."""
        self._before[:] = 0.0

    def add(self, left: Array, driven: Array, speed: Array, *, holds: Array) -> Array:
        """Take in k ticks; returns the integral (k, n) [N·m·s²].

        Args:
            left: what the model leaves of the torques, its friction included (k, n) [N·m].
            driven: the same without friction (k, n) [N·m].
            speed: of the joints (k, n) [rad/s].
            holds: what friction at rest may hold (n,) [N·m].
        """
        beyond = np.sign(driven) * np.maximum(np.abs(driven) - holds, 0.0)
        torque = np.where(np.abs(speed) > GATE, left, beyond)
        out, self._before = lfilter(self._weights, 1.0, torque, axis=0, zi=self._before)
        return out

    def angles(self, q: Array, integral: Array) -> Array:
        """By how much the model's angles are beside measured ones q (m, n) [rad], by the integral there (m, n)."""
        mass = self._dynamics.mass
        return np.array([np.linalg.solve(mass(here) + self._rotor, each) for here, each in zip(q, integral, strict=True)])
