"""Free-drive: activation, entry, staying in, and leaving with its cause and the way back (FD-7 to FD-17, FD-22)."""

from pendant.all_settings import Settings
from pendant.context import Surroundings
from pendant.event_table import TABLE
from pendant.events.event import Event, Kind, Values, posture_text
from pendant.events.happened import Happened, Transition, becomes
from pendant.freedrive.activation import Activation
from pendant.freedrive.adaptive_gravity import Balance
from pendant.freedrive.gate import Gate
from pendant.freedrive.periods import Periods, Remaining
from pendant.freedrive.sequence import SequenceVerdict
from pendant.guided.endings import way_back
from pendant.guided.free_arm import FreeArm
from pendant.guided.pull import PullCauses
from pendant.guided.sensor_bias import SensorBias
from pendant.limits.joint_zones import JointZones
from pendant.sensor.sensor_spec import SensorSpec
from pendant.settings.schema import ticks
from pendant.signals.sources import Presence
from pendant.tick.limit_engine import Monitored
from pendant.tick.modes import Phase
from pendant.walls.containment import Containment, WallState

ASKED_FOR = frozenset({Kind.LEFT_PRESS, Kind.LEFT_RELEASE, Kind.DEACTIVATED})
"""Leavings that the user asked for: nobody has to be told the way back (FD-22)."""

IN_FREE_DRIVE = frozenset({Phase.HELD, Phase.PERIOD, Phase.GUIDED, Phase.RESTART})

KNOWN = IN_FREE_DRIVE | {Phase.SEQUENCE}
"""Phases in which the posture at activation is remembered."""

OVER = frozenset({Transition.REFUSED, Transition.LEFT})
"""Transitions after which free-drive is off, and its cool-down runs."""


class FreeDrive:
    """State machine of the phases. Each tick says what becomes of free-drive; it changes no mode itself.

    Attributes:
        phase: of now.
        arm: the free arm, from entry to leaving.
        pull: what pulls at the free arm, to the tick in which it is left; None while free-drive is off.
    """

    __slots__ = (
        "_activation",
        "_bias",
        "_containment",
        "_gate",
        "_joints",
        "_periods",
        "_rated",
        "_verdict",
        "_zones",
        "arm",
        "phase",
        "pull",
    )

    def __init__(
        self,
        joints: tuple[str, ...],
        rated: tuple[float, ...],
        containment: Containment,
        zones: JointZones,
        *,
        sensor: SensorSpec,
    ) -> None:
        """
        Args:
            joints: the names used in events, base to flange.
            rated: torque of each joint [N·m].
            containment: walls and areas.
            zones: before the joint limits.
            sensor: what is known of the flange force/torque sensor.
        """
        self.phase = Phase.OFF
        self._joints, self._rated = joints, rated
        self._containment, self._zones = containment, zones
        self._gate = Gate()
        self._bias = SensorBias(sensor)
        self._activation = Activation(joints, rated, containment, self._bias)
        self._verdict = SequenceVerdict()
        self.arm: FreeArm | None = None
        self.pull: PullCauses | None = None
        self._periods: Periods | None = None  # from entry to leaving

    @property
    def idle(self) -> bool:
        """Nothing runs that would have to be published."""
        return self.phase is _OFF and self._gate.left == 0

    def periods(self) -> tuple[Remaining, ...]:
        """Every running period (FD-20)."""
        gate = self._gate
        running = (self._activation if self._periods is None else self._periods).remaining
        told = () if running is None else (running,)
        return (*told, Remaining("cool-down", gate.left, gate.total)) if gate.left > 0 else told

    def monitored(self) -> tuple[Monitored, ...]:
        """What the activation sequence checks, while it runs."""
        return self._activation.monitored

    @property
    def balance(self) -> Balance | None:
        """For the control law, while an arm that was refused is balanced (FD-10)."""
        return self._activation.balance

    def walls(self) -> tuple[WallState, ...]:
        """Walls and areas that hold."""
        return self._containment.states()

    @property
    def baseline(self) -> tuple[float, ...]:
        """F_user that is the sensor's bias, axes of F [N, N·m]; zeros without the flange sensor."""
        return self._bias.baseline

    @property
    def caught(self) -> bool:
        """A wall keeps the arm where it is (VW-6)."""
        return self.arm is not None and self.arm.caught

    @property
    def zones(self) -> tuple[float, ...]:
        """Torques that resist joints before the end of their ranges [N·m]; empty where none is (FD-4)."""
        return self._zones.torque

    @property
    def helping(self) -> bool:
        """The flange sensor helps the hand: not while a payload may have dropped (FD-19)."""
        return self._bias.used and not (self.arm is not None and self.arm.suspect)

    def sense(self, held: bool, signal: Presence) -> None:
        """Begin a tick: the button, and the signal of activation."""
        self._gate.sense(held, signal)
        self.pull = None

    def ask_anew(self) -> bool:
        """The free-drive or restart period is to start again in this tick (FD-16). Returns whether one runs."""
        return self._periods is not None and self._periods.ask_anew()

    def register(self) -> None:
        """A waypoint is registered in this tick, which counts as manipulation (FD-13)."""
        if self._periods is not None:
            self._periods.register()

    def forget(self) -> None:
        """The configured payload changes: what a refusal was to be told by, and was stored, is no more."""
        self._verdict.waiting = False
        self._activation.forget()

    def stop(self, kind: Kind, settings: Settings) -> None:
        """Free-drive or its activation ends because of an event of `kind`, from here or from elsewhere: an emergency stop."""
        self.phase = Phase.OFF
        self.arm = self._periods = None
        self._activation.end()
        self._containment.leave()
        self._zones.leave()
        self._bias.leave()
        self._verdict.waiting = False
        self._gate.close(ticks(settings.free_drive.cool_down) if TABLE[kind].cool_down else 0)

    def step(self, around: Surroundings, settings: Settings) -> Happened:
        """Decide the tick that `sense` began, and become what comes of it."""
        activation = self._activation
        if settings.sequence.stored:
            activation.keep(around, self.phase in KNOWN)
        happened = self._decide(around, settings)
        if happened.transition is not _STAYS:
            self._become(happened, around, settings)
        if activation.posture is not None and self.phase not in KNOWN:
            if happened.transition in OVER and happened.cause not in ASKED_FOR:
                way = self._way_back(activation.posture, around, settings)
                happened = Happened(happened.events + way, happened.transition, happened.cause)
            activation.posture = None
        return happened

    def _decide(self, around: Surroundings, settings: Settings) -> Happened:
        """What happens. Activation and periods go through their phases themselves; `_become` does every other transition."""
        phase = self.phase
        if phase is not _OFF and not around.enabled:
            grip: Values = {"grip": around.grip or ""}
            if phase in IN_FREE_DRIVE:
                return becomes(Transition.LEFT, Event(Kind.LEFT_ENABLING, around.estimate.tick, grip))
            return becomes(Transition.REFUSED, Event(Kind.REFUSED_ENABLING, around.estimate.tick, grip))
        if self.arm is not None and self._periods is not None:
            return self._stay(self.arm, self._periods, around, settings)
        gate = self._gate
        told = self._verdict.step(around, gate.left <= 1) if self._verdict.waiting else []
        if phase is Phase.OFF and not gate.signal.source:
            return Happened(told)
        happened = self._activation.step(around, settings, gate)
        self.phase = self._activation.phase
        return happened.after(told) if told else happened

    def _stay(self, arm: FreeArm, periods: Periods, around: Surroundings, settings: Settings) -> Happened:
        """One tick of free-drive."""
        seen = arm.step(around, settings, periods.waits)
        self.pull = arm.pull
        if seen.transition is _LEFT:
            return seen
        wrench = self._bias.felt(around.estimate)
        happened = periods.step(around, settings, self._gate, user=arm.user, wrench=wrench, pressed=arm.pressed)
        self.phase = periods.phase
        return happened.after(seen.events) if seen.events else happened

    def _become(self, happened: Happened, around: Surroundings, settings: Settings) -> None:
        """Do the transition of a tick in which free-drive does not stay as it is."""
        transition, cause = happened.transition, happened.cause
        if transition is Transition.ENTERED:
            self._enter(around, settings)
        elif transition is Transition.CANCELLED:
            self.phase = Phase.OFF
            self._activation.end()
            self._containment.leave()
        else:
            assert cause is not None  # what refuses and what leaves is an event
            self.stop(cause, settings)
            if cause is Kind.REFUSED_PAYLOAD and self._gate.left > 0:
                self._verdict.begin(around, settings)

    def _enter(self, around: Surroundings, settings: Settings) -> None:
        bias = self._bias
        self._activation.end()
        bias.begin(around.estimate, around.wrench_ok, around.mean)
        joints, wrench = self._joints, bias.felt(around.estimate)
        self._periods = Periods(around, settings, held=self._gate.held, wrench=wrench, joints=joints)
        self.arm = FreeArm(
            around,
            settings,
            bias=bias,
            containment=self._containment,
            zones=self._zones,
            joints=joints,
            rated=self._rated,
        )
        self.phase = self._periods.phase

    def _way_back(self, posture: tuple[float, ...], around: Surroundings, settings: Settings) -> list[Event]:
        """From where the arm is to the `posture` at activation, if it is told (FD-22)."""
        joints = way_back(posture, tuple(around.estimate.q.tolist()), self._joints)
        if not (joints and settings.free_drive.way_back):
            return []
        return [Event(Kind.WAY_BACK, around.estimate.tick, {"joints": joints, "posture": posture_text(posture)})]


_OFF, _STAYS, _LEFT = Phase.OFF, Transition.STAYS, Transition.LEFT  # looked up in every tick
