"""The activation of free-drive: its period to the tick, and what refuses entry at its end."""

import pytest
from msgspec.structs import replace

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.freedrive.activation import Activation
from pendant.freedrive.gate import Gate
from pendant.freedrive.periods import Remaining
from pendant.guided.sensor_bias import SensorBias
from pendant.inputs import NOTHING, Command, Inputs
from pendant.limits.validity import Stillness
from pendant.program.steps import Program, Wait
from pendant.signals.enabling_device import Grip
from pendant.signals.sources import BUTTON, NONE, Presence
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase
from pendant.walls.containment import Containment
from pendant.walls.definitions import Start
from pendant.walls.settings import WallSettings
from tests.pendant.estimates import SENSOR, estimate
from tests.pendant.freedrive.test_sequence import around
from tests.pendant.freedrive.test_state_machine import HOLD, JOINTS, LET_GO, Bench, remaining
from tests.pendant.telling import whole_transition

PUSH = Presence("push", by_hand=True)


class Begun(Containment):
    """Walls that note when they begin."""

    def __init__(self) -> None:
        super().__init__((), {})
        self.starts: list[Start] = []

    def begin(self, start: Start, walls: WallSettings) -> None:
        self.starts.append(start)
        super().begin(start, walls)


class Alone:
    """The module alone. Ticks count from 0."""

    def __init__(self, **changes: float | bool) -> None:
        self.settings = apply(Settings(), {name.replace("__", "."): value for name, value in changes.items()})
        self.walls, self.zero = Begun(), SensorBias(SENSOR)
        self.activation = Activation(JOINTS, (100.0,) * 6, self.walls, self.zero)
        self.gate = Gate()
        self.tick = -1

    def step(self, signal: Presence = BUTTON, value: Estimate | None = None, rest: int = 50, **changes: object) -> list[Event]:
        """One tick of an arm that has been static for `rest` ticks; `changes` of its surroundings."""
        self.tick += 1
        still = Stillness()
        still.count = rest
        self.gate.sense(signal is BUTTON, signal)
        now = replace(around(value or estimate(), self.tick), still=still, **changes)
        return whole_transition(self.activation.step(now, self.settings, self.gate), self.tick)

    def run(self, count: int, signal: Presence, **changes: object) -> list[Event]:
        return [event for _ in range(count) for event in self.step(signal, **changes)]  # type: ignore[arg-type]


@pytest.mark.parametrize(("seconds", "count"), [(0.0, 0), (0.002, 1), (0.25, 125), (1.0, 500), (15.0, 7500)])
def test_activation_lasts_its_period_to_the_tick(seconds: float, count: int) -> None:
    """FD-7, FD-20."""
    bench = Bench(activation__period=seconds)
    bench.run(60)
    for left in range(count, 0, -1):
        bench.step(HOLD)
        assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.ACTIVATION, Law.HOLD)
        assert remaining(bench.last) == {"activation": (left, count)}
    bench.step(HOLD)
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.FREE_DRIVE, Phase.HELD, Law.FREE)
    assert bench.last.periods == ()
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED, Kind.ENTERED]
    assert bench.events[0] == Event(Kind.ACTIVATION_STARTED, 60, {"period": pytest.approx(seconds)})
    assert bench.events[1] == Event(Kind.ENTERED, 60 + count, {"from": Mode.TEACH, "gain": 1.0})


@pytest.mark.parametrize("held", [1, 2, 250, 499, 500])
def test_letting_go_before_the_end_cancels_without_a_cool_down(held: int) -> None:
    """FD-8a."""
    bench = Bench()
    bench.run(60)
    bench.run(held, HOLD)
    bench.step(LET_GO)
    assert (bench.last.mode, bench.last.phase, bench.last.periods) == (Mode.TEACH, Phase.OFF, ())
    values = {"value": pytest.approx(held / 500), "limit": 1.0}
    assert bench.events[-1] == Event(Kind.ACTIVATION_CANCELLED, 60 + held, values)
    assert bench.step(HOLD).phase is Phase.ACTIVATION
    assert remaining(bench.last) == {"activation": (500, 500)}


def test_a_stutter_during_activation_does_not_cancel_it_and_silence_does() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(HOLD)
    bench.run(250)
    bench.step(HOLD)
    assert bench.last.phase is Phase.ACTIVATION
    bench.run(248)
    assert remaining(bench.last) == {"activation": (1, 500)}
    assert bench.step().phase is Phase.HELD
    bench = Bench(activation__period=2.0)
    bench.run(60)
    bench.step(HOLD)
    assert bench.run(250).phase is Phase.ACTIVATION
    bench.step()
    assert [event.kind for event in bench.last.events] == [Kind.HOLD_SILENT, Kind.ACTIVATION_CANCELLED]


@pytest.mark.parametrize(("ago", "entered"), [(0, False), (1, False), (49, False), (50, True), (51, True)])
def test_entry_is_refused_unless_the_arm_was_static(ago: int, entered: bool) -> None:
    """0.1 s are 50 ticks."""
    bench = Bench()
    bench.run(60)
    bench.run(500 - ago, HOLD)
    bench.step(HOLD, estimate(qd=[0.0, 0.0, -0.0123, 0.0, 0.0, 0.0]))
    bench.run(ago, HOLD)
    assert (bench.last.mode is Mode.FREE_DRIVE) == entered
    if not entered:
        values = {"joint": "elbow", "value": 0.0123, "limit": 0.01, "time": 0.1}
        assert bench.last.events == (Event(Kind.REFUSED_MOVING, bench.tick, values),)


@pytest.mark.parametrize("braking", [0, 1, 40])
@pytest.mark.parametrize(("rested", "there"), [(229, False), (230, True), (260, True)])
def test_an_arm_whose_program_is_stopped_on_its_way_is_compared_with_a_state_at_rest(
    braking: int, rested: int, there: bool
) -> None:
    """FD-9: the state must be 0.5 s old, 250 ticks, of which the button is held for 21; none of before or of braking counts."""
    bench = Bench(sequence__on=True, sequence__stored=True, sequence__age=0.5, activation__period=0.04)
    bench.run(300)
    bench.step(Inputs(program=Program(name="rest", steps=(Wait(duration=60.0),))))
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    bench.run(3, NOTHING, estimate(qd=0.3))
    bench.step(Inputs(commands=(Command.STOP_PROGRAM,)), estimate(qd=0.3))
    assert bench.last.mode is Mode.TEACH
    bench.run(braking, NOTHING, estimate(qd=0.3))
    bench.run(rested)
    bench.run(21, HOLD)
    assert (bench.last.phase is Phase.SEQUENCE) is there
    assert there or bench.last.events[-1].kind is Kind.REFUSED_NOT_STORED


@pytest.mark.parametrize("phase", [Phase.ACTIVATION, Phase.SEQUENCE])
def test_a_mode_that_free_drive_cannot_be_entered_from_ends_it_and_is_named(phase: Phase) -> None:
    """FD-1."""
    bench = Bench(sequence__on=True, activation__period=0.0 if phase is Phase.SEQUENCE else 1.0)
    bench.run(60)
    assert bench.step(HOLD).phase is phase
    bench.step(Inputs(held=HOLD.held, commands=(Command.NORMAL,)))
    assert bench.last.events[-1] == Event(Kind.REFUSED_MODE, bench.tick, {"mode": Mode.NORMAL, "allowed": "TEACH"})
    assert (bench.last.mode, bench.last.phase) == (Mode.NORMAL, Phase.OFF)


@pytest.mark.parametrize(
    ("broken", "sensor"),
    [
        (estimate(joints_valid=False), "joint encoders and motor currents"),
        (estimate(wrench_valid=False), "flange force sensor"),
    ],
)
def test_a_sensor_that_is_lost_in_the_sequence_refuses_entry_and_is_named(broken: Estimate, sensor: str) -> None:
    """FD-12."""
    bench = Bench(sequence__on=True, activation__period=0.0)
    bench.run(60)
    assert bench.step(HOLD).phase is Phase.SEQUENCE
    bench.step(HOLD, broken)
    assert (bench.last.mode, bench.last.phase) == (Mode.TEACH, Phase.OFF)
    assert bench.last.events == (Event(Kind.REFUSED_SENSORS, bench.tick, {"sensor": sensor}),)


def test_a_signal_in_the_cool_down_is_told_once_how_long_that_lasts() -> None:
    """FD-12c."""
    alone = Alone()
    alone.gate.close(500)
    assert alone.step() == [Event(Kind.NOT_YET, 0, {"remaining": pytest.approx(0.998)})]
    assert alone.step() == []


def test_a_signal_that_ends_as_the_mode_changes_was_let_go() -> None:
    """FD-8a: letting go cancels, and needs no mode; a signal that goes on does."""
    for signal, event in (
        (NONE, Event(Kind.ACTIVATION_CANCELLED, 1, {"value": pytest.approx(0.002), "limit": 1.0})),
        (BUTTON, Event(Kind.REFUSED_MODE, 1, {"mode": Mode.NORMAL, "allowed": "TEACH"})),
    ):
        alone = Alone()
        assert alone.step() == [Event(Kind.ACTIVATION_STARTED, 0, {"period": 1.0})]
        assert alone.step(signal, mode=Mode.NORMAL) == [event]


@pytest.mark.parametrize(
    ("changes", "value", "event"),
    [
        ({"grip": Grip.RELEASED}, estimate(), Event(Kind.REFUSED_ENABLING, 0, {"grip": "released"})),
        ({}, estimate(joints_valid=False), Event(Kind.REFUSED_SENSORS, 0, {"sensor": "joint encoders and motor currents"})),
        ({"changing": 1.5}, estimate(), Event(Kind.REFUSED_CHANGING, 0, {"mass": 1.5})),
    ],
)
def test_what_refuses_an_activation_is_named(changes: dict[str, object], value: Estimate, event: Event) -> None:
    """FD-12."""
    alone = Alone(activation__period=0.0)
    assert alone.step(BUTTON, value, **changes)[-1] == event  # type: ignore[arg-type]


@pytest.mark.parametrize("walls", [True, False])
def test_a_complete_signal_starts_the_sequence_and_its_posture_is_remembered(walls: bool) -> None:
    """FD-9, FD-22."""
    alone, angles = Alone(activation__period=0.0, walls__on=walls, sequence__period=0.5), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    assert alone.step(BUTTON, estimate(q=angles))[1:] == [Event(Kind.SEQUENCE_STARTED, 0, {"period": 0.5})]
    assert alone.activation.posture == tuple(angles)


@pytest.mark.parametrize("on", [True, False])
def test_only_a_confirmation_allows_for_a_short_sequence(on: bool) -> None:
    """FD-8, FD-9."""
    alone = Alone(activation__period=0.0, handshake__on=on, handshake__feedback=0.2, sequence__period=0.1)
    said = alone.run(1, BUTTON) + alone.run(200, NONE) + alone.run(101, BUTTON) if on else alone.run(1, BUTTON)
    confirm = Event(Kind.CONFIRM_ASKED, 0, {"source": "button", "feedback": 0.2, "window": 3.0})
    started, short = {"period": pytest.approx(0.1)}, {"value": 0.1, "limit": 0.25}
    assert said[1:] == ([confirm, Event(Kind.SEQUENCE_STARTED, 301, started)] if on else [Event(Kind.REFUSED_SHORT, 0, short)])


def test_a_confirmation_that_does_not_come_is_named() -> None:
    """FD-8: 0.2 s of feedback, 3 s to confirm; a hand that is still felt has not left the arm."""
    alone = Alone(activation__period=0.0, handshake__on=True, handshake__feedback=0.2)
    alone.step(PUSH)
    assert alone.run(120, NONE, touched=True) == []
    assert alone.run(102, PUSH) == []
    assert alone.run(1378, NONE) == [Event(Kind.REFUSED_UNCONFIRMED, 1600, {"source": "push", "limit": 3.0})]


def test_a_hand_that_gave_the_signal_has_to_leave_the_arm_and_that_to_stand() -> None:
    """FD-8a."""
    alone = Alone(activation__period=0.0, sequence__on=False)
    off = alone.settings.let_go
    asked = {"force": 7.5, "limit": off.force, "within": off.within}
    assert alone.step(PUSH, felt=7.5, hand_off=False)[1:] == [Event(Kind.LET_GO_ASKED, 0, asked)]
    assert alone.step(NONE, rest=49, hand_off=True) == []
    assert alone.step(NONE, rest=50, hand_off=False) == []
    assert alone.step(NONE, rest=50, hand_off=True) == [Event(Kind.ENTERED, 3, {"from": Mode.TEACH, "gain": 1.0})]


def test_a_hand_that_does_not_leave_the_arm_is_named() -> None:
    """FD-8a."""
    alone = Alone(activation__period=0.0)
    off = alone.settings.let_go
    alone.step(PUSH, hand_off=False)
    last = round(off.within * 500)
    held = Event(Kind.REFUSED_STILL_HELD, last, {"force": 6.0, "limit": off.force, "within": off.within})
    assert alone.run(last, NONE, felt=6.0, hand_off=False) == [held]


def test_a_refusal_in_the_first_tick_of_all_tells_no_way_back() -> None:
    """FD-22: there is no posture yet to come back to."""
    bench = Bench(activation__period=0.0)
    bench.step(HOLD)
    assert [event.kind for event in bench.last.events] == [Kind.ACTIVATION_STARTED, Kind.REFUSED_MOVING]


@pytest.mark.parametrize("sensor", [True, False])
def test_a_sequence_begins_with_its_walls_and_with_what_is_nobodys_at_the_sensor(sensor: bool) -> None:
    """VW-6, FD-3a: after the activation period the walls begin anew; without the sensor nothing is taken off."""
    alone = Alone(activation__period=0.004, sequence__on=True)
    alone.run(3, BUTTON, wrench_ok=sensor)
    assert alone.activation.phase is Phase.SEQUENCE
    assert alone.walls.starts == [Start.ACTIVATION, Start.SEQUENCE]
    assert alone.zero.used is sensor


WITHIN = {
    "handshake__on": True,
    "handshake__when": "within",
    "handshake__delay": 0.02,
    "handshake__feedback": 0.04,
    "handshake__window": 1.0,
    "activation__period": 0.0,
    "sequence__period": 0.1,
    "let_go__on": False,
}
"""In ticks: delay 10, feedback 20, window 500, sequence 50; an absence takes 100, and the answer lasts 100."""


def kinds(events: list[Event]) -> list[Kind]:
    return [event.kind for event in events]


@pytest.mark.parametrize("begin", [101, 300, 499])
def test_within_the_sequence_the_arm_is_free_when_the_answer_has_come(begin: int) -> None:
    """FD-8: the robot asks after its delay; the period of the sequence has ended by then, and goes on."""
    bench = Alone(**WITHIN)  # type: ignore[arg-type]
    assert kinds(bench.step()) == [Kind.ACTIVATION_STARTED, Kind.SEQUENCE_STARTED]
    assert bench.activation.remaining == Remaining("delay", 10, 10)
    assert bench.run(9, NONE) == []
    assert bench.activation.remaining == Remaining("delay", 1, 10)
    assert kinds(bench.step(NONE)) == [Kind.CONFIRM_ASKED]
    assert bench.activation.remaining == Remaining("feedback", 20, 20)
    assert bench.run(20, NONE) == []
    assert bench.activation.remaining == Remaining("confirmation", 500, 500)
    assert bench.run(begin - 31, NONE) == []
    assert bench.run(100, BUTTON) == []
    assert bench.activation.phase is Phase.SEQUENCE
    assert kinds(bench.step(BUTTON)) == [Kind.ENTERED]


def test_within_the_sequence_the_answer_may_come_before_its_end() -> None:
    """FD-8: then the period of the sequence decides."""
    bench = Alone(**{**WITHIN, "sequence__period": 1.0})  # type: ignore[arg-type]
    bench.step()
    bench.run(130, NONE)
    assert bench.run(101, BUTTON) == []
    assert bench.activation.remaining == Remaining("sequence", 500 - 231, 500)
    assert bench.run(500 - 232, NONE) == []
    assert kinds(bench.step(NONE)) == [Kind.ENTERED]


@pytest.mark.parametrize("answer", [NONE, PUSH])
def test_within_the_sequence_no_answer_refuses(answer: Presence) -> None:
    """FD-8: in the last tick of the window; what a hand that cannot be told from the free arm's motion does is none."""
    bench = Alone(**{**WITHIN, "handshake__by": "button"})  # type: ignore[arg-type]
    bench.step(Presence("digital input"))
    assert kinds(bench.run(529, answer)) == [Kind.CONFIRM_ASKED]
    (refused,) = bench.step(answer)
    assert refused == Event(Kind.REFUSED_UNCONFIRMED, 530, {"source": "digital input", "limit": 1.0})


def test_within_the_sequence_a_limit_refuses_as_ever() -> None:
    """FD-10: also after the sequence's own period, while the answer is waited for."""
    bench = Alone(**WITHIN)  # type: ignore[arg-type]
    bench.step()
    bench.run(200, NONE)
    assert kinds(bench.step(NONE, estimate(qd=0.2))) == [Kind.ENTRY_PREVENTED, Kind.REFUSED_LIMIT]


def test_within_the_sequence_the_robot_may_ask_at_once() -> None:
    """FD-8: without a delay; a button that is held from before is no answer."""
    bench = Alone(**{**WITHIN, "handshake__delay": 0.0})  # type: ignore[arg-type]
    assert kinds(bench.step()) == [Kind.ACTIVATION_STARTED, Kind.SEQUENCE_STARTED, Kind.CONFIRM_ASKED]
    assert kinds(bench.run(520, BUTTON)) == [Kind.REFUSED_UNCONFIRMED]


def test_what_is_chosen_to_confirm_begins_nothing() -> None:
    """FD-8."""
    bench = Alone(handshake__on=True, handshake__by="button")  # type: ignore[arg-type]
    assert bench.run(20, BUTTON) == []
    assert bench.activation.phase is Phase.OFF
    assert kinds(bench.step(PUSH)) == [Kind.SIGNAL_SEEN]


@pytest.mark.parametrize("checked", [True, False])
@pytest.mark.parametrize(("mode", "switches"), [(Mode.NORMAL, True), (Mode.RUN, True), (Mode.TEACH, False)])
@pytest.mark.parametrize("guided", [True, False])
def test_activation_switches_to_teach_first(mode: Mode, switches: bool, guided: bool, checked: bool) -> None:
    """FD-1: not where a program asks for the hand."""
    names = {f"free_drive__allowed_from__{name}": True for name in ("run", "teach_first")}
    bench = Alone(activation__period=0.0, sequence__on=checked, **names)
    events = bench.step(mode=mode, guided=guided)
    switches = switches and not guided
    assert kinds(events) == [
        Kind.ACTIVATION_STARTED,
        *[Kind.TEACH_FIRST] * switches,
        Kind.SEQUENCE_STARTED if checked else Kind.ENTERED,
    ]
    if switches:
        assert events[1].values == {"from": mode}
    if not checked:
        assert events[-1].values["from"] == (Mode.TEACH if switches else mode)
