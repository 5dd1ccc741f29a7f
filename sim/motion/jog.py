"""The reference of a jogged arm: one joint, or the tool along or about one axis, at manual speed and no further than it can."""

import math

import numpy as np
from numpy.typing import NDArray

from pendant.program.jog_move import TURNS, JogMove, MoveStraight, MoveThere
from pendant.program.steps import Move
from pendant.robot.reduced import SpeedLimits
from pendant.tick.modes import TICK
from sim.braking.workspace_keeper import WorkspaceKeeper
from sim.motion.line import Line
from sim.motion.moves import MoveRefused, Reference
from sim.motion.pace import SHARE, Pace
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

MANUAL = 0.25
"""Of tool and elbow at most [m/s]: reduced speed of manual control (ISO 10218-1:2011, 5.7.3)."""

LINE_ACCELERATION, TURN_SPEED, TURN_ACCELERATION = 0.5, 0.5, 1.0
"""Of the tool [m/s²], [rad/s], [rad/s²]."""

JOINT_SHARE = 0.25
"""Of a joint's speed and acceleration."""

LOOK_TICKS = 5  # between looks for a singularity
ENDED = 1e-5  # nearer than this it is there [m or rad]


def at_manual_speed(move: Move | None, limits: SpeedLimits | None) -> SpeedLimits | None:
    """The limits for a move: a button that is held allows manual speed at most, whatever REDUCED has."""
    if not isinstance(move, MoveThere | MoveStraight):
        return limits
    return (
        SpeedLimits(MANUAL, MANUAL, math.inf)
        if limits is None
        else SpeedLimits(min(MANUAL, limits.tcp), min(MANUAL, limits.elbow), limits.joint)
    )


class JogTrajectory:
    """Speeds up to manual speed; slows down before its length and before the end of a joint's range, and stops there.

    Args:
        q: where the reference is, at rest (n,) [rad].
        move: what is jogged.
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m].
        R_FT: orientation of the tool in F (3, 3).
        limits: the joints' speed, acceleration and position (±), each (n,).

    Attributes:
        done: its length is reached.
        problem: why it cannot go on, or "".

    Raises:
        MoveRefused: the tool cannot go everywhere from here.
    """

    def __init__(
        self, q: Array, move: JogMove, dynamics: Dynamics, *, tcp: Array, R_FT: Array, limits: tuple[Array, Array, Array]
    ) -> None:
        self._q, self._qd = q.copy(), np.zeros_like(q)
        self._speed_limits, self._acceleration_limits, self._position = limits
        self._pace = Pace(dynamics, tcp)
        self._line: Line | None = None
        self._joint = np.zeros_like(q)
        self._length, self._s, self._rate = move.length, 0.0, 0.0
        self._looks = 0
        self.done, self.problem = False, ""
        if move.frame == "joint":
            self._joint[move.axis] = move.sign
            self._most = JOINT_SHARE * float(self._speed_limits[move.axis])
            self._acceleration = JOINT_SHARE * float(self._acceleration_limits[move.axis])
            return
        self._line = line = Line(dynamics, tcp, q)
        if line.singular(q):
            raise MoveRefused("jogging: singular here; jog a joint")
        axis = np.zeros(3)
        axis[move.axis % TURNS] = move.sign
        along = line.R @ R_FT @ axis if move.frame == "tool" else axis  # in B
        if move.axis < TURNS:
            line.way = along
            self._most, self._acceleration = MANUAL, LINE_ACCELERATION
        else:
            line.turn = line.R.T @ along
            self._most, self._acceleration = TURN_SPEED, TURN_ACCELERATION

    def step(self, share: float = 1.0, limits: SpeedLimits | None = None, keeper: WorkspaceKeeper | None = None) -> Reference:
        """The reference of the next tick.

        Args:
            share: of manual speed.
            limits: of REDUCED.
            keeper: of the arm that it leads; None: it leads none.
        """
        wanted = share * self._most
        if self._length > 0.0:
            left = self._length - self._s
            self.done = left < ENDED
            wanted = 0.0 if self.done else min(wanted, math.sqrt(2.0 * self._acceleration * left), left / TICK)
        rate = min(wanted, self._rate + self._acceleration * TICK)
        if wanted < self._rate:
            rate = max(wanted, self._rate - 2.0 * self._acceleration * TICK)
        rate = min(rate, self._most)
        qd = self._speeds(rate)
        allowed = self._allowed(qd, limits)
        if keeper is not None:
            allowed = min(allowed, keeper.share(self._q, qd))
        if allowed < 1.0:
            rate *= allowed
            qd = self._speeds(rate)
        self._look()
        self._rate, self._s = rate, self._s + rate * TICK
        qdd = (qd - self._qd) / TICK
        self._q, self._qd = self._q + TICK * qd, qd
        return Reference(self._q, qd, qdd)

    def _speeds(self, rate: float) -> Array:
        """Joint speeds (n,) [rad/s] at a rate along the way [m/s or rad/s]."""
        return rate * self._joint if self._line is None else self._line.solve(self._q, self._s, rate)

    def _allowed(self, qd: Array, limits: SpeedLimits | None) -> float:
        """The share of these joint speeds that all limits allow, 1 at most."""
        left = np.maximum(self._position - np.sign(qd) * self._q, 0.0)
        stopping = np.sqrt(2.0 * JOINT_SHARE * self._acceleration_limits * left)
        most = np.minimum(JOINT_SHARE * self._speed_limits, stopping)
        fast = np.abs(qd) > 1e-9
        share = float(np.min(most[fast] / np.abs(qd[fast]), initial=1.0))
        if bool((left[fast] < 1e-4).any()):
            joint = int(np.argmin(np.where(fast, left, math.inf)))
            self.problem = f"joint {joint + 1} is at the end of its range, {self._q[joint]:.3f} rad"
            return 0.0
        share = min(share, 1.0 / max(self._pace.over(self._q, qd, SpeedLimits(MANUAL, MANUAL, math.inf)), 1e-9))
        if limits is not None:
            share = min(share, SHARE / max(self._pace.over(self._q, qd, limits), 1e-9))
        return share

    def _look(self) -> None:
        """Whether the way leads into a singularity."""
        self._looks += 1
        if self._line is not None and self._looks % LOOK_TICKS == 0 and self._line.singular(self._q):
            self.problem = "singular ahead; jog a joint, or back"
