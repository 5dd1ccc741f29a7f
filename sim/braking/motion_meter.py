"""What the robot's limits bound of a motion: speeds of tool and elbow, momentum, and what it takes to come to rest (RL-4).

The momentum is that of all links and of what the flange carries, P = |sum m_k v_k|. An arm that is stopped brakes all joints by
half a cosine, which takes the time T of `sim.motion.moves.stop_time`, and comes to rest after

    t(s) = max(s T, T_0) + r        d(s) = s v (max(s T, T_0) / 2 + r)

with s the share of the present speed, v the speed of tool or elbow, T_0 the shortest stop and r the time until it begins.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.safety.robot_limits import SpeedLimits
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.rigid_body.dynamics import Dynamics
from sim.rigid_body.newton_euler import about, cross, place, turned, turned_back

Array = NDArray[np.float64]


class Braking(NamedTuple):
    """What a stop plans with, n joints."""

    rotor: Array  # inertia referred to the output (n,) [kg·m²]
    torque: Array  # for holding up and braking (n,) [N·m]
    least: Array  # for braking where gravity takes all of that (n,) [N·m]
    shortest: float  # stop [s]
    reaction: float  # until it begins [s]


class MotionMeter:
    """Measures motions against the robot's limits, in one compiled pass over the joints.

    Args:
        dynamics: the rigid model, with the load that is configured.
        tcp: tool centre point in F (3,) [m]; what it holds may change.
        braking: of the arm.

    Attributes:
        record: what the kernels need.
    """

    def __init__(self, dynamics: Dynamics, tcp: Array, braking: Braking) -> None:
        n = braking.rotor.size
        self._rigid, self._tcp = dynamics.recursion.record, tcp
        self.record = record(
            rotor=(n,),
            torque=(n,),
            least=(n,),
            shortest=(),
            reaction=(),
            limits=(len(SpeedLimits._fields) - 1,),  # but those of the joints
            joints=(n,),
            # Of the posture that is looked at: joints and flange in B, and of each link P, L about its joint, mass times centre.
            origins=(n + 1, 3),
            turns=(n + 1, 3, 3),
            linear=(n, 3),
            angular=(n, 3),
            heavy=(n, 3),
        )
        own = self.record[0]
        own["rotor"], own["torque"], own["least"] = braking.rotor, braking.torque, braking.least
        own["shortest"], own["reaction"] = braking.shortest, braking.reaction
        self._bounds, self._joints = own["limits"], own["joints"]
        self._limits: SpeedLimits | None = None

    def over(self, q: Array, qd: Array, limits: SpeedLimits) -> float:
        """By what speeds (n,) must be divided at angles (n,) so that all limits hold; 1 or less where they do."""
        if limits is not self._limits:
            self._limits = limits
            tool, elbow, joints, *others = limits
            self._bounds[:] = tool, elbow, *others
            self._joints[:] = joints or math.inf
        return _over(self.record, self._rigid, (q, qd), self._tcp)


@kernel
def measure(record, rigid, qd, wrench):
    """What `MotionMeasures` has, of the arm as the rigid model's recursion was run in this tick.

    Args:
        record: of a `MotionMeter`.
        rigid: of the recursion.
        qd: speeds of the joints, with which it was run (n,) [rad/s].
        wrench: of the outside on the flange (6,), axes of B [N, N·m].
    """
    own, model = record[0], rigid[0]
    momentum, seconds = _momentum(own, model, (model.origins, model.turns), qd)
    power = 0.0
    for k in range(6):
        power -= wrench[k] * model.v_F[k]
    fastest = max(_size(model.tcp[3], model.tcp[4], model.tcp[5]), _size(model.elbow[3], model.elbow[4], model.elbow[5]))
    length = max(seconds, own.shortest)
    return momentum, max(power, 0.0), length + own.reaction, fastest * (0.5 * length + own.reaction)


@kernel
def _over(record, rigid, motion, tcp):
    own, model = record[0], rigid[0]
    limits, (q, qd) = own.limits, motion
    tool, elbow = _placed(own, model, motion, tcp)
    momentum, seconds = _momentum(own, model, (own.origins, own.turns), qd)
    over = max(tool / limits[0], elbow / limits[1], momentum / limits[2], seconds / (limits[3] - own.reaction))
    for i in range(q.size):
        over = max(over, abs(qd[i]) / own.joints[i])
    fastest = max(tool, elbow)
    if fastest * (0.5 * max(seconds, own.shortest) + own.reaction) > limits[4]:
        # s v (s T / 2 + r) = d where that stop is not the shortest one, else s v (T_0 / 2 + r) = d.
        way, r = limits[4] / fastest, own.reaction
        share = way / (0.5 * own.shortest + r)
        if share * seconds > own.shortest:
            share = (math.sqrt(r * r + 2.0 * seconds * way) - r) / seconds
        over = max(over, 1.0 / share)
    return over


@kernel
def _size(x, y, z):
    return math.sqrt(x * x + y * y + z * z)


@kernel
def _placed(own, rigid, motion, tcp):
    """Where joints and flange are at angles (n,); returns the speeds of tool and elbow [m/s]."""
    q, qd = motion
    n = q.size
    origins, turns = own.origins, own.turns
    behind_p, behind_R = np.zeros(3), np.eye(3)
    w, v, last = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    elbow = 0.0
    for i in range(n + 1):
        place(rigid, i, (behind_p, behind_R), (origins[i], turns[i]))
        behind_p, behind_R = origins[i], turns[i]
        here = (origins[i, 0], origins[i, 1], origins[i, 2])
        whirl = cross(w, (here[0] - last[0], here[1] - last[1], here[2] - last[2]))
        v, last = (v[0] + whirl[0], v[1] + whirl[1], v[2] + whirl[2]), here
        if i == rigid.elbow_joint:
            elbow = _size(v[0], v[1], v[2])
        if i < n:
            c, s = np.cos(q[i]), np.sin(q[i])
            for k in range(3):
                x, y = turns[i, k, 0], turns[i, k, 1]
                turns[i, k, 0], turns[i, k, 1] = c * x + s * y, c * y - s * x
            w = (w[0] + turns[i, 0, 2] * qd[i], w[1] + turns[i, 1, 2] * qd[i], w[2] + turns[i, 2, 2] * qd[i])
    swing = cross(w, turned(turns[n], (tcp[0], tcp[1], tcp[2])))
    return _size(v[0] + swing[0], v[1] + swing[1], v[2] + swing[2]), elbow


@kernel
def _momentum(own, rigid, places, qd):
    """Linear momentum of the arm [kg·m/s], and the time in which the joints can brake [s].

    About the origin of joint i, whose axis is z, all links beyond have the angular momentum L: the joint has z·L and that of its
    rotor.
    """
    origins, turns = places
    n = qd.size
    linear, angular, heavy = own.linear, own.angular, own.heavy
    w, v, last = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in range(n):
        R, at, mass = turns[i], rigid.com[i], rigid.mass[i]
        here = (origins[i, 0], origins[i, 1], origins[i, 2])
        whirl = cross(w, (here[0] - last[0], here[1] - last[1], here[2] - last[2]))
        v, last = (v[0] + whirl[0], v[1] + whirl[1], v[2] + whirl[2]), here
        w = (w[0] + R[0, 2] * qd[i], w[1] + R[1, 2] * qd[i], w[2] + R[2, 2] * qd[i])
        com = turned(R, (at[0], at[1], at[2]))
        moving = cross(w, com)
        spun = turned(R, turned(rigid.inertia[i], turned_back(R, w)))
        P = (mass * (v[0] + moving[0]), mass * (v[1] + moving[1]), mass * (v[2] + moving[2]))
        L = cross(com, P)
        for k in range(3):
            linear[i, k], angular[i, k], heavy[i, k] = P[k], L[k] + spun[k], mass * com[k]
    P, L, S, mass = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0  # of all beyond; S: mass times centre
    worst = 0.0
    for i in range(n - 1, -1, -1):
        if i < n - 1:
            ahead = (
                origins[i + 1, 0] - origins[i, 0],
                origins[i + 1, 1] - origins[i, 1],
                origins[i + 1, 2] - origins[i, 2],
            )
            L, S = about(ahead, (P, L), (S, mass))
        P = (P[0] + linear[i, 0], P[1] + linear[i, 1], P[2] + linear[i, 2])
        L = (L[0] + angular[i, 0], L[1] + angular[i, 1], L[2] + angular[i, 2])
        S = (S[0] + heavy[i, 0], S[1] + heavy[i, 1], S[2] + heavy[i, 2])
        mass += rigid.mass[i]
        weight = cross(rigid.gravity, S)
        turning, holding = own.rotor[i] * qd[i], 0.0
        for k in range(3):
            turning += turns[i, k, 2] * L[k]
            holding += turns[i, k, 2] * weight[k]
        worst = max(worst, abs(turning) / max(own.torque[i] - abs(holding), own.least[i]))
    return _size(P[0], P[1], P[2]), 0.5 * math.pi * worst
