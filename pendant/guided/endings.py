"""What ends free-drive while it lasts: limits (FD-18), motion that nobody causes, a payload that drops (FD-19).

How likely it is that a payload has dropped, or another has come, is estimated from the wrench at the flange, with a hand and a
step of the sensor as the other explanations (`sim.flange.external_wrench`). Here it is decided how likely is enough.
"""

import math
from typing import NamedTuple

from pendant.all_settings import Settings
from pendant.events.event import Kind, Values
from pendant.guided.bias_follower import SURE, Slack
from pendant.guided.unintended_motion import UnintendedMotion
from pendant.guided.user_force import UserForce
from pendant.limits.parameters import EntryValues, Monitor, Observed, reference
from pendant.limits.residual import Split
from pendant.limits.soft_limits import Damping, SoftLimits
from pendant.sensor.hand_model import KNOWN, SUSPECTED
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.pose import ORIGIN, Vector, Wrench, norm


class Ending(NamedTuple):
    """Why free-drive ends."""

    kind: Kind
    values: Values


class EndingWatch:
    """Watches one free-drive, from entry to leaving.

    Attributes:
        suspect: a payload may have dropped, or the sensor stepped: the additional torque goes (FD-19).
        damping: where motion is resisted, None while nothing is (FD-12b).
    """

    __slots__ = (
        "_held",
        "_joints",
        "_monitor",
        "_on",
        "_rated",
        "_since",
        "_soft",
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
        self._held = held
        self.suspect = False
        self.damping: Damping | None = None

    @property
    def led(self) -> bool:
        """Somebody leads the arm: the motion is paid for."""
        return self._unintended.led

    @property
    def moved(self) -> bool:
        """Somebody leads the arm, and it moves: at rest the noise of the speed pays for itself."""
        return self._unintended.led and self._unintended.moves

    @property
    def doubtful(self) -> bool:
        """It may be that nobody leads the moving arm: nothing helps it on (FD-19)."""
        return self._unintended.doubtful

    def step(
        self,
        estimate: Estimate,
        hand: UserForce,
        *,
        baseline: Wrench | None,
        driven: bool,
        slack: Slack = SURE,
    ) -> Ending | None:
        """One tick; its joint values are finite.

        Args:
            estimate: of this tick.
            hand: after its step.
            baseline: the part of F_user that is the sensor's bias, axes of F [N, N·m]; None where the flange sensor is not used.
            driven: a wall or another device moves the arm, or holds it.
            slack: what may be the sensor's drift.
        """
        odds = estimate.whose.lost_odds if self._on.payload and baseline is not None else -math.inf
        stepped = estimate.whose.step_odds if self._on.sensor and baseline is not None else -math.inf
        self.suspect = odds >= SUSPECTED or stepped >= -SUSPECTED
        fell = baseline is None and self._on.payload and estimate.whose.payload_fell
        if fell or odds >= KNOWN:
            mass = self._held if fell else estimate.whose.lost_share * self._held
            return Ending(Kind.STOPPED_PAYLOAD, {"mass": -mass, "force": abs(mass) * GRAVITY})
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
