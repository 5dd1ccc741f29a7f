"""References that a joint controller follows: what all of them have, a posture kept, a stop."""

import math
from typing import NamedTuple, Protocol

import numpy as np
import ruckig
from numpy.typing import NDArray

from pendant.haptics import Shake
from pendant.tick.modes import TICK
from sim.braking.stopping_distance import StoppingDistance
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
GLANCE = 0.02  # between the times of a move whose torques are looked at [s]
LOOKS = 24  # of them, at least


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

    def stopping(self) -> StoppingDistance:
        """What it takes to come to rest."""
        dynamics, rotor, torque = self
        return StoppingDistance(lambda q, qd: stop_time(dynamics, q, qd, rotor=rotor, torque=torque), SHORTEST_STOP, REACTION)

    def broken(self, now: Reference, limits: tuple[Array, Array, Array], changing: Array) -> str:
        """Which limit joints that no reference leads have broken, or can no longer keep when they brake; "" for none.

        Args:
            now: where they are, and how fast.
            limits: their speed, acceleration and position (±), each (n,).
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
        joint = int(np.argmax(np.abs(stop) / position))
        if abs(stop[joint]) > position[joint]:
            return f"joint {joint + 1} would stop at {stop[joint]:.2f} rad, allowed ±{position[joint]:.4f}"
        return ""

    def left(self, trajectory: ruckig.Trajectory) -> float:
        """By which factor the accelerations fit: 1 or more where every joint has enough all the way."""
        least, count = math.inf, max(LOOKS, math.ceil(trajectory.duration / GLANCE))
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
        self.slowing = True
        self.done = not qd.any()
        self._length = max(SHORTEST_STOP, length)

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


def check_range(q: Array, position: Array, move: str) -> None:
    """Raise MoveRefused where a joint would leave ±`position` [rad]; `move` is the kind of move."""
    beyond = np.abs(q) - position
    joint = int(np.argmax(beyond))
    if beyond[joint] > 0.0:
        raise MoveRefused(f"{move}: joint {joint + 1} would reach {q[joint]:.4f} rad, allowed ±{position[joint]:.4f}")
