"""The phases of free-drive: activation, entry, staying in, leaving (FD-7 to FD-17). Time is counted in ticks.

A period of N ticks that begins in tick t ends in tick t + N; its remainder is N in tick t and 0 in tick t + N.
"""

from typing import NamedTuple

from pendant.decision import Remaining
from pendant.estimate import Estimate
from pendant.events import Event, Kind, Values
from pendant.maintain import ZEROS, Reference, manipulation, reference
from pendant.modes import TICK, Mode, Phase
from pendant.settings import Settings, ticks
from pendant.table import TABLE
from pendant.watch import Stillness, WrenchMean, joints_ok

ABSENT = ticks(0.2)
"""A signal present at a refusal or a leaving counts again after an absence of so many ticks (FD-7)."""

IN_FREE_DRIVE = frozenset({Phase.HELD, Phase.PERIOD, Phase.GUIDED, Phase.RESTART})

SENSOR = "joint encoders and motor currents"


class Surroundings(NamedTuple):
    """What free-drive must know of the rest in one tick."""

    estimate: Estimate
    mode: Mode
    wrench_ok: bool  # pendant.watch.wrench_ok
    still: Stillness
    mean: WrenchMean  # of F_user


class FreeDrive:
    """State machine of the phases. Its events say what becomes of the mode; it changes no mode itself."""

    __slots__ = (
        "_absent",
        "_began",
        "_blocked",
        "_cool",
        "_cool_total",
        "_ended",
        "_held",
        "_joints",
        "_left",
        "_pressed",
        "_since",
        "_total",
        "baseline",
        "phase",
        "use_wrench",
    )

    def __init__(self, joints: tuple[str, ...]) -> None:
        """`joints` are the names used in events, base to flange."""
        self.phase = Phase.OFF
        self.baseline: tuple[float, ...] = ZEROS
        self.use_wrench = False  # since entry the flange sensor was valid in every tick
        self._joints = joints
        self._left = 0  # ticks left of the phase's period
        self._total = 0
        self._cool = 0  # ticks left of the cool-down (FD-12c)
        self._cool_total = 0
        self._blocked = False  # the signal was present at a refusal or a leaving
        self._absent = ABSENT  # ticks without the signal
        self._held = False  # the button, as sensed in this tick
        self._began = False
        self._ended = False
        self._pressed = -1  # ticks since a press that began in free-drive, -1 for the press that entered it
        self._since = Reference(ZEROS, (0.0,) * len(joints))

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return tuple(getattr(self, name) for name in self.__slots__)

    @property
    def idle(self) -> bool:
        """Nothing runs that would have to be published."""
        return self.phase is Phase.OFF and self._cool == 0

    def periods(self) -> tuple[Remaining, ...]:
        """Every running period (FD-20)."""
        running: list[Remaining] = []
        if self.phase is Phase.ACTIVATION:
            running.append(Remaining("activation", self._left, self._total))
        elif self.phase is Phase.PERIOD:
            running.append(Remaining("free-drive", self._left, self._total))
        elif self.phase is Phase.RESTART:
            running.append(Remaining("restart", self._left, self._total))
        if self._cool > 0:
            running.append(Remaining("cool-down", self._cool, self._cool_total))
        return tuple(running)

    def sense(self, held: bool) -> None:
        """Begin a tick: the button, the cool-down, the absence of the signal."""
        self._began = held and not self._held
        self._ended = self._held and not held
        self._held = held
        if self._cool > 0:
            self._cool -= 1
        self._absent = 0 if held else min(self._absent + 1, ABSENT)
        if self._absent == ABSENT:
            self._blocked = False

    def step(self, around: Surroundings, settings: Settings) -> list[Event]:
        """Decide the tick that `sense` began. Returns what happened, in order."""
        if self.phase in IN_FREE_DRIVE:
            return self._stay(around, settings)
        if self._held:
            return self._activate(around, settings)
        if self.phase is Phase.ACTIVATION:
            values: Values = {"value": (self._total - self._left + 1) * TICK, "limit": self._total * TICK}
            self.phase = Phase.OFF
            return [Event(Kind.ACTIVATION_CANCELLED, around.estimate.tick, values)]
        return []

    def stop(self, kind: Kind, settings: Settings) -> None:
        """Free-drive or its activation ends because of an event of `kind` from elsewhere, such as an emergency stop."""
        self._end(kind, settings)

    def _activate(self, around: Surroundings, settings: Settings) -> list[Event]:
        """The signal is present and free-drive is not on."""
        tick = around.estimate.tick
        events: list[Event] = []
        if self.phase is Phase.OFF and (self._blocked or self._cool > 0):
            return [Event(Kind.NOT_YET, tick, {"remaining": self._cool * TICK})] if self._began else events
        if not may_enter(around.mode, settings):
            return [self._refuse(Kind.REFUSED_MODE, tick, settings, {"mode": around.mode, "allowed": origins(settings)})]
        if self.phase is Phase.OFF:
            self.phase = Phase.ACTIVATION
            self._total = self._left = ticks(settings.activation.period)
            events.append(Event(Kind.ACTIVATION_STARTED, tick, {"period": self._total * TICK}))
        else:
            self._left -= 1
        if self._left == 0:
            # The activation sequence (FD-9 to FD-12) belongs between here and the entry: a phase of its own.
            events.append(self._enter(around, settings))
        return events

    def _enter(self, around: Surroundings, settings: Settings) -> Event:
        tick = around.estimate.tick
        if not joints_ok(around.estimate):
            return self._refuse(Kind.REFUSED_SENSORS, tick, settings, {"sensor": SENSOR})
        if around.still.count < ticks(settings.static.time):
            values = moving(around.still, self._joints, settings)
            return self._refuse(Kind.REFUSED_MOVING, tick, settings, values)
        self.phase = Phase.HELD
        self._pressed = -1
        self.use_wrench = around.wrench_ok
        self.baseline = around.mean.mean()
        gain = settings.free_drive.gain if self.use_wrench else 0.0
        return Event(Kind.ENTERED, tick, {"from": around.mode, "gain": gain})

    def _stay(self, around: Surroundings, settings: Settings) -> list[Event]:
        tick = around.estimate.tick
        if not joints_ok(around.estimate):
            return [self._leave(Kind.SENSORS_LOST, tick, settings, {"sensor": SENSOR})]
        events: list[Event] = []
        if self.use_wrench and not around.wrench_ok:
            self.use_wrench = False
            self.baseline = ZEROS
            events.append(Event(Kind.WRENCH_LOST, tick))
        if self.phase is Phase.HELD:
            self._hold(around, settings, events)
        elif self._began:
            self.phase = Phase.HELD
            self._pressed = 0
        elif self.phase is Phase.GUIDED:
            self._left = max(self._left - 1, 0)
            if self._left == 0 and around.still.count >= self._total:
                self._begin(Phase.RESTART, settings.free_drive.restart_period, around)
                events.append(Event(Kind.RESTARTED, tick, {"period": self._total * TICK}))
        else:
            self._count(around, settings, events)
        return events

    def _hold(self, around: Surroundings, settings: Settings, events: list[Event]) -> None:
        """The button was held in the tick before."""
        tick = around.estimate.tick
        if self._pressed >= 0:
            self._pressed += 1
        if not self._ended:
            return
        if settings.button.hold_to_run:
            events.append(self._leave(Kind.LEFT_RELEASE, tick, settings, {}))
        elif 0 <= self._pressed < ticks(settings.button.short_press):
            values: Values = {"value": self._pressed * TICK, "limit": settings.button.short_press}
            events.append(self._leave(Kind.LEFT_PRESS, tick, settings, values))
        else:
            self._begin(Phase.PERIOD, settings.free_drive.period, around)

    def _count(self, around: Surroundings, settings: Settings, events: list[Event]) -> None:
        """The free-drive or the restart period runs."""
        tick = around.estimate.tick
        self._left -= 1
        excess = manipulation(around.estimate, self._since, settings.maintain, self.use_wrench)
        if excess is not None:
            self.phase = Phase.GUIDED
            # static again: for its whole time after the manipulation began
            self._total = self._left = ticks(settings.static.time)
            events.append(Event(Kind.MANIPULATION, tick, dict(excess._asdict())))
        elif self._left == 0:
            kind = Kind.LEFT_PERIOD if self.phase is Phase.PERIOD else Kind.LEFT_RESTART
            events.append(self._leave(kind, tick, settings, {"limit": self._total * TICK}))

    def _begin(self, phase: Phase, seconds: float, around: Surroundings) -> None:
        self.phase = phase
        self._total = self._left = ticks(seconds)
        self._since = reference(around.estimate, self.use_wrench)

    def _refuse(self, kind: Kind, tick: int, settings: Settings, values: Values) -> Event:
        self._end(kind, settings)
        return Event(kind, tick, values)

    def _leave(self, kind: Kind, tick: int, settings: Settings, values: Values) -> Event:
        self._end(kind, settings)
        return Event(kind, tick, values)

    def _end(self, kind: Kind, settings: Settings) -> None:
        self.phase = Phase.OFF
        self.use_wrench = False
        self.baseline = ZEROS
        self._blocked = self._held
        if TABLE[kind].cool_down:
            self._cool = self._cool_total = ticks(settings.free_drive.cool_down)


def moving(still: Stillness, joints: tuple[str, ...], settings: Settings) -> Values:
    """Values of an event that says that the arm moves."""
    return {"joint": joints[still.joint], "value": still.speed, "limit": settings.static.speed, "time": settings.static.time}


def may_enter(mode: Mode, settings: Settings) -> bool:
    """Free-drive can be entered from `mode` (FD-1)."""
    allowed = settings.free_drive.allowed_from
    return (
        (mode is Mode.TEACH and allowed.teach) or (mode is Mode.NORMAL and allowed.normal) or (mode is Mode.RUN and allowed.run)
    )


def origins(settings: Settings) -> str:
    """The modes from which free-drive can be entered, as text."""
    return ", ".join(mode for mode in Mode if may_enter(mode, settings)) or "none"
