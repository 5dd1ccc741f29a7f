"""The payload wizard: measures one wrist posture after the other, refuses what is of no use, and keeps what was found."""

import math
from typing import NamedTuple

import numpy as np

from pendant.equipment.load import Load
from pendant.equipment.payload_fit import LEAST, FittedPayload, Posture, least_angle, nearest, solve
from pendant.events.event import Event, Kind, Values
from pendant.tick.estimate import Estimate
from pendant.tick.pose import Vector, Wrench

MOST = 24
"""Postures kept at most."""

UNSTEADY = 1.0
"""Largest change of the force from the first to the second half of a measurement, beyond which somebody touches [N]."""


class Progress(NamedTuple):
    """What interfaces show of the wizard."""

    postures: int = 0
    share: float = 0.0  # of the measurement that runs, 0 where none does
    finding: FittedPayload | None = None
    reason: str = ""  # why there is none, once there are postures enough
    doing: str = ""  # what the arm does for it by itself, "" where it does nothing


IDLE = Progress()


class PayloadWizard:
    """One tick at a time, while it measures; nothing is done otherwise.

    Attributes:
        progress: for interfaces.
        left: ticks left of the measurement that runs, 0 where none does.
    """

    __slots__ = ("_halves", "_postures", "_total", "left", "progress")

    def __init__(self) -> None:
        self._postures: tuple[Posture, ...] = ()
        self._halves = np.zeros((2, 6))  # sums of the sensor's values
        self._total = 0  # ticks of the measurement
        self.left = 0
        self.progress = IDLE

    def clear(self) -> None:
        """Forget all postures: the tool is another, or the user begins again."""
        self._postures = ()
        self.left = 0
        self.progress = IDLE

    @property
    def measured(self) -> tuple[Vector, ...]:
        """Specific force in F in each posture that is measured [m/s²]."""
        return tuple([posture.a for posture in self._postures])

    def say(self, doing: str) -> None:
        """What the arm does by itself, for interfaces."""
        self.progress = self.progress._replace(doing=doing)

    def shift(self, gone: Wrench) -> None:
        """The sensor was zeroed: it says more by so much from now on, axes of F [N, N·m]; no measurement runs."""
        x, y, z, a, b, c = gone
        self._postures = tuple([Posture(p.a, _sum(p.force, (x, y, z)), _sum(p.torque, (a, b, c))) for p in self._postures])
        found = self.progress.finding
        if found is not None:
            force, torque = _sum(found.force_offset, (x, y, z)), _sum(found.torque_offset, (a, b, c))
            self.progress = self.progress._replace(finding=found._replace(force_offset=force, torque_offset=torque))

    def begin(self, estimate: Estimate, length: int, why_not: str) -> list[Event]:
        """Begin to measure where the arm stands now.

        Args:
            estimate: of this tick.
            length: of the measurement [ticks], 2 or more.
            why_not: what forbids it, or "".
        """
        if self.left > 0:
            why_not = "a posture is being measured"
        elif len(self._postures) == MOST:
            why_not = f"{MOST} postures are enough: clear them to begin again"
        elif not why_not:
            why_not = self._alike(_specific_force(estimate))
        if why_not:
            return [_refused(estimate, why_not)]
        self._halves[:] = 0.0
        self._total = self.left = length
        self._tell()
        return []

    def step(self, estimate: Estimate, why_not: str, known: tuple[Load, ...]) -> list[Event]:
        """One tick of a measurement.

        Args:
            estimate: of this tick.
            why_not: what forbids it by now, or "".
            known: what the sensor feels apart from the load that is looked for.
        """
        if why_not:
            self.left = 0
            self._tell()
            return [_refused(estimate, why_not)]
        half = 0 if 2 * self.left > self._total else 1
        self._halves[half] += estimate.w_sensor
        self.left -= 1
        self._tell()
        return [] if self.left else self._end(estimate, known)

    def _end(self, estimate: Estimate, known: tuple[Load, ...]) -> list[Event]:
        later = self._total // 2
        first, second = self._halves[0] / (self._total - later), self._halves[1] / later
        change = math.hypot(*(second - first).tolist()[:3])
        if change > UNSTEADY:
            return [_refused(estimate, f"the force changed by {change:.1f} N, at most {UNSTEADY:g} N: hands off the arm")]
        a = _specific_force(estimate)
        values: Values = {"number": len(self._postures) + 1, "angle": 0.0, "limit": 0.0}
        if self._postures:
            values["angle"] = math.degrees(nearest(self._postures, a)[1])
            values["limit"] = math.degrees(least_angle(len(self._postures) + 1))
        fx, fy, fz, tx, ty, tz = (self._halves.sum(axis=0) / self._total).tolist()
        self._postures += (Posture(a, (fx, fy, fz), (tx, ty, tz)),)
        self._tell()
        values["missing"] = max(0, LEAST - len(self._postures))
        events = [Event(Kind.POSTURE_MEASURED, estimate.tick, values)]
        if not values["missing"]:
            events.append(self._find(estimate, known))
        return events

    def _find(self, estimate: Estimate, known: tuple[Load, ...]) -> Event:
        found = solve(self._postures, known)
        if isinstance(found, str):
            self.progress = self.progress._replace(finding=None, reason=found)
            return _refused(estimate, found)
        self.progress = self.progress._replace(finding=found, reason="")
        x, y, z = found.centre
        values: Values = {
            "mass": found.mass,
            "mass_deviation": found.mass_deviation,
            "x": 1000.0 * x,
            "y": 1000.0 * y,
            "z": 1000.0 * z,
            "centre_deviation": 1000.0 * found.centre_deviation,
            "fit": found.force_fit,
            "postures": found.postures,
        }
        return Event(Kind.PAYLOAD_FOUND, estimate.tick, values)

    def _alike(self, a: Vector) -> str:
        """Why a posture is of no use beside those that are there, or ""."""
        if not self._postures:
            return ""
        number, angle = nearest(self._postures, a)
        least = least_angle(len(self._postures) + 1)
        if angle >= least:
            return ""
        return f"{math.degrees(angle):.1f}° from posture {number}, at least {math.degrees(least):.1f}°: turn the wrist on"

    def _tell(self) -> None:
        share = 1.0 - self.left / self._total if self.left else 0.0
        self.progress = self.progress._replace(postures=len(self._postures), share=share)


def _specific_force(estimate: Estimate) -> Vector:
    """In F, from the joint angles, which are finer than the accelerometer at rest."""
    x, y, z = (-(estimate.g_B @ estimate.R_BF)).tolist()
    return (x, y, z)


def _sum(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _refused(estimate: Estimate, reason: str) -> Event:
    return Event(Kind.POSTURE_REFUSED, estimate.tick, {"reason": reason})
