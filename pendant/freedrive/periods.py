"""The periods of free-drive: what keeps the arm in it, and when nobody does (FD-8a, FD-13 to FD-16). Time is counted in ticks.

A period of N ticks that begins in tick t ends in tick t + N; its remainder is N in tick t and 0 in tick t + N.
"""

import msgspec

from pendant.all_settings import Settings
from pendant.context import Surroundings
from pendant.events.event import Event, Kind, Values
from pendant.events.happened import Happened, Transition, becomes
from pendant.freedrive.gate import Gate
from pendant.freedrive.manipulation import Maintained
from pendant.freedrive.settings import RestartBegins
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate, JointsFeel
from pendant.tick.limit_engine import Excess
from pendant.tick.modes import TICK, Phase
from pendant.tick.pose import Vector, Wrench, norm

RUNNING = {Phase.PERIOD: "free-drive", Phase.RESTART: "restart"}
"""Phases with a period that ends free-drive, with its name for interfaces."""


class Remaining(msgspec.Struct, frozen=True, gc=False):
    """A running period (FD-20)."""

    name: str  # "activation", "free-drive", "restart", ...
    ticks: int  # left, counted down to 0
    total: int  # its whole length


class Periods:
    """One free-drive, from entry to leaving: the button is held, a period runs, or the arm is guided.

    Attributes:
        phase: HELD, PERIOD, GUIDED or RESTART.
    """

    __slots__ = (
        "_anew",
        "_fallen",
        "_joints",
        "_left",
        "_maintained",
        "_pressed",
        "_registered",
        "_stirred",
        "_total",
        "_unpushed",
        "phase",
    )

    def __init__(
        self, around: Surroundings, settings: Settings, *, held: bool, wrench: Wrench | None, joints: tuple[str, ...]
    ) -> None:
        """
        Args:
            around: the tick of entry.
            settings: as they are now.
            held: the button is, so that no period runs yet.
            wrench: F_user without what the sensor drifted by, axes of B [N, N·m]; None: the flange sensor is not used.
            joints: names, base to flange.
        """
        self.phase = Phase.HELD
        self._joints = joints
        self._left = self._total = 0  # ticks of the phase's period
        self._anew = False  # the running period is to start again in this tick
        self._registered = False  # a waypoint was registered in this tick
        self._stirred = False  # there was manipulation in the tick before
        self._unpushed = 0  # ticks for which no hand has pushed
        self._fallen = 0  # ticks for which the arm has at most crept, as its payload may have fallen
        self._pressed = -1  # ticks since a press that began in free-drive, -1 for the press that entered it
        self._maintained: Maintained | None = None  # of the running period
        if not held:
            self._begin(Phase.PERIOD, around, settings, wrench)

    @property
    def runs(self) -> bool:
        """A period runs that ends free-drive."""
        return self.phase in RUNNING

    @property
    def waits(self) -> bool:
        """Nobody is known to move the arm: a period runs, and there was no manipulation in the tick before."""
        return self.phase in RUNNING and not self._stirred

    @property
    def remaining(self) -> Remaining | None:
        """Of the running period (FD-20)."""
        return Remaining(RUNNING[self.phase], self._left, self._total) if self.phase in RUNNING else None

    def ask_anew(self) -> bool:
        """The running period is to start again in this tick (FD-16). Returns whether one runs."""
        self._anew = self.runs
        return self._anew

    def register(self) -> None:
        """A waypoint is registered in this tick, which counts as manipulation (FD-13)."""
        self._registered = True

    def step(
        self,
        around: Surroundings,
        settings: Settings,
        gate: Gate,
        *,
        user: Vector,
        wrench: Wrench | None,
        pressed: Excess | None = None,
    ) -> Happened:
        """One tick, with valid joints.

        Args:
            around: this tick.
            settings: as they are now.
            gate: the button, as sensed in this tick.
            user: the user's force, axes of B [N].
            wrench: as there.
            pressed: the user's force where it is more than can be wrong of it: it counts though it does not change.
        """
        anew, registered = self._anew, self._registered
        self._anew = self._registered = False
        if self.phase is _HELD:
            return self._hold(around, settings, gate.ended, wrench)
        if gate.began:
            self.phase = Phase.HELD
            self._pressed = 0
            return Happened([])
        if self.phase is not Phase.GUIDED:
            return self._count(around, settings, anew=anew, registered=registered, wrench=wrench, pressed=pressed)
        self._unpushed = 0 if norm(user) >= settings.let_go.force else self._unpushed + 1
        self._fallen = self._fallen + 1 if _creeps(around.estimate, settings.unexplained.speed) else 0
        self._left = max(self._left - 1, 0)
        if settings.free_drive.ends_by_period and self._left == 0 and pressed is None and self._rests(around, settings, wrench):
            self._begin(Phase.RESTART, around, settings, wrench)
            return Happened([Event(Kind.RESTARTED, around.estimate.tick, {"period": self._total * TICK})])
        return Happened([])

    def _hold(self, around: Surroundings, settings: Settings, ended: bool, wrench: Wrench | None) -> Happened:
        """The button was held in the tick before."""
        tick = around.estimate.tick
        if self._pressed >= 0:
            self._pressed += 1
        if not ended:
            return Happened([])
        if settings.button.hold_to_run:
            return becomes(Transition.LEFT, Event(Kind.LEFT_RELEASE, tick))
        if 0 <= self._pressed < ticks(settings.button.short_press):
            values: Values = {"value": self._pressed * TICK, "limit": settings.button.short_press}
            return becomes(Transition.LEFT, Event(Kind.LEFT_PRESS, tick, values))
        self._begin(Phase.PERIOD, around, settings, wrench)
        return Happened([])

    def _count(
        self,
        around: Surroundings,
        settings: Settings,
        *,
        anew: bool,
        registered: bool,
        wrench: Wrench | None,
        pressed: Excess | None,
    ) -> Happened:
        """The free-drive or the restart period runs."""
        tick = around.estimate.tick
        if anew:
            self._begin(self.phase, around, settings, wrench)
            return Happened([Event(Kind.PERIOD_ANEW, tick, {"period": self._total * TICK})])
        self._left -= 1
        maintained = self._maintained
        assert maintained is not None
        excess = None if around.shaken else maintained.step(around.estimate, wrench) or pressed
        events: list[Event] = []
        if excess is not None and not self._stirred:
            events.append(Event(Kind.MANIPULATION, tick, dict(excess._asdict())))
        self._stirred = excess is not None
        if excess is not None or registered:
            self._guide(around, settings, maintained, wrench)
        elif self._left == 0:
            kind = Kind.LEFT_PERIOD if self.phase is Phase.PERIOD else Kind.LEFT_RESTART
            return becomes(Transition.LEFT, Event(kind, tick, {"limit": self._total * TICK}), events)
        return Happened(events)

    def _guide(self, around: Surroundings, settings: Settings, maintained: Maintained, wrench: Wrench | None) -> None:
        """The arm is guided: until it rests, or the restart period begins with every tick of it anew (FD-15)."""
        if settings.free_drive.restart_begins is RestartBegins.MANIPULATION:
            self.phase = Phase.RESTART
            self._total = self._left = ticks(min(settings.free_drive.restart_period, settings.free_drive.longest))
            maintained.anew(around.estimate, wrench)
            return
        self.phase, self._stirred, self._unpushed, self._fallen = Phase.GUIDED, False, 0, 0
        # static again: for its whole time after the manipulation began
        self._total = self._left = ticks(settings.static.time)

    def _rests(self, around: Surroundings, settings: Settings, wrench: Wrench | None) -> bool:
        """The guided arm is static again and nobody touches it, or nobody pushes it (FD-15).

        One that has lost its payload may creep, though nobody touches it.
        """
        if self._maintained is not None and self._maintained.touched(around.estimate, wrench):
            return False
        if settings.free_drive.restart_begins is not RestartBegins.FORCE_ENDS:
            return max(around.still.count, self._fallen) >= self._total
        return self._unpushed >= self._total

    def _begin(self, phase: Phase, around: Surroundings, settings: Settings, wrench: Wrench | None) -> None:
        """The free-drive or the restart period begins; where none ends free-drive, the arm counts as guided (FD-24)."""
        use = settings.free_drive
        self.phase = phase if use.ends_by_period else Phase.GUIDED
        self._total = self._left = ticks(min(use.period if phase is Phase.PERIOD else use.restart_period, use.longest))
        self._stirred = False
        self._maintained = Maintained(around.estimate, settings, wrench, self._joints)


def _creeps(estimate: Estimate, moves: float) -> bool:
    """A payload that may have fallen explains all that the joints feel, and the flange is slower than an arm that moves [m/s]."""
    if estimate.whose.joints_feel is not JointsFeel.FALL:
        return False
    x, y, z = estimate.v_F.tolist()[:3]
    return norm((x, y, z)) < moves


_HELD = Phase.HELD  # looked up in every tick
