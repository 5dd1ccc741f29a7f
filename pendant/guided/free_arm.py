"""The free arm, from entry to leaving: whose force moves it, what holds it back, and what ends it (FD-4, FD-18, FD-19, VW-6)."""

from pendant.all_settings import Settings
from pendant.context import Surroundings
from pendant.events.event import Event, Kind, Values
from pendant.events.happened import Happened, Transition, becomes
from pendant.guided.bias_follower import SURE, UNUSED
from pendant.guided.endings import EndingWatch
from pendant.guided.pull import HandFelt, PullCauses, felt
from pendant.guided.sensor_bias import SensorBias
from pendant.guided.user_force import TakenForce, UserForce, upward_in_flange
from pendant.limits.axis_locks import axis_locks
from pendant.limits.joint_zones import JointZones
from pendant.limits.nearness import SingularityWatch
from pendant.limits.soft_limits import Damping
from pendant.limits.validity import JOINTS_SENSED, joints_ok
from pendant.tick.estimate import Estimate, JointsFeel
from pendant.tick.limit_engine import Excess
from pendant.tick.pose import ORIGIN, Vector, norm
from pendant.walls.barrier import Consequence
from pendant.walls.containment import NOBODY, Containment, caught, facts


class FreeArm:
    """One free-drive.

    Attributes:
        caught: a wall keeps the arm where it is (VW-6).
        user: the user's force, axes of B [N].
        pressed: the user's force, where it is more than the sensor may be wrong by and could be felt at entry (FD-13).
        damping: where free motion is resisted before a limit on its speed (FD-12b).
        singularity: how near the arm is to one (FD-4).
        pull: what pulls at it; of the tick before, where free-drive ends early in a tick.
        taken: what it takes for the user's force; None in the tick of entry.
        slack: what of the wrench at the flange may be the sensor's drift, which must not drive the arm (FD-19); without limit
            where the sensor is not used.
        suspect: a payload may have dropped, or the sensor stepped (FD-19).
        doubtful: it may be that nobody leads the moving arm (FD-19).
    """

    __slots__ = (
        "_bias",
        "_containment",
        "_hand",
        "_hung",
        "_operation",
        "_singularity",
        "_zones",
        "caught",
        "damping",
        "doubtful",
        "pressed",
        "pull",
        "singularity",
        "slack",
        "suspect",
        "taken",
        "user",
    )

    def __init__(
        self,
        around: Surroundings,
        settings: Settings,
        *,
        bias: SensorBias,
        containment: Containment,
        zones: JointZones,
        joints: tuple[str, ...],
        rated: tuple[float, ...],
    ) -> None:
        """
        Args:
            around: the tick of entry; its joint values are finite.
            settings: as they are now.
            bias: of the flange sensor, as of entry.
            containment: walls and areas; here they begin to hold.
            zones: before the joint limits; they begin to hold, too.
            joints: names, base to flange.
            rated: torque of each joint [N·m].
        """
        estimate = around.estimate
        self._bias, self._containment, self._zones = bias, containment, zones
        self._hand = UserForce(estimate, around.mean.mean(), bias.sensor.offset_force)
        self._operation = EndingWatch(estimate, settings, joints=joints, rated=rated, held=around.payload)
        self._singularity = SingularityWatch()
        self.caught = self.suspect = self.doubtful = False
        self.user: Vector = ORIGIN
        self.pressed: Excess | None = None
        self.damping: Damping | None = None
        self._hung = upward_in_flange(estimate)
        self.taken: TakenForce | None = None
        self.slack = SURE if bias.used else UNUSED
        self.pull = PullCauses(HandFelt.NOBODY)
        self.singularity = self._singularity.status
        zones.enter(settings.joint_limits)
        containment.enter(settings.walls)
        containment.step(estimate, *NOBODY)

    def step(self, around: Surroundings, settings: Settings, waits: bool) -> Happened:
        """One tick.

        Args:
            around: this tick.
            settings: as they are now.
            waits: nobody is known to move the arm.
        """
        estimate, bias, hand, operation = around.estimate, self._bias, self._hand, self._operation
        tick = estimate.tick
        if not joints_ok(estimate):
            return becomes(Transition.LEFT, Event(Kind.SENSORS_LOST, tick, {"sensor": JOINTS_SENSED}))
        if bias.used and not around.wrench_ok:
            return becomes(Transition.LEFT, Event(Kind.WRENCH_LOST, tick))
        events: list[Event] = []
        hand.step(estimate, bias.used, settings.unexplained.speed)
        self.user = hand.user
        if bias.used and settings.unexplained.sensor:
            still, force = around.still.count > 0, settings.unexplained.force
            told = bias.step(estimate, hand, around.mean, waits=waits, still=still, force=force)
            if told is not None:
                return becomes(Transition.LEFT, told)
        reading = self._containment.step(estimate, hand.user, hand.payload, operation.led)
        before, self.caught = self.caught, reading is not None and caught(reading)
        if reading is not None and not self.caught:
            kind = Kind.STOPPED_WALL if reading.consequence is Consequence.STOP else Kind.LEFT_WALL
            return becomes(Transition.LEFT, Event(kind, tick, facts(reading)), events)
        if reading is not None and not before:
            events.append(Event(Kind.WALL_REACHED, tick, facts(reading)))
        self._zones.step(estimate)
        near = around.status.singularity
        if self._singularity.step(near, settings.axes) and axis_locks(settings.axes) is not None:
            values: Values = {"status": self._singularity.status, "value": near, "limit": settings.axes.near}
            events.append(Event(Kind.SINGULARITY, tick, values))
        self.singularity = self._singularity.status
        baseline = bias.baseline if bias.used else None
        driven = around.shaken or self.caught or self._zones.pushing
        self.slack = slack = bias.slack(estimate) if bias.used else UNUSED
        ending = operation.step(estimate, hand, baseline=baseline, driven=driven, slack=slack)
        self.damping, self.suspect, self.doubtful = operation.damping, operation.suspect, operation.doubtful
        self.pull = self._pull(estimate, settings.unexplained.force + slack.force)
        self.pressed = self._pressed(settings, tick)
        self.taken = hand.taken(slack.force, self._hung, use_wrench=bias.used)
        if ending is not None:
            return becomes(Transition.LEFT, Event(ending.kind, tick, ending.values), events)
        return Happened(events)

    def _pressed(self, settings: Settings, tick: int) -> Excess | None:
        """At entry the sequence let so much pass; without it nobody knows what was felt then."""
        passes, size = settings.limits.activation.user_force, norm(self.user)
        if size < passes.max or not (self._bias.used and passes.on and settings.sequence.on):
            return None
        limit = passes.max + self._bias.wrong(tick).force
        return Excess("user force", "arm", size, limit, "N") if size >= limit else None

    def _pull(self, estimate: Estimate, least: float) -> PullCauses:
        """What pulls at the arm in this tick: a hand's force is at least so large [N]."""
        if not self._bias.used:
            return PullCauses(HandFelt.FLANGE if estimate.whose.joints_feel is JointsFeel.HAND else HandFelt.NOBODY)
        hand = self._hand
        who = felt(hand.user, sensed=hand.sensed, usual=norm(hand.usual), least=least, led=self._operation.moved)
        return PullCauses(who, estimate.whose.lost_odds, estimate.whose.lost_share, estimate.whose.step_odds)
