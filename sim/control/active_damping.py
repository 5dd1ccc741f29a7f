"""Active damping: free-drive resists motion that comes near a limit on its speed, more and more (FD-12b)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.limits.soft_limits import Damping
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.compiled.kernel import kernel
from sim.compiled.record import record

Array = NDArray[np.float64]

STEEPEST_TCP, STEEPEST_ELBOW, STEEPEST_JOINT = 150.0, 75.0, 60.0
"""Damping over the inertia of the rotors that it acts on, at most [1/s]. All three may act at once, and from 300 in all the delay
of the measurement makes it chatter."""

FALL = 0.15
"""Time constant with which a limit falls [s], so that nobody is braked at a stroke; it rises at once."""

FADE = 0.05
"""Time constant with which the help for the hand follows the speed [s]: too slow to take part in any chatter."""


class ArmMotion(NamedTuple):
    """How the arm moves, n joints, axes of B."""

    speed: Array  # of the motors (n,) [rad/s]
    jacobian: Array  # of the flange (6, n), linear first
    p_BF: Array  # flange (3,) [m]
    tcp: Array  # position, then velocity (6,)
    elbow: Array  # the same (6,)


class DampedPoint(NamedTuple):
    """A point whose speed is limited."""

    p: Array  # (3,) or more [m]
    joints: int  # so many move it
    limit: float  # [m/s]
    steepest: float  # damping over the rotors' inertia, at most [1/s]


class ActiveDamping:
    """Torque against the motion of joints, tool and elbow. It only ever takes energy: it points against the motors' motion.

    Where limits are low, damping as steep as the delay allows does not stop a push; so the help for the hand fades as well.

    Attributes:
        help: share of it that is left.

    Args:
        rated: torque of the joints (n,) [N·m].
        rotor: their inertia referred to the output, as believed (n,) [kg·m²].
        elbow: how many joints move the elbow.
    """

    def __init__(self, rated: Array, rotor: Array, elbow: int) -> None:
        n = rated.size
        self._record = record(
            rated=(n,),
            rotor=(n,),
            elbow="i8",
            how=(3,),  # what is asked: onset, force, torque
            asked=(2 + n,),  # limits of tcp, elbow and each joint
            limits=(2 + n,),  # the same, as they have fallen
        )
        own = self._record[0]
        own["rated"], own["rotor"], own["elbow"], own["limits"] = rated, rotor, elbow, math.inf
        self._asked: tuple[Damping | None, SpeedLimits | None] = (None, None)
        self._how, self._wanted, self._limits = own["how"], own["asked"], own["limits"]
        self.help = 1.0

    def start(self) -> None:
        """Free-drive begins: limits hold at once."""
        self._limits[:] = math.inf
        self.help = 1.0

    def add(self, estimate: Estimate, damping: Damping, limits: SpeedLimits | None, *, jacobian: Array, torque: Array) -> None:
        """Add the resistance to `torque` (n,) [N·m].

        Args:
            estimate: this tick's.
            damping: where it begins, and how strong it is.
            limits: of the robot, which hold as well.
            jacobian: of the flange (6, n), linear first, axes of B.
        """
        if damping is not self._asked[0] or limits is not self._asked[1]:
            self._asked = (damping, limits)
            tcp, elbow, joint, *self._how[:] = damping
            wanted = self._wanted
            wanted[:2], wanted[2:] = (tcp, elbow), joint
            if limits is not None:
                wanted[:2] = np.minimum(wanted[:2], limits[:2])
                wanted[2:] = np.minimum(wanted[2:], limits.joints)
        moving = (estimate.theta_d, jacobian, estimate.p_BF, estimate.tcp, estimate.elbow)
        near = _resist(self._record, moving, torque)
        self.help += TICK / FADE * (1.0 - near - self.help)


@kernel
def _resist(damping, moving, torque) -> float:
    """How near the speed is to a limit: 0 at its onset, 1 at it."""
    moving = ArmMotion(*moving)
    own, speed = damping[0], moving.speed
    asked, limits, rated, rotor = own.asked, own.limits, own.rated, own.rotor
    onset, share = own.how[0], own.how[2]
    for k in range(limits.size):
        falling = limits[k] + TICK / FALL * (asked[k] - limits[k])
        limits[k] = asked[k] if math.isinf(limits[k]) or asked[k] >= limits[k] else falling
    near = 0.0
    for i in range(speed.size):
        width = (1.0 - onset) * limits[2 + i]
        over = abs(speed[i]) - onset * limits[2 + i]
        if over > 0.0:
            torque[i] -= math.copysign(min(share * rated[i] / width, STEEPEST_JOINT * rotor[i]) * over, speed[i])
            near = max(near, over / width)
    at_tcp = _resist_at(own, moving, DampedPoint(moving.tcp, speed.size, limits[0], STEEPEST_TCP), torque)
    at_elbow = _resist_at(own, moving, DampedPoint(moving.elbow, own.elbow, limits[1], STEEPEST_ELBOW), torque)
    return min(max(near, at_tcp, at_elbow), 1.0)


@kernel
def _resist_at(own, arm, point, torque) -> float:
    """A point is damped along its motion. Returns how near it is to its limit."""
    p, moving, limit, steepest = point
    speed, jacobian, p_BF, rotor = arm.speed, arm.jacobian, arm.p_BF, own.rotor
    onset, force = own.how[0], own.how[1]
    x, y, z = p[0] - p_BF[0], p[1] - p_BF[1], p[2] - p_BF[2]
    columns = np.empty((3, moving))
    vx, vy, vz = 0.0, 0.0, 0.0
    for i in range(moving):
        wx, wy, wz = jacobian[3, i], jacobian[4, i], jacobian[5, i]
        columns[0, i] = jacobian[0, i] + wy * z - wz * y
        columns[1, i] = jacobian[1, i] + wz * x - wx * z
        columns[2, i] = jacobian[2, i] + wx * y - wy * x
        vx += columns[0, i] * speed[i]
        vy += columns[1, i] * speed[i]
        vz += columns[2, i] * speed[i]
    fast = math.sqrt(vx * vx + vy * vy + vz * vz)
    over, width = fast - onset * limit, (1.0 - onset) * limit
    if not over > 0.0:
        return 0.0
    mobility = 0.0  # of the point along its motion, of the rotors alone [1/kg]
    for i in range(moving):
        columns[0, i] = (columns[0, i] * vx + columns[1, i] * vy + columns[2, i] * vz) / fast
        mobility += columns[0, i] * columns[0, i] / rotor[i]
    size = min(force / width, steepest / mobility) * over
    for i in range(moving):
        torque[i] -= columns[0, i] * size
    return over / width
