"""The activation of free-drive: from the signal through the sequence to entry or its refusal (FD-7 to FD-12)."""

from pendant.all_settings import Settings
from pendant.context import Surroundings
from pendant.events.event import Event, Kind, Values
from pendant.events.happened import Happened, Transition, becomes
from pendant.freedrive.adaptive_gravity import Balance, Compensation
from pendant.freedrive.attempt import Attempt, Outcome, asked, reserved, started
from pendant.freedrive.gate import Gate
from pendant.freedrive.origins import may_enter, origins, teach_first
from pendant.freedrive.periods import Remaining
from pendant.freedrive.sequence import SHORTEST, Sequence
from pendant.freedrive.settings import BeyondLimit
from pendant.guided.sensor_bias import SensorBias
from pendant.limits.validity import JOINTS_SENSED, joints_ok
from pendant.settings.schema import ticks
from pendant.signals.stored_baseline import Stored
from pendant.tick.limit_engine import Monitored
from pendant.tick.modes import TICK, Mode, Phase
from pendant.walls.barrier import Reading
from pendant.walls.containment import NOBODY, Containment, facts
from pendant.walls.definitions import Start

NAMES = {
    Phase.ACTIVATION: "activation",
    Phase.DELAY: "delay",
    Phase.FEEDBACK: "feedback",
    Phase.CONFIRM: "confirmation",
    Phase.LET_GO: "let go",
}
"""Of the periods of an attempt, for interfaces."""

FAILED = frozenset({Outcome.UNCONFIRMED, Outcome.STILL_HELD})
"""Outcomes that refuse free-drive."""


class Activation:
    """One attempt after the other. Each tick says what becomes of free-drive; who follows a transition calls `end`.

    Attributes:
        phase: OFF, one of an attempt, or SEQUENCE.
        posture: of the joints, when the attempt's signal was complete [rad] (FD-22).
    """

    __slots__ = (
        "_asking",
        "_attempt",
        "_bias",
        "_compensation",
        "_containment",
        "_joints",
        "_left",
        "_rated",
        "_sequence",
        "_source",
        "_stored",
        "_total",
        "phase",
        "posture",
    )

    def __init__(self, joints: tuple[str, ...], rated: tuple[float, ...], containment: Containment, bias: SensorBias) -> None:
        """
        Args:
            joints: the names used in events, base to flange.
            rated: torque of each joint [N·m].
            containment: walls and areas.
            bias: of the flange sensor.
        """
        self.phase = Phase.OFF
        self.posture: tuple[float, ...] | None = None
        self._joints, self._rated = joints, rated
        self._containment, self._bias = containment, bias
        self._attempt: Attempt | None = None
        self._asking: Attempt | None = None  # that is confirmed within the sequence
        self._sequence: Sequence | None = None
        self._compensation: Compensation | None = None  # after a limit of the sequence was exceeded
        self._left = self._total = 0  # ticks of the sequence
        self._source = ""  # that asked for the attempt
        self._stored = Stored()  # for the sequence to compare with

    @property
    def remaining(self) -> Remaining | None:
        """Of the running period (FD-20)."""
        attempt = self._attempt or self._asking
        if attempt is not None:
            return Remaining(NAMES[attempt.phase], attempt.left, attempt.total)
        balancing = self._compensation
        if balancing is not None:
            return Remaining("compensation", balancing.left, balancing.total)
        return None if self._sequence is None else Remaining("sequence", self._left, self._total)

    @property
    def monitored(self) -> tuple[Monitored, ...]:
        """What the sequence checks, while it runs."""
        return () if self._sequence is None else self._sequence.monitored()

    @property
    def balance(self) -> Balance | None:
        """For the control law, while a refused arm is balanced (FD-10)."""
        return None if self._compensation is None else self._compensation.balance

    def keep(self, around: Surroundings, known: bool) -> None:
        """Keep the state of an arm that is held, before anybody tries to free it (FD-9); `known`: it is free already."""
        estimate = around.estimate
        if known or (around.mode is Mode.RUN and around.still.count == 0):
            self._stored.forget()
        elif self.phase is Phase.OFF and self._stored.due(estimate.tick):
            if not joints_ok(estimate):
                self._stored.forget()
            elif around.still.count > 0:  # an arm that a stop leaves braking is not held yet
                self._stored.keep(estimate, around.wrench_ok, around.mean)

    def forget(self) -> None:
        """The configured payload changes: what was stored is no more."""
        self._stored.forget()

    def end(self) -> None:
        """Free-drive is entered or refused, or the attempt is given up."""
        self.phase = Phase.OFF
        self._attempt = self._asking = None
        self._sequence = None
        self._compensation = None

    def step(self, around: Surroundings, settings: Settings, gate: Gate) -> Happened:
        """One tick with a signal, or of an attempt."""
        if self.phase is Phase.SEQUENCE:
            return self._check(around, settings, gate)
        tick, signal, attempt = around.estimate.tick, gate.signal, self._attempt
        if attempt is None:
            if gate.shut or reserved(signal, settings):
                return Happened(_not_yet(gate, tick))
            self._source = signal.source
        counting = self.phase is Phase.ACTIVATION and not signal.source
        if not counting and not around.guided and not may_enter(around.mode, self._source, settings):
            return _not_from(around.mode, tick, self._source, settings)
        if not around.enabled:
            return becomes(Transition.REFUSED, Event(Kind.REFUSED_ENABLING, tick, {"grip": around.grip or ""}))
        events: list[Event] = []
        if attempt is None:
            attempt = self._attempt = Attempt(signal, settings)
            self._containment.begin(Start.ACTIVATION, settings.walls)
            events.append(started(attempt, tick))
            outcome = attempt.first()
        else:
            static = around.still.count >= ticks(settings.static.time)  # an arm that a hand has left still swings
            outcome = attempt.step(signal, around.touched, around.hand_off and static)
        self.phase = attempt.phase
        if outcome is Outcome.CANCELLED:
            values: Values = {"value": attempt.present, "limit": attempt.total * TICK}
            return becomes(Transition.CANCELLED, Event(Kind.ACTIVATION_CANCELLED, tick, values))
        if joints_ok(around.estimate):  # a wall may be anchored here already (VW-6)
            reading = self._containment.step(around.estimate, *NOBODY)
            if reading is not None:
                return becomes(Transition.REFUSED, _behind(reading, tick, settings), events)
        if outcome is Outcome.READY:
            return self._ready(attempt, around, settings).after(events)
        if outcome is Outcome.GOES_ON:
            return Happened(events)
        event = asked(outcome, attempt, around, settings)
        return becomes(Transition.REFUSED, event, events) if outcome in FAILED else Happened([*events, event])

    def _ready(self, attempt: Attempt, around: Surroundings, settings: Settings) -> Happened:
        """The signal was present for long enough: from rest, try the arm, or enter at once where there is no sequence."""
        tick = around.estimate.tick
        if not joints_ok(around.estimate):
            return becomes(Transition.REFUSED, Event(Kind.REFUSED_SENSORS, tick, {"sensor": JOINTS_SENSED}))
        if around.changing is not None:
            return becomes(Transition.REFUSED, Event(Kind.REFUSED_CHANGING, tick, {"mass": around.changing}))
        if around.still.count < ticks(settings.static.time):
            return becomes(
                Transition.REFUSED, Event(Kind.REFUSED_MOVING, tick, around.still.moves(self._joints, settings.static))
            )
        self.posture = tuple(around.estimate.q.tolist())
        switches = not around.guided and teach_first(around.mode, settings)
        first = [Event(Kind.TEACH_FIRST, tick, {"from": around.mode})] if switches else []
        if not settings.sequence.on:
            return _entered(around, settings).after(first)
        use, stored = settings.sequence, None
        if use.stored:
            stored = self._stored.of(tick, ticks(use.age), around.wrench_ok)
            if stored is None:
                return becomes(Transition.REFUSED, Event(Kind.REFUSED_NOT_STORED, tick, {"age": use.age}))
        elif use.period < SHORTEST and not attempt.confirmed:
            return becomes(Transition.REFUSED, Event(Kind.REFUSED_SHORT, tick, {"value": use.period, "limit": SHORTEST}))
        self._attempt = None
        self.phase = Phase.SEQUENCE
        asks = attempt.asks_within and attempt.ask()
        self._asking = attempt if asks else None
        self._total = self._left = ticks(use.period)
        sequence = self._sequence = Sequence(around, settings, joints=self._joints, rated=self._rated, stored=stored)
        self._bias.begin(around.estimate, around.wrench_ok, around.mean)
        self._containment.begin(Start.SEQUENCE, settings.walls)
        first.append(Event(Kind.SEQUENCE_STARTED, tick, {"period": self._total * TICK}))
        if asks is Outcome.CONFIRM:
            first.append(asked(asks, attempt, around, settings))
        return self._judge(sequence, around, settings).after(first)

    def _check(self, around: Surroundings, settings: Settings, gate: Gate) -> Happened:
        """The sequence runs; the button does not matter any more (FD-8a)."""
        sequence, balancing = self._sequence, self._compensation
        if not around.guided and not may_enter(around.mode, self._source, settings):
            return _not_from(around.mode, around.estimate.tick, self._source, settings)
        if balancing is not None:
            return self._balance(balancing, around, settings)
        assert sequence is not None
        self._left = max(self._left - 1, 0)
        attempt, events = self._asking, []
        if attempt is not None:
            outcome = attempt.step(gate.signal, False, False)
            if outcome is Outcome.READY:
                self._asking = None
            elif outcome is not Outcome.GOES_ON:
                events.append(asked(outcome, attempt, around, settings))
                if outcome is Outcome.UNCONFIRMED:
                    return becomes(Transition.REFUSED, events[0])
        return self._judge(sequence, around, settings).after(events)

    def _judge(self, sequence: Sequence, around: Surroundings, settings: Settings) -> Happened:
        """One tick of the sequence: what refuses free-drive, or entry at its end."""
        tick = around.estimate.tick
        missing = sequence.missing(around)
        if missing:
            return becomes(Transition.REFUSED, Event(Kind.REFUSED_SENSORS, tick, {"sensor": missing}))
        beyond = sequence.check(around)
        reading = self._containment.step(around.estimate, *NOBODY)
        if not beyond and reading is None:
            return _entered(around, settings) if self._left == 0 and self._asking is None else Happened([])
        reasons = sequence.reasons(beyond, around)
        if beyond:
            refusal = sequence.refusal(beyond, around, settings)
        else:
            assert reading is not None
            refusal = _behind(reading, tick, settings)
        if settings.sequence.beyond_limit is not BeyondLimit.BALANCE:
            return becomes(Transition.REFUSED, refusal, reasons)
        balancing = self._compensation = Compensation(refusal, around)
        self._sequence = None
        return Happened([*reasons, balancing.begun(tick)])

    def _balance(self, balancing: Compensation, around: Surroundings, settings: Settings) -> Happened:
        """One tick after a limit of the sequence was exceeded: the arm is balanced (FD-10)."""
        if not joints_ok(around.estimate):
            return becomes(Transition.REFUSED, Event(Kind.REFUSED_SENSORS, around.estimate.tick, {"sensor": JOINTS_SENSED}))
        self._containment.step(around.estimate, *NOBODY)
        return balancing.step(around, settings.static)


def _not_yet(gate: Gate, tick: int) -> list[Event]:
    """A signal appears in the cool-down, or before it has been absent."""
    return [Event(Kind.NOT_YET, tick, {"remaining": gate.left * TICK})] if gate.shut and gate.appeared else []


def _not_from(mode: Mode, tick: int, source: str, settings: Settings) -> Happened:
    """`source` cannot ask for free-drive in `mode`."""
    return becomes(Transition.REFUSED, Event(Kind.REFUSED_MODE, tick, {"mode": mode, "allowed": origins(source, settings)}))


def _behind(reading: Reading, tick: int, settings: Settings) -> Event:
    """The activation shape is exceeded (VW-6, FD-10)."""
    values = facts(reading)
    if settings.sequence.beyond_limit is BeyondLimit.PROTECTIVE_STOP:
        metres = float(values["distance"]) / 1000.0
        values = {"parameter": f"wall {values['wall']}", "part": values["part"], "value": metres, "limit": 0.0, "unit": "m"}
        return Event(Kind.SEQUENCE_STOPPED, tick, values)
    return Event(Kind.REFUSED_WALL, tick, values)


def _entered(around: Surroundings, settings: Settings) -> Happened:
    gain = settings.free_drive.gain if around.wrench_ok else 0.0
    mode = Mode.TEACH if not around.guided and teach_first(around.mode, settings) else around.mode
    return becomes(Transition.ENTERED, Event(Kind.ENTERED, around.estimate.tick, {"from": mode, "gain": gain}))
