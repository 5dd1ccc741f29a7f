"""What may stop an arm: a force on a link, how far it is from its reference, and how it moves (RL-1, RL-3, RL-4).

All in one kernel: to call one takes as long as all that it does here.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.estimate import NO_LINK_FORCE, ON_PATH, Estimate, FollowingError, LinkForce, MotionMeasures
from sim.arm.arm_file import Arm
from sim.braking.motion_meter import MotionMeter, measure
from sim.collisions.hit_parts import hit_parts, hit_shapes
from sim.collisions.link_force import link_force
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.momentum_observer import MomentumObserver
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.sensors import Sample

Array = NDArray[np.float64]

END = 0.95  # share of the flange sensor's range from which its value may be less than what is there


class ArmSeen(NamedTuple):
    """What a tick tells, as in `Estimate`."""

    clipped: bool
    link_force: LinkForce
    following: FollowingError
    motion: MotionMeasures


class ArmWatch:
    """Watches what the joints feel that the flange sensor does not, without it all of it, whether the arm is on its path, and
    what the robot's limits bound of its motion.

    Args:
        dynamics: the controller's rigid model, whose recursion has been run in this tick.
        momentum: external torques of this tick.
        arm: its sensors with their ranges, and its shapes.
        meter: of the arm's motion.
        following: largest error of the joints against their reference (n,) [rad].
    """

    def __init__(
        self,
        dynamics: Dynamics,
        momentum: MomentumObserver,
        arm: Arm,
        *,
        meter: MotionMeter,
        following: Array,
    ) -> None:
        self._momentum, self._elbow = momentum, arm.chain.elbow
        self._own = record(range=(6,), zero=(6,), following=(following.size,))
        self._models = self._own, meter.record, dynamics.recursion.record, momentum.record, momentum.errors.record
        self._shapes = hit_shapes(arm)
        own, flange = self._own[0], arm.sensors.force_torque
        own["range"], own["following"] = np.inf, following
        if flange is not None:
            own["range"][:3], own["range"][3:] = END * flange.force.range, END * flange.torque.range

    def set_zero(self, zero: Array) -> None:
        """So much (6,) is subtracted from the flange sensor's values [N, N·m]."""
        self._own[0]["zero"] = zero

    def read(self, sample: Sample, estimate: Estimate, wanted: Array | None, *, free: bool) -> ArmSeen:
        """What is watched; no force in free-drive, where a hand may push at any link, nor while the observer
        has just begun, for it may be an error.

        Args:
            sample: this tick's measurements, of which the zero has been taken.
            estimate: this tick's estimate.
            wanted: angles of the reference that this measurement answers to (n,) [rad]; None: nothing says where it should be.
            free: the arm is in free-drive.
        """
        feels, q = self._momentum.ready and not free, estimate.q
        felt = (sample.wrench, estimate.F_user, q, q if wanted is None else wanted, estimate.qd)
        force, parts, clipped, error, motion = _watch(self._models, self._shapes, (self._elbow, feels), felt)
        link = NO_LINK_FORCE if force[0] < 0 else LinkForce(*force, parts=parts)
        following = ON_PATH if wanted is None else FollowingError(*error)
        return ArmSeen(clipped and sample.wrench_valid, link, following, MotionMeasures(*motion))


@kernel
def _watch(models, shapes, state, felt):
    """Force on a link and its parts, whether the flange sensor is at the end of its range, following error, and motion."""
    elbow, feels = state
    sensed, outside, q, wanted, qd = felt
    own, rigid = models[0][0], models[2][0]
    force, parts, clipped = (-1, 0.0, 0.0, 0), (0.0, 0.0, 0.0), False
    if feels:
        force = link_force(models[2:], elbow)
        if force[0] >= 0:
            parts = hit_parts(models[2:], shapes, force[1])
        for k in range(6):
            clipped |= abs(sensed[k] + own.zero[k]) >= own.range[k]
    error = _following_error(own.following, wanted, q, (rigid.jacobian, rigid.p, rigid.tcp))
    return force, parts, clipped, error, measure(models[1], models[2], qd, outside)


@kernel
def _following_error(limits, wanted, q, arm) -> tuple[int, float, float, float, float]:
    """How far the arm is from where it should be: see `pendant.tick.estimate.FollowingError`.

        error at the tool = J_tcp (q_wanted - q)

    Args:
        limits: of each joint (n,) [rad].
        wanted: output angles of the reference that this measurement answers to (n,) [rad].
        q: output angles measured (n,) [rad].
        arm: Jacobian of the flange (6, n), its position (3,) and the tool centre point's (3,) or more [m], axes of B.
    """
    jacobian, flange, tcp = arm
    x, y, z = tcp[0] - flange[0], tcp[1] - flange[1], tcp[2] - flange[2]
    joint, angle, share = 0, 0.0, 0.0
    ex, ey, ez = 0.0, 0.0, 0.0
    for i in range(q.size):
        error = wanted[i] - q[i]
        part = abs(error) / limits[i]
        if part > share or part != part:  # what is no number is too far, and stays so
            joint, angle, share = i, abs(error), part
        wx, wy, wz = jacobian[3, i], jacobian[4, i], jacobian[5, i]
        ex += (jacobian[0, i] + wy * z - wz * y) * error
        ey += (jacobian[1, i] + wz * x - wx * z) * error
        ez += (jacobian[2, i] + wx * y - wy * x) * error
    return joint, angle, limits[joint], share, math.sqrt(ex * ex + ey * ey + ez * ez)
