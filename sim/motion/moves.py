"""References that a joint controller follows: a posture kept, a stop, a joint move, a straight line."""

import math
from typing import NamedTuple, Protocol

import numpy as np
import ruckig
from numpy.typing import NDArray

from pendant.program.steps import JointMove, LinearMove
from pendant.tick.modes import TICK
from sim.arm.frames import matrix_from_quaternion
from sim.motion.line import Line, rotation_vector
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

SHORTEST_STOP = 0.08  # [s]; about the period of the arms' lowest modes, to leave them at rest
BRAKING_SHARE = 0.7  # of a joint's torque that a stop plans with; the rest is for the feedback
LEAST_BRAKING = 0.1  # of it, where gravity takes all of that
MOVING_SHARE = 0.75  # of a joint's torque that a move plans with; friction, a wrong payload and the feedback need the rest
EASINGS = 5  # times that a move is planned with less acceleration
LEAST_EASED = 0.3  # of it, each time
GLANCE = 0.02  # between the times of a move whose torques are looked at [s]
JERK_TIME = 0.1  # a joint reaches its acceleration in this time [s]
SPACING = 0.01  # between the places along a line that are looked at beforehand [m]
SAMPLES = (24, 200)  # fewest and most of them


class Reference(NamedTuple):
    """What the joints should do now: angles, speeds, accelerations, each (n,)."""

    q: Array
    qd: Array
    qdd: Array


class Motion(Protocol):
    """Something that yields a reference a tick until it is done."""

    done: bool

    def step(self) -> Reference:
        """The reference of the next tick."""
        ...


class MoveRefused(ValueError):
    """A move cannot be done; the text says why, with value and limit."""


def stop_time(dynamics: Dynamics, q: Array, qd: Array, *, rotor: Array, torque: Array) -> float:
    """Shortest time [s] in which the joints can brake from qd, all by the same law, half a cosine.

    It brakes hardest half-way, by pi/2 · speed / T; every joint has a share of its torque for that, less what gravity takes.

    Args:
        dynamics: the rigid model.
        q: angles (n,) [rad].
        qd: speeds (n,) [rad/s].
        rotor: inertia of the rotors, referred to the output (n,) [kg·m²].
        torque: limits of the joints (n,) [N·m].
    """
    momentum = dynamics.mass(q) @ qd + rotor * qd
    spare = np.maximum(BRAKING_SHARE * torque - np.abs(dynamics.gravity(q)), LEAST_BRAKING * torque)
    return 0.5 * math.pi * float(np.max(np.abs(momentum) / spare))


class Strength(NamedTuple):
    """What the joints can give for a move that is planned, the configured payload in hand."""

    dynamics: Dynamics
    rotor: Array  # inertia referred to the output (n,) [kg·m²]
    torque: Array  # limits (n,) [N·m]

    def left(self, trajectory: ruckig.Trajectory) -> float:
        """By which factor the accelerations fit: 1 or more where every joint has enough all the way."""
        least, count = math.inf, max(SAMPLES[0], math.ceil(trajectory.duration / GLANCE))
        for k in range(count + 1):
            q, qd, qdd = map(np.array, trajectory.at_time(k / count * trajectory.duration))
            gravity = self.dynamics.gravity(q)
            moving = self.dynamics.inverse(q, qd, qdd) + self.rotor * qdd - gravity
            spare = np.maximum(MOVING_SHARE * self.torque - np.abs(gravity), LEAST_BRAKING * self.torque)
            least = min(least, float(np.min(spare / np.maximum(np.abs(moving), 1e-9))))
        return least


class Stop:
    """Come to rest along the path the joints were on, then stand.

    Every joint keeps its share of the speed, so the tool stays on its path. The speed falls as half a cosine: a step in the
    deceleration would leave the flexible joints ringing.

    Args:
        q: angles now (n,) [rad].
        qd: speeds now (n,) [rad/s].
        length: how long it takes [s], as `stop_time` says.
    """

    def __init__(self, q: Array, qd: Array, length: float = 0.0) -> None:
        self._q, self._from, self._speed = q.copy(), q.copy(), qd.copy()
        self._zero = np.zeros_like(qd)
        self._time = 0.0
        self.done = not qd.any()
        self._length = max(SHORTEST_STOP, length)

    def step(self) -> Reference:
        """The reference of the next tick; at rest it stays where it is."""
        if self.done:
            return Reference(self._q, self._zero, self._zero)
        self._time = min(self._time + TICK, self._length)
        self.done = self._time >= self._length
        rate = math.pi / self._length
        phase = rate * self._time
        self._q = self._from + self._speed * (0.5 * (self._time + math.sin(phase) / rate))
        return Reference(self._q, self._speed * (0.5 + 0.5 * math.cos(phase)), self._speed * (-0.5 * rate * math.sin(phase)))


class JointTrajectory:
    """All joints to a target at rest, at the same time, within speed, acceleration and jerk limits (ruckig).

    A joint that would need more than `strength` gives is accelerated less, and all others with it: at its limit it would fall
    behind, and swing when it catches up.
    """

    def __init__(self, q: Array, move: JointMove, limits: tuple[Array, Array, Array], strength: Strength | None = None) -> None:
        """`limits` are the joints' speed, acceleration and position (±), each (n,); without `strength` they have any torque."""
        speed, acceleration, position = limits
        check_range(np.array(move.q), position, "joint move")
        n = q.size
        entry = ruckig.InputParameter(n)
        entry.current_position, entry.target_position = q.tolist(), list(move.q)
        entry.max_velocity = (move.speed * speed).tolist()
        eased = 1.0
        for _ in range(EASINGS if strength else 1):
            entry.max_acceleration = (eased * move.acceleration * acceleration).tolist()
            entry.max_jerk = (eased * move.acceleration * acceleration / JERK_TIME).tolist()
            self._trajectory = _planned(entry, n)
            share = 1.0 if strength is None else strength.left(self._trajectory)
            if share >= 1.0:
                break
            eased *= max(share, LEAST_EASED)
        self._time, self._rate = 0.0, 1.0
        self.done = False

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate [s]."""
        return self._trajectory.duration - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at the end it stays at the target. `rate`: how fast the motion's own time passes."""
        self._time += rate * TICK
        self.done = self._time >= self._trajectory.duration
        position, velocity, acceleration = self._trajectory.at_time(min(self._time, self._trajectory.duration))
        if rate == 1.0 == self._rate:
            return Reference(np.array(position), np.array(velocity), np.array(acceleration))
        speed = np.array(velocity)
        changing = (rate - self._rate) / TICK
        self._rate = rate
        return Reference(np.array(position), rate * speed, rate * rate * np.array(acceleration) + changing * speed)


def _planned(entry: ruckig.InputParameter, n: int) -> ruckig.Trajectory:
    """The trajectory of `entry`.

    Ruckig's root search fails for some way that lies within rounding of a profile's border; a hair less jerk is a profile
    next to it, which it finds.

    Raises:
        MoveRefused: none is found with a few hairs less, either.
    """
    jerk = np.array(entry.max_jerk)
    for less in (1.0, 0.999, 0.99, 0.9):
        entry.max_jerk = (less * jerk).tolist()
        trajectory = ruckig.Trajectory(n)
        try:
            result = ruckig.Ruckig(n).calculate(entry, trajectory)
        except ruckig.RuckigError:
            continue
        if result in (ruckig.Result.Working, ruckig.Result.Finished):
            return trajectory
    raise MoveRefused(f"joint move: no trajectory to {list(entry.target_position)}")


class LinearTrajectory:
    """The tool centre point along a straight line, turning about one axis, at rest at both ends.

    Path speed and acceleration follow ruckig in one dimension; joint angles follow from resolved motion rates
    (qd = J^-1 (v + k e)) against the model's own kinematics. Beforehand the line is walked through once: a joint that would
    exceed its speed slows the whole move down, a line through a singularity or out of reach is refused.
    """

    def __init__(
        self, q: Array, move: LinearMove, dynamics: Dynamics, *, tcp: Array, R_FT: Array, limits: tuple[Array, Array, Array]
    ) -> None:
        """`limits` are the joints' speed, acceleration and position (±), each (n,)."""
        self._line = line = Line(dynamics, tcp, q)
        line.way = np.array(move.position) - line.start
        line.turn = rotation_vector(line.R.T @ matrix_from_quaternion(move.quaternion) @ R_FT.T)
        length, angle = float(np.linalg.norm(line.way)), float(np.linalg.norm(line.turn))
        span = max(length, 0.3 * angle)  # a pure turn counts as an arc of 0.3 m radius
        self._q, self._qd = q.copy(), np.zeros_like(q)
        self._time, self.done = 0.0, span < 1e-6
        self._trajectory = ruckig.Trajectory(1)
        if self.done:
            return
        fraction = min(1.0, self._slowest(q, limits, move, span))
        entry = ruckig.InputParameter(1)
        entry.current_position, entry.target_position = [0.0], [1.0]
        entry.max_velocity = [fraction * move.speed / span]
        entry.max_acceleration = [fraction**2 * move.acceleration / span]
        entry.max_jerk = [fraction**3 * move.acceleration / span / JERK_TIME]
        ruckig.Ruckig(1).calculate(entry, self._trajectory)

    def _slowest(self, q: Array, limits: tuple[Array, Array, Array], move: LinearMove, span: float) -> float:
        """Factor on the path's speed that keeps every joint within its speed and acceleration, and the line in reach."""
        speed, acceleration, position = limits
        count = min(max(SAMPLES[0], math.ceil(span / SPACING)), SAMPLES[1])
        pace = move.speed / span
        q, worst, previous = q.copy(), 1e-9, None
        for k in range(count + 1):
            if self._line.singular(q):
                way = 1000.0 * k / count * float(np.linalg.norm(self._line.way))
                raise MoveRefused(f"linear move: out of reach or singular {way:.0f} mm on its way; use a joint move")
            rate = self._line.solve(q, k / count, 1.0)
            worst = max(worst, float((np.abs(rate) * pace / speed).max()))
            if previous is not None:
                worst = max(worst, math.sqrt(float((np.abs(rate - previous) * count * pace**2 / acceleration).max())))
            previous = rate
            check_range(q, position, "linear move")
            q = q + rate / count
        return 1.0 / worst

    @property
    def remaining(self) -> float:
        """How long it takes from here at full rate [s]."""
        return 0.0 if self.done else self._trajectory.duration - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at the end it stays at the target. `rate`: how fast the motion's own time passes."""
        if not self.done:
            self._time += rate * TICK
            self.done = self._time >= self._trajectory.duration
            position, velocity, _ = self._trajectory.at_time(min(self._time, self._trajectory.duration))
            qd = self._line.solve(self._q, position[0], rate * velocity[0])
            qdd = (qd - self._qd) / TICK
            self._q, self._qd = self._q + TICK * qd, qd
            return Reference(self._q, qd, qdd)
        return Reference(self._q, np.zeros_like(self._q), np.zeros_like(self._q))


def check_range(q: Array, position: Array, move: str) -> None:
    """Raise MoveRefused where a joint would leave ±`position` [rad]; `move` is the kind of move."""
    beyond = np.abs(q) - position
    joint = int(np.argmax(beyond))
    if beyond[joint] > 0.0:
        raise MoveRefused(f"{move}: joint {joint + 1} would reach {q[joint]:.4f} rad, allowed ±{position[joint]:.4f}")
