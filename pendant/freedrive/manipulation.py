"""Manipulation (FD-13): is the user changing, or trying to change, the posture?

A force at the flange must exceed its limit, for the sensor is no better. A hand on a link is told without the sensor's errors and
the joints' (`sim.estimation.link_hand`): what is left of it counts from the force on that is a hand's. So does what changes on an
arm that stands: a hand that leads a link gently, and has not moved it yet, never holds still.
"""

import math

from pendant.all_settings import Settings
from pendant.limits.parameters import EntryValues, Monitor, Observed, reference
from pendant.limits.residual import Split, upward
from pendant.sensor.hand_model import TOUCH
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.limit_engine import Excess
from pendant.tick.pose import ORIGIN, Vector, Wrench, norm

RATE = 1.0 - math.exp(-1.0 / TOUCH)
"""Weight of a tick in a change that a payload could explain and stops counting as the user's: a hand never keeps one."""


class Maintained:
    """Watches one free-drive or restart period for manipulation. Forces and torques are changes since it began."""

    __slots__ = ("_counts", "_joints", "_least", "_link", "_monitor", "_ones", "_share", "_since", "_slow", "_up")

    def __init__(self, estimate: Estimate, settings: Settings, wrench: Wrench | None, joints: tuple[str, ...]) -> None:
        """
        Args:
            estimate: of the tick in which the period begins.
            settings: as they are now; they stay so to the end of the period.
            wrench: F_user without what the sensor drifted by, axes of B [N, N·m]; None: judged by the joints alone (FD-3a).
            joints: names, base to flange.
        """
        self._monitor = Monitor(settings.limits.maintain)
        self._share = settings.limits.maintain.load_share
        self._least, self._counts = settings.unexplained.force, settings.limits.maintain.user_force.on
        self._since: EntryValues = reference(estimate, wrench)
        self._link: Vector = _link_force(estimate, wrench)
        self._joints = joints
        self._ones = (1.0,) * len(joints)
        self._up = upward(estimate.g_B.tolist())
        self._slow = [0.0] * 6  # the change, smoothed

    def anew(self, estimate: Estimate, wrench: Wrench | None) -> None:
        """The period starts again in this tick."""
        self._since = reference(estimate, wrench)
        self._link = _link_force(estimate, wrench)
        self._slow = [0.0] * 6

    def step(self, estimate: Estimate, wrench: Wrench | None) -> Excess | None:
        """One tick; its joint values are finite. Returns the first parameter that exceeds its maintain limit, or None."""
        parts = None if wrench is None else self._split(wrench)
        share = self._share
        heavier = share * GRAVITY * estimate.load_mass
        beyond = self._monitor.step(Observed(estimate, self._since, parts, self._joints, self._ones, share, heavier=heavier))
        return beyond[0].excess if beyond else self._on_link(estimate, wrench)

    def touched(self, estimate: Estimate, wrench: Wrench | None) -> bool:
        """A hand touches a link of an arm that stands."""
        return self._counts and _touch(estimate, wrench) > self._least

    def _on_link(self, estimate: Estimate, wrench: Wrench | None) -> Excess | None:
        """Whether a hand is felt on a link that was not as the period began, or one that touches an arm that stands."""
        if not self._counts:
            return None
        change = max(math.dist(_link_force(estimate, wrench), self._link), _touch(estimate, wrench))
        return Excess("user force", "link", change, self._least, "N") if change > self._least else None

    def _split(self, wrench: Wrench) -> Split:
        """The change without its payload-like part: that which stays, along gravity (force) or across it (torque)."""
        change = [now - then for now, then in zip(wrench, self._since.wrench, strict=True)]
        slow = self._slow
        for k in range(6):
            slow[k] += RATE * (change[k] - slow[k])
        ux, uy, uz = self._up
        fx, fy, fz, tx, ty, tz = slow
        along = fx * ux + fy * uy + fz * uz
        about = tx * ux + ty * uy + tz * uz
        x, y, z = change[0] - along * ux, change[1] - along * uy, change[2] - along * uz
        rx, ry, rz = change[3] - tx + about * ux, change[4] - ty + about * uy, change[5] - tz + about * uz
        force, torque = math.sqrt(x * x + y * y + z * z), math.sqrt(rx * rx + ry * ry + rz * rz)
        return Split(0.0, 0.0, force, torque)  # no limit here asks for a payload


def _touch(estimate: Estimate, wrench: Wrench | None) -> float:
    """Force at the flange of a hand that touches a link of a standing arm [N]; 0 without the flange sensor."""
    if wrench is None:
        return 0.0
    x, y, z = estimate.whose.F_touch.tolist()
    return norm((x, y, z))


def _link_force(estimate: Estimate, wrench: Wrench | None) -> Vector:
    """Force of a hand on a link, axes of B [N]: it is told beside the flange sensor alone."""
    if wrench is None:
        return ORIGIN
    x, y, z = estimate.whose.F_link.tolist()
    return x, y, z
