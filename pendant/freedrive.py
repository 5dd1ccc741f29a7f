"""The phases of free-drive: activation, entry, staying in, leaving (FD-7 to FD-17). Time is counted in ticks.

A period of N ticks that begins in tick t ends in tick t + N; its remainder is N in tick t and 0 in tick t + N.
"""

from typing import NamedTuple

from pendant.attempt import ABSENT, Attempt, Outcome
from pendant.axis_locks import axis_locks
from pendant.barrier import Consequence, Place, Reading
from pendant.containment import NOBODY, Containment, caught, facts
from pendant.decision import Remaining, WallState
from pendant.enabling import Grip
from pendant.estimate import Estimate
from pendant.events import Event, Kind, Values, posture_text
from pendant.hand import Hand
from pendant.joint_zones import JointZones
from pendant.limits import Monitored
from pendant.maintain import Maintained
from pendant.modes import TICK, Mode, Phase
from pendant.nearness import Nearness, SingularityWatch
from pendant.operation import Operation, way_back
from pendant.parameters import ZEROS
from pendant.pose import UNTURNED, Rotation, flat, norm, turned, turned_back
from pendant.sequence import JOINTS_SENSED, SHORTEST, Seen, Sequence, Verdict
from pendant.settings import Settings, Walls, ticks
from pendant.soft_limits import Damping
from pendant.sources import BUTTON, NONE, Presence
from pendant.stored import Stored
from pendant.table import TABLE, Effect
from pendant.walls import AnyBorder, Start
from pendant.watch import Stillness, WrenchMean, joints_ok
from pendant.zeroing import Drift, Six, Steps

NAMES = {
    Phase.ACTIVATION: "activation",
    Phase.FEEDBACK: "feedback",
    Phase.CONFIRM: "confirmation",
    Phase.LET_GO: "let go",
}
"""Of the periods before the sequence, for interfaces."""

ASKED_FOR = frozenset({Kind.LEFT_PRESS, Kind.LEFT_RELEASE, Kind.DEACTIVATED})
"""Leavings that the user asked for: nobody has to be told the way back (FD-22)."""

IN_FREE_DRIVE = frozenset({Phase.HELD, Phase.PERIOD, Phase.GUIDED, Phase.RESTART})

KNOWN = IN_FREE_DRIVE | {Phase.SEQUENCE}
"""Phases in which the posture at activation is remembered."""


class Surroundings(NamedTuple):
    """What free-drive must know of the rest in one tick."""

    estimate: Estimate
    mode: Mode
    wrench_ok: bool  # pendant.watch.wrench_ok
    still: Stillness
    mean: WrenchMean  # of F_user
    grip: Grip | None = None  # of the enabling device, None where none is needed
    hand_off: bool = True  # no hand is felt (FD-8a)
    felt: float = 0.0  # change of the force at the flange from the untouched state [N]
    changing: float | None = None  # the configured payload by now, while it is being changed [kg]
    guided: bool = False  # a step of a program asks for free-drive (CD-15)
    shaken: bool = False  # haptic feedback moves the arm: not what a hand does (FD-19)

    @property
    def enabled(self) -> bool:
        """No enabling device forbids motion."""
        return self.grip is None or self.grip is Grip.MIDDLE


class FreeDrive:
    """State machine of the phases. Its events say what becomes of the mode; it changes no mode itself."""

    __slots__ = (
        "_absent",
        "_anew",
        "_appeared",
        "_attempt",
        "_began",
        "_blocked",
        "_containment",
        "_cool",
        "_cool_total",
        "_drift",
        "_ended",
        "_hand",
        "_held",
        "_joints",
        "_left",
        "_maintained",
        "_operation",
        "_posture",
        "_pressed",
        "_rated",
        "_registered",
        "_sequence",
        "_signal",
        "_singularity",
        "_steps",
        "_stirred",
        "_stored",
        "_total",
        "_turned",
        "_unpushed",
        "_verdict",
        "_zones",
        "baseline",
        "caught",
        "phase",
        "use_wrench",
    )

    def __init__(self, joints: tuple[str, ...], rated: tuple[float, ...], containment: Containment, zones: JointZones) -> None:
        """
        Args:
            joints: the names used in events, base to flange.
            rated: torque of each joint [N·m].
            containment: walls and areas.
            zones: before the joint limits.
        """
        self.phase = Phase.OFF
        self.baseline: tuple[float, ...] = ZEROS
        self.use_wrench = False  # since entry the flange sensor was valid in every tick
        self._joints = joints
        self._rated = rated
        self._sequence: Sequence | None = None
        self._verdict = Verdict()
        self._left = 0  # ticks left of the phase's period
        self._total = 0
        self._cool = 0  # ticks left of the cool-down (FD-12c)
        self._cool_total = 0
        self._blocked = False  # the signal was present at a refusal or a leaving
        self._absent = ABSENT  # ticks without the signal
        self._signal = NONE  # of activation, in this tick
        self._appeared = False  # it did in this tick
        self._anew = False  # the running period is to begin anew in this tick
        self._registered = False  # a waypoint was registered in this tick
        self._stirred = False  # there was manipulation in the tick before
        self._unpushed = 0  # ticks for which no hand has pushed
        self._attempt: Attempt | None = None
        self._held = False  # the button, as sensed in this tick
        self._began = False
        self._ended = False
        self._pressed = -1  # ticks since a press that began in free-drive, -1 for the press that entered it
        self._maintained: Maintained | None = None
        self._containment = containment
        self._zones = zones
        self._singularity = SingularityWatch()
        self._hand: Hand | None = None
        self._operation: Operation | None = None
        self._stored = Stored()  # for the sequence to compare with
        self._drift, self._steps = Drift(), Steps()  # of the flange sensor's zero
        self._turned: Rotation = UNTURNED  # orientation of the flange in B at entry, in which `baseline` is
        self._posture: tuple[float, ...] | None = None  # at activation (FD-22)
        self.caught = False  # a wall keeps the arm where it is (VW-6)

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        values = [getattr(self, name) for name in self.__slots__]
        return tuple([getattr(value, "memory", value) for value in values])

    @property
    def idle(self) -> bool:
        """Nothing runs that would have to be published."""
        return self.phase is Phase.OFF and self._cool == 0

    def periods(self) -> tuple[Remaining, ...]:
        """Every running period (FD-20)."""
        running: list[Remaining] = []
        attempt = self._attempt
        if attempt is not None:
            running.append(Remaining(NAMES[attempt.phase], attempt.left, attempt.total))
        elif self.phase is Phase.SEQUENCE:
            running.append(Remaining("sequence", self._left, self._total))
        elif self.phase is Phase.PERIOD:
            running.append(Remaining("free-drive", self._left, self._total))
        elif self.phase is Phase.RESTART:
            running.append(Remaining("restart", self._left, self._total))
        if self._cool > 0:
            running.append(Remaining("cool-down", self._cool, self._cool_total))
        return tuple(running)

    def monitored(self) -> tuple[Monitored, ...]:
        """What the activation sequence checks, while it runs."""
        return self._sequence.monitored() if self._sequence is not None else ()

    def walls(self) -> tuple[WallState, ...]:
        """Walls and areas that hold."""
        return self._containment.states()

    def places(self, walls: Walls) -> tuple[tuple[AnyBorder, Place], ...]:
        """Every wall and area that holds, and every area that will in free-drive, with where its shape lies."""
        hold = self._containment.places()
        names = [border.name for border, _ in hold]
        return hold + tuple([pair for pair in self._containment.resting(walls) if pair[0].name not in names])

    @property
    def damping(self) -> Damping | None:
        """Where free motion is resisted before a limit on its speed (FD-12b)."""
        return None if self._operation is None else self._operation.damping

    @property
    def singularity(self) -> Nearness | None:
        """How near the arm is to a singularity, None outside of free-drive (FD-4)."""
        return None if self._operation is None else self._singularity.status

    @property
    def zones(self) -> tuple[float, ...]:
        """Torques that resist joints before the end of their ranges [N·m]; empty where none is (FD-4)."""
        return self._zones.torque

    @property
    def helping(self) -> bool:
        """The user's force is amplified: not while a payload may have dropped (FD-19)."""
        return self.use_wrench and not (self._operation is not None and self._operation.suspect)

    def sense(self, held: bool, signal: Presence) -> None:
        """Begin a tick: the button, the signal of activation, the cool-down, the absence of the signal."""
        self._anew = self._registered = False
        self._appeared = bool(signal.source) and not self._signal.source
        self._signal = signal
        self._began = held and not self._held
        self._ended = self._held and not held
        self._held = held
        if self._cool > 0:
            self._cool -= 1
        self._absent = 0 if held or signal.source else min(self._absent + 1, ABSENT)
        if self._absent == ABSENT:
            self._blocked = False
        elif signal.by_hand and self._cool > 0:
            self._blocked = True

    def ask_anew(self) -> bool:
        """The free-drive or restart period is to begin anew in this tick (FD-16). Returns whether one runs."""
        self._anew = self.phase in (Phase.PERIOD, Phase.RESTART)
        return self._anew

    def register(self) -> None:
        """A waypoint is registered in this tick, which counts as manipulation (FD-13)."""
        self._registered = True

    def step(self, around: Surroundings, settings: Settings) -> list[Event]:
        """Decide the tick that `sense` began. Returns what happened, in order."""
        if settings.sequence.stored:
            self._keep(around)
        events = self._decide(around, settings)
        if self._posture is not None and self.phase not in KNOWN:
            if events and TABLE[events[-1].kind].effect is not Effect.INFO and events[-1].kind not in ASKED_FOR:
                joints = way_back(self._posture, tuple(around.estimate.q.tolist()), self._joints)
                if joints and settings.free_drive.way_back:
                    events.append(
                        Event(Kind.WAY_BACK, around.estimate.tick, {"joints": joints, "posture": posture_text(self._posture)})
                    )
            self._posture = None
        return events

    def _keep(self, around: Surroundings) -> None:
        """Keep the state of an arm that is held, before anybody tries to free it (FD-9)."""
        estimate = around.estimate
        if self.phase in KNOWN or (around.mode is Mode.RUN and around.still.count == 0):
            self._stored.forget()
        elif self.phase is Phase.OFF and self._stored.due(estimate.tick):
            if joints_ok(estimate):
                self._stored.keep(estimate, around.wrench_ok, around.mean)
            else:
                self._stored.forget()

    def _decide(self, around: Surroundings, settings: Settings) -> list[Event]:
        if not around.enabled and self.phase is not Phase.OFF:
            return [self._disabled(around, settings)]
        if self.phase in IN_FREE_DRIVE:
            return self._stay(around, settings)
        if self.phase is Phase.SEQUENCE:
            return self._check(around, settings)
        events = self._verdict.step(seen(around), self._cool <= 1) if self._verdict.waiting else []
        if self._signal.source or self._attempt is not None:
            return events + self._activate(around, settings)
        return events

    def stop(self, kind: Kind, settings: Settings) -> None:
        """Free-drive or its activation ends because of an event of `kind` from elsewhere, such as an emergency stop."""
        self._end(kind, settings)

    def forget(self) -> None:
        """The configured payload changes: what a refusal was to be told by, and was stored, is no more."""
        self._verdict.waiting = False
        self._stored.forget()

    def _activate(self, around: Surroundings, settings: Settings) -> list[Event]:
        """The signal is present and free-drive is not on."""
        tick = around.estimate.tick
        events: list[Event] = []
        if self.phase is Phase.OFF and (self._blocked or self._cool > 0):
            return [Event(Kind.NOT_YET, tick, {"remaining": self._cool * TICK})] if self._appeared else events
        attempt = self._attempt
        counting = attempt is not None and attempt.phase is Phase.ACTIVATION and not self._signal.source
        if not counting and not around.guided and not may_enter(around.mode, settings):
            return [self._over(Kind.REFUSED_MODE, tick, settings, {"mode": around.mode, "allowed": origins(settings)})]
        if not around.enabled:
            return [self._disabled(around, settings)]
        if attempt is None:
            attempt = self._attempt = Attempt(self._signal, settings)
            self._containment.begin(Start.ACTIVATION, settings.walls)
            events.append(_started(attempt, tick))
            outcome = attempt.first()
        else:
            static = around.still.count >= ticks(settings.static.time)  # an arm that a hand has left still swings
            outcome = attempt.step(self._signal, around.hand_off and static)
        self.phase = attempt.phase
        if outcome is Outcome.CANCELLED:
            self._give_up()
            limit = attempt.total * TICK
            return [*events, Event(Kind.ACTIVATION_CANCELLED, tick, {"value": attempt.present, "limit": limit})]
        if joints_ok(around.estimate):  # a wall may be anchored here already (VW-6)
            reading = self._containment.step(around.estimate, *NOBODY)
            if reading is not None:
                events.append(self._refuse_wall(reading, tick, settings))
                return events
        if outcome is Outcome.READY:
            events += self._end_activation(attempt.confirmed, around, settings)
        elif outcome is not Outcome.GOES_ON:
            events.append(self._ask(outcome, attempt, around, settings))
        return events

    def _ask(self, outcome: Outcome, attempt: Attempt, around: Surroundings, settings: Settings) -> Event:
        """A confirmation or hands off is asked for, or was asked for and did not come."""
        tick, handshake, off = around.estimate.tick, settings.handshake, settings.let_go
        if outcome is Outcome.CONFIRM:
            values: Values = {"source": attempt.source, "feedback": handshake.feedback, "window": handshake.window}
            return Event(Kind.CONFIRM_ASKED, tick, values)
        if outcome is Outcome.UNCONFIRMED:
            values = {"source": attempt.source, "limit": handshake.window}
            return self._over(Kind.REFUSED_UNCONFIRMED, tick, settings, values)
        values = {"force": around.felt, "limit": off.force, "within": off.within}
        if outcome is Outcome.LET_GO:
            return Event(Kind.LET_GO_ASKED, tick, values)
        return self._over(Kind.REFUSED_STILL_HELD, tick, settings, values)

    def _give_up(self) -> None:
        """The attempt ends without a cause to refuse it."""
        self.phase = Phase.OFF
        self._attempt = None
        self._containment.leave()
        self._zones.leave()

    def _end_activation(self, confirmed: bool, around: Surroundings, settings: Settings) -> list[Event]:
        """The signal was present for long enough: from rest, try the arm, or enter at once where there is no sequence."""
        tick = around.estimate.tick
        if not joints_ok(around.estimate):
            return [self._over(Kind.REFUSED_SENSORS, tick, settings, {"sensor": JOINTS_SENSED})]
        if around.changing is not None:
            return [self._over(Kind.REFUSED_CHANGING, tick, settings, {"mass": around.changing})]
        if around.still.count < ticks(settings.static.time):
            values = moving(around.still, self._joints, settings)
            return [self._over(Kind.REFUSED_MOVING, tick, settings, values)]
        self._posture = tuple(around.estimate.q.tolist())
        if not settings.sequence.on:
            return [self._enter(around, settings)]
        use, stored = settings.sequence, None
        if use.stored:
            stored = self._stored.of(tick, ticks(use.age), around.wrench_ok)
            if stored is None:
                return [self._over(Kind.REFUSED_NOT_STORED, tick, settings, {"age": use.age})]
        elif use.period < SHORTEST and not confirmed:
            return [self._over(Kind.REFUSED_SHORT, tick, settings, {"value": use.period, "limit": SHORTEST})]
        self._attempt = None
        self.phase = Phase.SEQUENCE
        self._total = self._left = ticks(use.period)
        self._sequence = Sequence(seen(around), settings, self._joints, self._rated, stored)
        self.use_wrench = around.wrench_ok
        self.baseline = around.mean.mean()
        self._containment.begin(Start.SEQUENCE, settings.walls)
        events = [Event(Kind.SEQUENCE_STARTED, tick, {"period": self._total * TICK}), *self._judge(around, settings)]
        if self._total == 0 and len(events) == 1:
            events.append(self._enter(around, settings))
        return events

    def _check(self, around: Surroundings, settings: Settings) -> list[Event]:
        """The activation sequence runs; the button does not matter any more (FD-8a)."""
        self._left -= 1
        if not around.guided and not may_enter(around.mode, settings):
            values: Values = {"mode": around.mode, "allowed": origins(settings)}
            return [self._over(Kind.REFUSED_MODE, around.estimate.tick, settings, values)]
        events = self._judge(around, settings)
        if not events and self._left == 0:
            events.append(self._enter(around, settings))
        return events

    def _judge(self, around: Surroundings, settings: Settings) -> list[Event]:
        """One tick of the sequence; what refuses free-drive."""
        sequence = self._sequence
        assert sequence is not None
        now = seen(around)
        missing = sequence.missing(now)
        if missing:
            return [self._over(Kind.REFUSED_SENSORS, around.estimate.tick, settings, {"sensor": missing})]
        beyond = sequence.check(now)
        reading = self._containment.step(around.estimate, *NOBODY)
        if not beyond and reading is not None:
            return [self._refuse_wall(reading, around.estimate.tick, settings)]
        if not beyond:
            return []
        events = sequence.reasons(beyond, now, settings)
        self._end(events[-1].kind, settings)
        if events[-1].kind is Kind.REFUSED_PAYLOAD and self._cool > 0:
            self._verdict.begin(now)
        return events

    def _enter(self, around: Surroundings, settings: Settings) -> Event:
        self.phase = Phase.HELD if self._held else Phase.PERIOD
        self._attempt = None
        self._sequence = None
        self._pressed = -1
        self.use_wrench = around.wrench_ok
        self.baseline = around.mean.mean()
        if self.phase is Phase.PERIOD:
            self._begin(Phase.PERIOD, around, settings)
        self._hand = Hand(around.estimate, self.baseline)
        self._drift, self._steps, self._turned = Drift(), Steps(), flat(around.estimate.R_BF)
        self._operation = Operation(around.estimate, settings, self.baseline, self._joints, self._rated)
        self._containment.enter(settings.walls)
        self._zones.enter(settings.joint_limits)
        self._singularity = SingularityWatch()
        self._containment.step(around.estimate, *NOBODY)
        gain = settings.free_drive.gain if self.use_wrench else 0.0
        return Event(Kind.ENTERED, around.estimate.tick, {"from": around.mode, "gain": gain})

    def _stay(self, around: Surroundings, settings: Settings) -> list[Event]:
        tick = around.estimate.tick
        if not joints_ok(around.estimate):
            return [self._over(Kind.SENSORS_LOST, tick, settings, {"sensor": JOINTS_SENSED})]
        events: list[Event] = []
        if self.use_wrench and not around.wrench_ok:
            self.use_wrench = False
            self.baseline = ZEROS
            events.append(Event(Kind.WRENCH_LOST, tick))
        if self._contain(around, settings, events):
            return events
        if self.phase is Phase.HELD:
            self._hold(around, settings, events)
        elif self._began:
            self.phase = Phase.HELD
            self._pressed = 0
        elif self.phase is Phase.GUIDED:
            assert self._hand is not None
            self._unpushed = 0 if norm(self._hand.user) >= settings.let_go.force else self._unpushed + 1
            self._left = max(self._left - 1, 0)
            if settings.free_drive.maintained and self._left == 0 and self._rests(around, settings):
                self._begin(Phase.RESTART, around, settings)
                events.append(Event(Kind.RESTARTED, tick, {"period": self._total * TICK}))
        else:
            self._count(around, settings, events)
        return events

    def _contain(self, around: Surroundings, settings: Settings, events: list[Event]) -> bool:
        """Walls and areas in free-drive (VW-6). Returns whether free-drive is left."""
        estimate = around.estimate
        hand = self._hand
        assert hand is not None
        hand.step(estimate, self.use_wrench)
        if self.use_wrench and settings.unexplained.sensor:
            self._zero(around, hand, events)
        reading = self._containment.step(estimate, hand.user, hand.payload)
        before, self.caught = self.caught, caught(reading)
        if reading is not None and not self.caught:
            kind = Kind.STOPPED_WALL if reading.consequence is Consequence.STOP else Kind.LEFT_WALL
            events.append(self._over(kind, estimate.tick, settings, facts(reading)))
            return True
        if reading is not None and not before:
            events.append(Event(Kind.WALL_REACHED, estimate.tick, facts(reading)))
        assert self._operation is not None
        self._zones.step(estimate)
        if self._singularity.step(estimate.singularity, settings.axes) and axis_locks(settings.axes) is not None:
            values: Values = {"status": self._singularity.status, "value": estimate.singularity, "limit": settings.axes.near}
            events.append(Event(Kind.SINGULARITY, estimate.tick, values))
        ending = self._operation.step(estimate, hand, self.use_wrench, around.shaken or self.caught or self._zones.pushing)
        if ending is None:
            return False
        events.append(self._over(ending.kind, estimate.tick, settings, ending.values))
        return True

    def _zero(self, around: Surroundings, hand: Hand, events: list[Event]) -> None:
        """What the flange sensor drifts by is taken off the hand; one that steps is not used any more (FD-19)."""
        estimate = around.estimate
        stepped = self._steps.step(estimate, hand.change)
        if stepped is not None:
            self.use_wrench, self.baseline = False, ZEROS
            events.append(Event(Kind.SENSOR_STEPPED, estimate.tick, {"force": norm(stepped)}))
        elif self.phase not in (Phase.PERIOD, Phase.RESTART):
            self._drift.restart()
        elif self._drift.due():
            gone = self._drift.step(around.mean.mean())
            if gone is not None:
                self._take_off(gone, estimate, hand)

    def _take_off(self, gone: Six, estimate: Estimate, hand: Hand) -> None:
        """`gone` [N, N·m], axes of B now, is an offset of the sensor."""
        R_BF = flat(estimate.R_BF)
        force, torque = turned_back(R_BF, (gone[0], gone[1], gone[2])), turned_back(R_BF, (gone[3], gone[4], gone[5]))
        hand.shift(force)
        at_entry = (*turned(self._turned, force), *turned(self._turned, torque))
        self.baseline = tuple([a + b for a, b in zip(self.baseline, at_entry, strict=True)])

    def _refuse_wall(self, reading: Reading, tick: int, settings: Settings) -> Event:
        """The activation shape is exceeded (VW-6, FD-10)."""
        values = facts(reading)
        if settings.sequence.protective_stop:
            metres = float(values["distance"]) / 1000.0
            values = {"parameter": f"wall {values['wall']}", "part": values["part"], "value": metres, "limit": 0.0, "unit": "m"}
            return self._over(Kind.SEQUENCE_STOPPED, tick, settings, values)
        return self._over(Kind.REFUSED_WALL, tick, settings, values)

    def _hold(self, around: Surroundings, settings: Settings, events: list[Event]) -> None:
        """The button was held in the tick before."""
        tick = around.estimate.tick
        if self._pressed >= 0:
            self._pressed += 1
        if not self._ended:
            return
        if settings.button.hold_to_run:
            events.append(self._over(Kind.LEFT_RELEASE, tick, settings, {}))
        elif 0 <= self._pressed < ticks(settings.button.short_press):
            values: Values = {"value": self._pressed * TICK, "limit": settings.button.short_press}
            events.append(self._over(Kind.LEFT_PRESS, tick, settings, values))
        else:
            self._begin(Phase.PERIOD, around, settings)

    def _count(self, around: Surroundings, settings: Settings, events: list[Event]) -> None:
        """The free-drive or the restart period runs."""
        tick = around.estimate.tick
        if self._anew:
            self._begin(self.phase, around, settings)
            events.append(Event(Kind.PERIOD_ANEW, tick, {"period": self._total * TICK}))
            return
        self._left -= 1
        assert self._maintained is not None
        excess = None if around.shaken else self._maintained.step(around.estimate, self.use_wrench)
        began = excess is not None and not self._stirred
        self._stirred = excess is not None
        if began and excess is not None:
            events.append(Event(Kind.MANIPULATION, tick, dict(excess._asdict())))
        if excess is not None or self._registered:
            self._guide(around, settings)
        elif self._left == 0:
            kind = Kind.LEFT_PERIOD if self.phase is Phase.PERIOD else Kind.LEFT_RESTART
            events.append(self._over(kind, tick, settings, {"limit": self._total * TICK}))

    def _guide(self, around: Surroundings, settings: Settings) -> None:
        """The arm is guided: until it rests, or the restart period begins with every tick of it anew (FD-15)."""
        if settings.free_drive.restart_at_manipulation and self._maintained is not None:
            self.phase = Phase.RESTART
            self._total = self._left = ticks(min(settings.free_drive.restart_period, settings.free_drive.longest))
            self._maintained.anew(around.estimate, self.use_wrench)
            return
        self.phase, self._stirred, self._unpushed = Phase.GUIDED, False, 0
        # static again: for its whole time after the manipulation began
        self._total = self._left = ticks(settings.static.time)

    def _rests(self, around: Surroundings, settings: Settings) -> bool:
        """The guided arm is static again, or nobody pushes it (FD-15)."""
        if not settings.free_drive.restart_after_force:
            return around.still.count >= self._total
        return self._unpushed >= self._total

    def _begin(self, phase: Phase, around: Surroundings, settings: Settings) -> None:
        """The free-drive or the restart period begins; where none ends free-drive, the arm counts as guided (FD-24)."""
        use = settings.free_drive
        self.phase = phase if use.maintained else Phase.GUIDED
        self._total = self._left = ticks(min(use.period if phase is Phase.PERIOD else use.restart_period, use.longest))
        self._stirred = False
        self._maintained = Maintained(around.estimate, settings, self.use_wrench, self._joints)

    def _disabled(self, around: Surroundings, settings: Settings) -> Event:
        """The enabling device is not in its middle position."""
        kind = Kind.LEFT_ENABLING if self.phase in IN_FREE_DRIVE else Kind.REFUSED_ENABLING
        return self._over(kind, around.estimate.tick, settings, {"grip": around.grip or ""})

    def _over(self, kind: Kind, tick: int, settings: Settings, values: Values) -> Event:
        """Free-drive is left, or its activation refused, because of an event of `kind`."""
        self._end(kind, settings)
        return Event(kind, tick, values)

    def _end(self, kind: Kind, settings: Settings) -> None:
        self.phase = Phase.OFF
        self._attempt = None
        self.use_wrench = False
        self.baseline = ZEROS
        self._sequence = None
        self._maintained = None
        self._hand = None
        self._operation = None
        self.caught = False
        self._containment.leave()
        self._zones.leave()
        self._verdict.waiting = False
        self._blocked = self._held or bool(self._signal.source)
        if TABLE[kind].cool_down:
            self._cool = self._cool_total = ticks(settings.free_drive.cool_down)


def _started(attempt: Attempt, tick: int) -> Event:
    values: Values = {"period": attempt.total * TICK}
    if attempt.source == BUTTON.source:
        return Event(Kind.ACTIVATION_STARTED, tick, values)
    return Event(Kind.SIGNAL_SEEN, tick, {"source": attempt.source, **values})


def seen(around: Surroundings) -> Seen:
    """What the sequence needs of the surroundings."""
    return Seen(around.estimate, around.wrench_ok, around.mean)


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
