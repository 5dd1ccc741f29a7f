"""What ends free-drive while it lasts: limits (FD-18), motion that nobody causes, a payload that drops (FD-19).

A payload that is lost leaves the sensor with what it weighed: F_user is then a constant share of what the configured load needs
in the arm's own, violent acceleration. A hand neither comes in two ticks nor follows that acceleration; one that lets go ends
at no force at all.
"""

import math
from typing import NamedTuple

from pendant.all_settings import Settings
from pendant.events.event import Kind, Values
from pendant.guided.hidden_drop import LEAST, HiddenDrop
from pendant.guided.sensor_bias import SURE, Slack
from pendant.guided.unintended_motion import UnintendedMotion
from pendant.guided.user_force import UserForce
from pendant.limits.parameters import EntryValues, Monitor, Observed, reference
from pendant.limits.residual import Split
from pendant.limits.soft_limits import Damping, SoftLimits
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.pose import ORIGIN, Vector, Wrench, flat, norm, turned_back

STEP = 2
"""A payload comes or goes within so many ticks."""

CERTAIN = 4
"""Ticks for which the step must last, before it is called one: no vibration does; the additional torque goes at once."""

LASTS = 10
"""And for so many, where less than half of the load is missing: then a residual that swings with the arm is as large."""

NOTHING_FOLLOWS = (0, math.inf, -math.inf, math.inf, 0.0)
"""Ticks, least and most share, least and most of the square of what the load needs."""

STAYS = 0.6  # of the step is what the new level must be, and the reverse: a hand that lets go ends at none
RISES = 1.35  # of the level after the step is the most that may follow: a hand's force still rises
ACROSS = 0.35  # of a step may be across it: the share that is not explained
SLACK = 2.0  # [N] for the sensor's noise
LOST_AT_MOST = 1.15  # of the configured load

FOLLOWS = 8
"""Ticks for which what is missing must follow the load's own inertia, where a hand that lets go at once hides the step."""

SWINGS = 1.4  # from the least to the most that the load needs meanwhile
SAME = 0.1  # of the share is as far as it may stray meanwhile
CALM = 0.3
"""Share by which the square of what the load needs may be off its weight's: beyond, the arm swings, and residuals with it."""

SWUNG = 10  # calm ticks that a swinging one undoes: the step of a payload itself swings for two

MUCH = 0.5  # of the load is missing at least, where the arm swings

OLD = 50  # ticks after which such a run starts again: slow changes are hands


class Ending(NamedTuple):
    """Why free-drive ends."""

    kind: Kind
    values: Values


class EndingWatch:
    """Watches one free-drive, from entry to leaving.

    Attributes:
        suspect: a payload may have dropped: the additional torque goes (FD-19).
        damping: where motion is resisted, None while nothing is (FD-12b).
    """

    __slots__ = (
        "_calm",
        "_followed",
        "_hidden",
        "_joints",
        "_level",
        "_missed",
        "_monitor",
        "_on",
        "_rated",
        "_since",
        "_soft",
        "_stepped",
        "_unintended",
        "damping",
        "suspect",
    )

    def __init__(
        self,
        estimate: Estimate,
        settings: Settings,
        *,
        joints: tuple[str, ...],
        rated: tuple[float, ...],
        held: float,
    ) -> None:
        """
        Args:
            estimate: of the tick of entry; its joint values are finite.
            settings: as they are now; they stay so to the end.
            joints: names, base to flange.
            rated: torque of each joint [N·m].
            held: configured payload without the tool, what may drop [kg].
        """
        self._monitor = Monitor(settings.limits.operation)
        self._joints, self._rated = joints, rated
        self._since: EntryValues = reference(estimate, None)
        self._soft = SoftLimits(settings, estimate)
        self._on = settings.unexplained
        self._unintended = UnintendedMotion(self._on, self._since)
        self._missed: list[Vector] = [ORIGIN] * STEP  # force that the sensor misses, in the last ticks, axes of F [N]
        self._calm = 0  # rises with every tick in which the arm does not swing
        self._level = 0.0  # of the share after a step
        self._stepped = 0  # ticks since a step, 0: none
        self._followed = NOTHING_FOLLOWS
        self._hidden = HiddenDrop(held)
        self.suspect = False
        self.damping: Damping | None = None

    @property
    def led(self) -> bool:
        """Somebody leads the arm: the motion is paid for."""
        return self._unintended.led

    @property
    def doubtful(self) -> bool:
        """It may be that nobody leads the moving arm: nothing helps it on (FD-19)."""
        return self._unintended.doubtful

    def step(
        self, estimate: Estimate, hand: UserForce, *, baseline: Wrench | None, driven: bool, slack: Slack = SURE
    ) -> Ending | None:
        """One tick; its joint values are finite.

        Args:
            estimate: of this tick.
            hand: after its step.
            baseline: the part of F_user that is the sensor's bias, axes of F [N, N·m]; None where the flange sensor is not used.
            driven: a wall or another device moves the arm, or holds it.
            slack: what may be the sensor's drift.
        """
        if self._on.payload and baseline is not None:
            # What may be the sensor's drift is no payload.
            lost = self._lost(estimate, hand, baseline, LEAST + slack.force)
            if lost is not None:
                return lost
        else:
            self._stepped, self._followed, self.suspect = 0, NOTHING_FOLLOWS, False
            self._hidden.forget()
        torque = ORIGIN if baseline is None else _torque(estimate, baseline)
        soft = self._soft
        if soft.pushed:
            soft.step(estimate, norm(hand.user), norm(torque))
        else:
            soft.step(estimate)
        self.damping = soft.damping
        parts = None if baseline is None else Split(0.0, 0.0, norm(hand.change), 0.0)
        beyond = self._monitor.step(Observed(estimate, self._since, parts, self._joints, self._rated, 0.0, soft.shares))
        if beyond:
            gauge = next((gauge for gauge in beyond if gauge.stop), beyond[0])
            return Ending(Kind.STOPPED_LIMIT if gauge.stop else Kind.LEFT_LIMIT, dict(gauge.excess._asdict()))
        if not self._on.motion:
            return None
        use_wrench = baseline is not None
        values = self._unintended.step(estimate, hand, use_wrench=use_wrench, driven=driven, slack=slack, torque=torque)
        return None if values is None else Ending(Kind.STOPPED_MOTION, values)

    def _lost(self, estimate: Estimate, hand: UserForce, baseline: Wrench, least: float) -> Ending | None:
        """A payload-like step, of at least so much force [N]."""
        mass = estimate.load_mass
        weight = mass * GRAVITY
        if weight < LEAST:
            return None
        fx, fy, fz, _, _, _ = estimate.F_user.tolist()
        rx, ry, rz = turned_back(flat(estimate.R_BF), (fx, fy, fz))
        wx, wy, wz, _, _, _ = estimate.w_sensor.tolist()
        nx, ny, nz = rx + wx, ry + wy, rz + wz  # what the configured load needs in this motion
        ox, oy, oz, _, _, _ = baseline
        mx, my, mz = rx - ox, ry - oy, rz - oz  # what is missing of it
        square = nx * nx + ny * ny + nz * nz
        share = (mx * nx + my * ny + mz * nz) / max(square, 1e-9)
        missed = self._missed
        bx, by, bz = missed.pop(0)
        missed.append((mx, my, mz))
        calm = self._calm >= SWUNG
        swings = abs(square - weight * weight) > CALM * weight * weight
        self._calm = max(self._calm - SWUNG, 0) if swings else min(self._calm + 1, 3 * SWUNG)
        across = norm((mx - share * nx, my - share * ny, mz - share * nz))
        if not self._stepped:
            # Of the force alone: a hand's, which stays, becomes another share of what a swinging load needs.
            jump = share - (bx * nx + by * ny + bz * nz) / max(square, 1e-9)
            began = abs(share) * weight >= least and share * jump > 0.0 and abs(jump) >= STAYS * abs(share)
            began = began and abs(share) >= STAYS * abs(jump) and (calm or abs(share) >= MUCH)
            began = began and hand.stands_out((mx - bx, my - by, mz - bz))
            self._stepped = int(began and self._like(share, across, square))
        elif self._stepped == 1:  # the sensor's mean over the tick in which it happened may have held a part of it
            self._level = share
            self._stepped = 2 if self._like(share, across, square) and abs(share) * weight >= least else 0
        elif self._like(share, across, square) and STAYS <= share / self._level <= RISES:
            self._stepped += 1
        else:
            self._stepped = 0
        hidden = self._hidden.step((mx, my, mz), (bx, by, bz), (nx, ny, nz), mass)
        self.suspect = self._stepped > 0 or self._hidden.ticks > 0
        if hidden:
            held = self._hidden.held
            return Ending(Kind.STOPPED_PAYLOAD, {"mass": -held, "force": held * GRAVITY})
        certain = CERTAIN if abs(self._level) >= MUCH else LASTS
        if self._stepped <= certain and not self._follows(share, across, square, weight):
            return None
        return Ending(Kind.STOPPED_PAYLOAD, {"mass": -share * mass, "force": abs(share) * weight})

    def _follows(self, share: float, across: float, square: float, weight: float) -> bool:
        """What is missing swings with what the load needs in the arm's own motion, as no hand's force does."""
        if abs(share) < MUCH or abs(share) * weight < LEAST or not self._like(share, across, square):
            self._followed = NOTHING_FOLLOWS
            return False
        count, low, high, least, most = self._followed
        low, high = min(low, share), max(high, share)
        if high - low > SAME * abs(share) or count == OLD:
            count, low, high, least, most = 0, share, share, square, square
        count, least, most = count + 1, min(least, square), max(most, square)
        self._followed = (count, low, high, least, most)
        return count >= FOLLOWS and most >= SWINGS * SWINGS * least

    @staticmethod
    def _like(share: float, across: float, square: float) -> bool:
        """What is missing is a share of the load."""
        return abs(share) <= LOST_AT_MOST and across <= ACROSS * abs(share) * math.sqrt(square) + SLACK


def _torque(estimate: Estimate, baseline: Wrench) -> Vector:
    """The hand's torque, axes of B: what is beyond a baseline that turns with the flange [N·m]."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = estimate.R_BF.tolist()
    _, _, _, ox, oy, oz = baseline
    _, _, _, x, y, z = estimate.F_user.tolist()
    return x - xx * ox - xy * oy - xz * oz, y - yx * ox - yy * oy - yz * oz, z - zx * ox - zy * oy - zz * oz


def way_back(then: tuple[float, ...], now: tuple[float, ...], joints: tuple[str, ...]) -> str:
    """Which joints to move which way by how much to come back to a posture, largest first; empty when it is near (FD-22)."""
    turns = [(math.degrees(a - b), joint) for a, b, joint in zip(then, now, joints, strict=True)]
    told = sorted((turn for turn in turns if abs(turn[0]) >= 0.5), key=lambda turn: -abs(turn[0]))
    return ", ".join(f"{joint} {angle:+.1f}°" for angle, joint in told[:4])
