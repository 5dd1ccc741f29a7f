"""References that a joint controller follows: what all of them have, a posture kept, a stop."""

import math
from collections.abc import Iterable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from pendant.haptics import Shake
from pendant.tick.modes import TICK
from sim.braking.motion_meter import Braking
from sim.braking.stopping_distance import StoppingDistance
from sim.paths.timing_law import MoveRefused
from sim.paths.tool_point import Followed
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.sensors import LATENCY

Array = NDArray[np.float64]

DELAY = LATENCY + 1
"""Ticks between a reference and the measurement of what it led to: each measurement is compared with its own reference."""

SHORTEST_STOP = 0.08  # [s]; about the period of the arms' lowest modes, to leave them at rest
BRAKING_SHARE = 0.7  # of a joint's torque that a stop plans with; the rest is for the feedback
LEAST_BRAKING = 0.1  # of it, where gravity takes all of that
MOVING_SHARE = 0.75  # of a joint's torque that a move plans with; friction, a wrong payload and the feedback need the rest
TOO_FAST = 1.05  # times a joint's speed limit, from where its motor drives no further (sim.control.motor_controller)
REACTION = (DELAY + 2) * TICK  # until joints brake on what was measured: the pendant hears of it a tick later [s]


class Reference(NamedTuple):
    """What the joints should do now: angles, speeds, accelerations, each (n,)."""

    q: Array
    qd: Array
    qdd: Array


def led_to(q: Array, qd: Array, qdd: Array) -> list[Reference]:
    """The references of the last ticks, the oldest first, had they led to angles `q` at speeds `qd` without a change (n,).

    A reference that begins anew has none, and what is measured in the next ticks answers to these.
    """
    return [Reference(q - (LATENCY - k) * TICK * qd, qd, qdd) for k in range(DELAY)]


def shaken(reference: Reference, shake: Shake) -> Reference:
    """The reference with the last joint's part in haptic feedback (HF-1)."""
    q, qd, qdd = (values.copy() for values in reference)
    q[-1] += shake.angle
    qd[-1] += shake.speed
    qdd[-1] += shake.acceleration
    return Reference(q, qd, qdd)


class Motion(Protocol):
    """Something that yields a reference a tick, by its `step`, until it is done."""

    done: bool


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


def stop_room(now: Reference, position: Array) -> float:
    """Time [s] that a stop may take so that every joint comes to rest within `position` (2, n) [rad]: it goes half of qd T."""
    size = np.abs(now.qd)
    left = np.maximum(np.where(now.qd > 0.0, position[1] - now.q, now.q - position[0]), 0.0)
    return float(np.min(2.0 * left[size > 0.0] / size[size > 0.0], initial=math.inf))


class Strength(NamedTuple):
    """What the joints can give for a move that is planned, the configured payload in hand."""

    dynamics: Dynamics
    rotor: Array  # inertia referred to the output (n,) [kg·m²]
    torque: Array  # limits (n,) [N·m]

    def stopping(self) -> StoppingDistance:
        """What it takes to come to rest."""
        dynamics, rotor, torque = self
        return StoppingDistance(lambda q, qd: stop_time(dynamics, q, qd, rotor=rotor, torque=torque), SHORTEST_STOP, REACTION)

    def braking(self) -> Braking:
        """What a stop plans with."""
        return Braking(self.rotor, BRAKING_SHARE * self.torque, LEAST_BRAKING * self.torque, SHORTEST_STOP, REACTION)

    def broken(self, now: Reference, limits: tuple[Array, Array, Array], changing: Array) -> str:
        """Which limit joints that no reference leads have broken, or can no longer keep when they brake; "" for none.

        Args:
            now: where they are, and how fast.
            limits: their speed and acceleration (n,), and their smallest and largest angles (2, n).
            changing: acceleration with which they go on until they brake (n,) [rad/s²].
        """
        q, qd, _ = now
        speed, _, position = limits
        fast = np.abs(qd + REACTION * changing)
        joint = int(np.argmax(fast / speed))
        if fast[joint] > TOO_FAST * speed[joint]:
            return f"joint {joint + 1} moves at {fast[joint]:.2f} rad/s, allowed {speed[joint]:.2f}"
        length = max(SHORTEST_STOP, stop_time(self.dynamics, q, qd, rotor=self.rotor, torque=self.torque))
        stop = q + qd * (0.5 * length + REACTION)
        out = beyond(stop, position)
        joint = int(np.argmax(out))
        if out[joint] > 0.0:
            return f"joint {joint + 1} would stop at {stop[joint]:.2f} rad, allowed {_span(position, joint)}"
        return ""

    def left(self, references: Iterable[Reference]) -> float:
        """By which factor the accelerations of a motion fit: 1 or more where every joint has enough at all of its references."""
        least = math.inf
        for q, qd, qdd in references:
            spare, moving = self._spare(q), self._moving(q, qd, qdd)
            least = min(least, float(np.min(spare / np.maximum(np.abs(moving), 1e-9))))
        return least

    def needed(self, joints: Followed) -> tuple[Array, Array, Array]:
        """What a motion along a path needs at a place: torque that there is for it, and its torques, each (n,).

        With speed v and acceleration a along the path, it needs at most a times the second and v² times the third.
        """
        q, rate, bend = joints.q, joints.rate, joints.bend
        return self._spare(q), np.abs(self._moving(q, np.zeros_like(q), rate)), np.abs(self._moving(q, rate, bend))

    def _spare(self, q: Array) -> Array:
        """Torque (n,) that gravity leaves for a motion [N·m]."""
        return np.maximum(MOVING_SHARE * self.torque - np.abs(self.dynamics.gravity(q)), LEAST_BRAKING * self.torque)

    def _moving(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Torque (n,) of a motion, without gravity [N·m]."""
        return self.dynamics.inverse(q, qd, qdd) + self.rotor * qdd - self.dynamics.gravity(q)


class Stop:
    """Come to rest along the path the joints were on, then stand.

    Every joint keeps its share of the speed, so the tool stays on its path. The speed falls as half a cosine: a step in the
    deceleration would leave the flexible joints ringing.

    Args:
        q: angles now (n,) [rad].
        qd: speeds now (n,) [rad/s].
        length: how long it takes [s], as `stop_time` says.
        room: how long it may take, as `stop_room` says; the arm may be left ringing for it, not asked for more torque [s].
    """

    def __init__(self, q: Array, qd: Array, length: float = 0.0, room: float = math.inf) -> None:
        self._q, self._from, self._speed = q.copy(), q.copy(), qd.copy()
        self._zero = np.zeros_like(qd)
        self._time = 0.0
        self.slowing = True
        self.done = not qd.any()
        self._length = max(min(SHORTEST_STOP, room), length, TICK)

    @property
    def goal(self) -> Array:
        """Where it comes to rest (n,) [rad]."""
        return self._q if self.done else self._from + self._speed * (0.5 * self._length)

    @property
    def remaining(self) -> float:
        """How long it still takes [s]."""
        return 0.0 if self.done else self._length - self._time

    def step(self, rate: float = 1.0) -> Reference:
        """The reference of the next tick; at rest it stays where it is. `rate`: how many ticks pass; slower is no stop."""
        if self.done:
            return Reference(self._q, self._zero, self._zero)
        self._time = min(self._time + max(rate, 1.0) * TICK, self._length)
        self.done = self._time >= self._length
        rate = math.pi / self._length
        phase = rate * self._time
        self._q = self._from + self._speed * (0.5 * (self._time + math.sin(phase) / rate))
        return Reference(self._q, self._speed * (0.5 + 0.5 * math.cos(phase)), self._speed * (-0.5 * rate * math.sin(phase)))


def turning_points(joints: Followed, ahead: Followed, step: float) -> tuple[Array, Array]:
    """Where joints turn round between two places of a path, `step` [m] apart: after which way (n,) [m], and at which angle (n,).

    A joint that does not turn round has 0 and its first angle.
    """
    before, after = joints.rate, ahead.rate
    way = np.where(before * after < 0.0, before, 0.0) / np.where(before * after < 0.0, before - after, 1.0) * step
    return way, joints.q + 0.5 * way * before


def check_range(q: Array, position: Array, move: str) -> None:
    """Raise MoveRefused where a joint would leave `position` (2, n) [rad]; `move` is the kind of move."""
    out = beyond(q, position)
    joint = int(np.argmax(out))
    if out[joint] > 0.0:
        raise MoveRefused(f"{move}: joint {joint + 1} would reach {q[joint]:.4f} rad, allowed {_span(position, joint)}")


def beyond(q: Array, position: Array) -> Array:
    """How far each joint is beyond the nearer end of its range `position` (2, n), less than 0 inside (n,) [rad]."""
    return np.maximum(q - position[1], position[0] - q)


def _span(position: Array, joint: int) -> str:
    low, high = position[:, joint]
    return f"±{high:.4f}" if low == -high else f"{low:.4f} .. {high:.4f}"
