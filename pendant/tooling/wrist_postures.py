"""Which wrist posture to measure next: the one in which gravity lies farthest, in the flange, from those that are measured."""

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pendant.equipment.payload_fit import least_angle
from pendant.tick.pose import Vector
from pendant.tooling.arm_shape import ArmShape
from pendant.tooling.wrist_room import WRIST

Array = NDArray[np.float64]

WANTED = 6
"""Postures that the wizard turns to, the first one included: two more than are needed."""

SWING = math.radians(60.0)
"""Farthest that a joint of the wrist is turned from where the wizard begins."""

STEPS = 5
"""Angles that are tried of each joint, from one end of the swing to the other."""

FINE = 0.05
"""Gains of less count as equal [rad]: the shorter way is taken then."""


def candidates(begin: Array) -> Array:
    """Postures (m, n) round the one where the wizard begins (n,) [rad]."""
    turns = list(itertools.product(np.linspace(-SWING, SWING, STEPS).tolist(), repeat=WRIST))
    postures = np.tile(begin, (len(turns), 1))
    postures[:, -WRIST:] += np.array(turns)
    return postures


def best_first(shape: ArmShape, postures: Array, now: Array, g_B: Array, *, measured: Sequence[Vector]) -> Array:
    """The postures that are of use beside those measured, the best first.

    Args:
        shape: of the arm.
        postures: to choose from (m, n) [rad].
        now: where the arm is (n,) [rad].
        g_B: gravity in B (3,) [m/s²].
        measured: specific force in F in each posture that is measured, one at least [m/s²].
    """
    against = -g_B @ shape.places(postures)[1][:, -1]  # in F
    against /= np.linalg.norm(against, axis=1, keepdims=True)
    known = np.array(measured)
    known /= np.linalg.norm(known, axis=1, keepdims=True)
    away = np.arccos(np.clip(against @ known.T, -1.0, 1.0)).min(axis=1)
    ways = np.abs(postures - now).max(axis=1)
    order = np.lexsort((ways, -np.round(away / FINE)))
    return postures[order[away[order] >= least_angle(WANTED) + FINE]]
