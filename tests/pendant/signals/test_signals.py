"""Sources of the activation signal and what follows it, through the supervisor (FD-5 to FD-8a)."""

from typing import Any

import pytest

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import Button, Command, Inputs
from pendant.program.steps import JointMove, Program, ProgramState
from pendant.supervisor import Supervisor
from pendant.tick.modes import Mode, Phase
from pendant.tick.motion_status import NO_MOTION, MotionStatus
from tests.pendant.estimates import estimate
from tests.pendant.telling import whole

HOLD = Inputs(held=frozenset({Button.FREE_DRIVE}))
LET_GO = Inputs(released=frozenset({Button.FREE_DRIVE}))
NOTHING = Inputs()


class Bench:
    """A supervisor that has stood untouched for half a second; settings by dotted name with __ for the dot."""

    def __init__(self, untouched: dict[str, Any] | None = None, **settings: float | bool) -> None:
        self.supervisor = Supervisor(apply(Settings(), {k.replace("__", "."): v for k, v in settings.items()}), 6)
        self.tick = 0
        self.kinds: list[Kind] = []
        self.events: list[Event] = []
        self.last: Decision
        self.run(0.5, **(untouched or {}))

    def run(self, seconds: float, inputs: Inputs = NOTHING, status: MotionStatus = NO_MOTION, **values: Any) -> Decision:
        for _ in range(round(seconds * 500)):
            self.tick += 1
            value = estimate(**values)
            value.tick = self.tick
            self.last = self.supervisor.step(value, inputs, status)
            self.events += whole(self.last.events, self.tick)
            self.kinds += [event.kind for event in self.last.events]
        return self.last


BY_HAND: dict[str, tuple[str, dict[str, Any]]] = {
    "signals.push.on": ("push", {"force": 20.0}),
    "signals.twist.on": ("twist", {"torque": 4.0}),
    "signals.joints.on": ("push felt by joints", {"tau_ext": 9.0, "wrench_valid": False}),
    "signals.force_step.on": ("force step", {"force": 20.0}),
    "signals.turn.on": ("turned joint", {"q": [0.0, 0.0, 0.0, 0.0, 0.0, 0.01]}),
}
"""Switch: name of the source, and what the arm feels."""


@pytest.mark.parametrize("name", BY_HAND)
def test_a_signal_by_hand_enters_once_the_hand_is_off(name: str) -> None:
    """FD-5, FD-8a: activation period, let go, sequence."""
    source, felt = BY_HAND[name]
    valid = {key: value for key, value in felt.items() if key == "wrench_valid"}
    bench = Bench(valid, **{name.replace(".", "__"): True})
    bench.run(0.9, **felt)
    assert (bench.last.phase, bench.kinds) == (Phase.ACTIVATION, [Kind.SIGNAL_SEEN])
    bench.run(0.2, **felt)
    assert bench.last.phase is Phase.LET_GO
    assert bench.kinds[-1] is Kind.LET_GO_ASKED
    bench.run(0.5, **valid)
    assert bench.last.phase is Phase.SEQUENCE
    bench.run(1.0, **valid)
    assert bench.last.mode is Mode.FREE_DRIVE
    assert source


def test_an_arm_that_the_hand_has_left_comes_to_rest_before_the_sequence() -> None:
    """FD-8a, FD-9: it is waited for as the hand is."""
    bench = Bench(signals__push__on=True)
    bench.run(1.1, force=20.0)
    assert bench.run(0.5, qd=0.02).phase is Phase.LET_GO
    assert bench.run(0.08).phase is Phase.LET_GO
    assert bench.run(0.04).phase is Phase.SEQUENCE
    assert Kind.REFUSED_MOVING not in bench.kinds


@pytest.mark.parametrize("name", BY_HAND)
def test_without_its_switch_nothing_happens(name: str) -> None:
    """FD-5."""
    felt = BY_HAND[name][1]
    bench = Bench({key: value for key, value in felt.items() if key == "wrench_valid"})
    bench.run(3.0, **felt)
    assert (bench.last.phase, bench.kinds) == (Phase.OFF, [])


@pytest.mark.parametrize("name", BY_HAND)
def test_a_hand_that_stays_is_refused_and_counts_again_after_an_absence(name: str) -> None:
    """FD-8a: 2 s; FD-7: 0.2 s and the cool-down."""
    felt = BY_HAND[name][1]
    valid = {key: value for key, value in felt.items() if key == "wrench_valid"}
    bench = Bench(valid, **{name.replace(".", "__"): True, "signals__push__reported": True})
    bench.run(3.2, **felt)
    assert Kind.REFUSED_STILL_HELD in bench.kinds
    bench.run(3.0, **felt)
    assert bench.last.phase is Phase.OFF


@pytest.mark.parametrize(
    ("settings", "felt", "seen"),
    [
        ({}, {"force": 15.5}, True),
        ({}, {"force": 14.5}, False),
        ({}, {"force": 81.0}, False),
        ({}, {"force": 20.0, "torque": 2.4}, True),
        ({}, {"force": 20.0, "torque": 2.6}, False),
        ({"z": -1.0}, {"force": [0.0, 0.0, -20.0]}, True),
        ({"z": -1.0}, {"force": [0.0, 0.0, 20.0]}, False),
        ({"z": -1.0, "frame": "flange"}, {"force": [0.0, 0.0, -20.0]}, True),
        ({"z": -1.0}, {"force": [11.0, 0.0, -20.0]}, True),
        ({"z": -1.0}, {"force": [12.0, 0.0, -20.0]}, False),
        ({"z": -1.0, "off_axis": 10.0}, {"force": [11.0, 0.0, -20.0]}, False),
        ({"z": 1.0, "direction": "across"}, {"force": [20.0, 0.0, 11.0]}, True),
        ({"z": 1.0, "direction": "across"}, {"force": [20.0, 0.0, 12.0]}, False),
        ({"radius": 0.05}, {"force": 20.0, "torque": [0.0, 0.9, 0.0]}, True),
        ({"radius": 0.05}, {"force": 20.0, "torque": [0.0, 1.1, 0.0]}, False),
        ({"radius": 0.05, "place_z": 0.1}, {"force": 20.0, "torque": [0.0, 1.1, 0.0]}, True),
    ],
)
def test_which_push_is_a_signal(settings: dict[str, float | bool], felt: dict[str, Any], seen: bool) -> None:
    """FD-6: size, torque, cone, band, off-axis force, place."""
    bench = Bench(**{"signals__push__on": True, **{f"signals__push__{name}": value for name, value in settings.items()}})
    bench.run(0.5, **felt)
    assert (bench.last.phase is Phase.ACTIVATION) is seen


def test_torque_must_have_been_calm_for_its_period() -> None:
    """FD-6: the torque period is its own."""
    bench = Bench(signals__push__on=True, signals__push__torque_period=0.3)
    bench.run(0.2, force=20.0, torque=5.0)
    bench.run(0.3, force=20.0)
    assert bench.last.phase is Phase.OFF
    bench.run(0.1, force=20.0)
    assert bench.last.phase is Phase.ACTIVATION


@pytest.mark.parametrize(
    ("name", "felt", "less"),
    [
        ("push", {"force": 20.0}, {"force": 13.0}),
        ("twist", {"torque": 4.0}, {"torque": 2.6}),
        ("force_step", {"force": 20.0}, {"force": 8.5}),
    ],
)
def test_what_was_felt_is_over_when_the_sensor_is_lost(name: str, felt: dict[str, Any], less: dict[str, Any]) -> None:
    """FD-5, FD-12: what would be enough to stay is not enough to come back."""
    bench = Bench(**{f"signals__{name}__on": True, "signals__force_step__quiet": 0.1})
    bench.run(0.3, **felt)
    assert bench.run(0.1, **less).phase is Phase.ACTIVATION
    bench.run(0.1, wrench_valid=False)
    bench.run(3.0)
    seen = len(bench.kinds)
    bench.run(0.5, **less)
    assert bench.kinds[seen:] == []


def test_a_steady_offset_is_no_push_and_nothing_is_felt_without_the_sensor() -> None:
    """Pushes are changes from the untouched state; FD-12."""
    bench = Bench({"force": 20.0}, signals__push__on=True)
    bench.run(2.0, force=20.0)
    assert bench.kinds == []
    bench.run(0.5, force=20.0, wrench_valid=False)
    bench.run(2.0, force=60.0, wrench_valid=False)
    assert bench.kinds == []


@pytest.mark.parametrize(
    ("length", "gap", "whole"), [(0.15, 0.15, True), (0.05, 0.15, False), (0.4, 0.15, False), (0.15, 0.5, False)]
)
def test_pushes_in_a_row(length: float, gap: float, whole: bool) -> None:
    """FD-5f: limits on each length and gap."""
    bench = Bench(signals__pattern__on=True)
    for _ in range(2):
        bench.run(length, force=25.0)
        bench.run(gap)
    bench.run(0.3)
    assert (bench.last.phase is Phase.ACTIVATION) is whole
    bench.run(2.2)
    assert (bench.last.mode is Mode.FREE_DRIVE) is whole


@pytest.mark.parametrize(("length", "whole"), [(0.02, True), (0.2, False)])
def test_a_tap(length: float, whole: bool) -> None:
    """FD-5i."""
    bench = Bench(signals__tap__on=True)
    bench.run(length, acceleration=8.0)
    bench.run(0.15)
    assert (bench.last.phase is Phase.ACTIVATION) is whole


def test_a_slow_rise_is_no_force_step() -> None:
    """FD-5h."""
    bench = Bench(signals__force_step__on=True)
    for tenth in range(20):
        bench.run(0.05, force=float(tenth))
    assert bench.kinds == []


def test_digital_inputs_activate_and_leave() -> None:
    """FD-5b, FD-17."""
    bench = Bench(signals__digital=True, signals__leaving=True)
    bench.run(2.2, Inputs(high=frozenset({0})))
    assert bench.last.mode is Mode.FREE_DRIVE
    bench.run(0.01, Inputs(high=frozenset({1})))
    assert bench.last.mode is Mode.TEACH
    assert bench.kinds[-1] is Kind.DEACTIVATED


@pytest.mark.parametrize(
    ("summing", "gap", "entered"), [(False, 0.1, False), (True, 0.1, True), (True, 0.9, True), (True, 1.1, False)]
)
def test_presences_may_add_up(summing: bool, gap: float, entered: bool) -> None:
    """FD-7: a gap up to 1 s does not begin afresh, a longer one does."""
    bench = Bench(activation__sum_presences=summing)
    bench.run(0.6, HOLD)
    bench.run(0.002, LET_GO)
    bench.run(gap - 0.002)
    bench.run(0.5, HOLD)
    assert (bench.last.phase is Phase.SEQUENCE) is entered


def confirmed(**settings: float | bool) -> Bench:
    """A bench that has just been asked to confirm a held button, which is let go then."""
    bench = Bench(handshake__on=True, **settings)
    bench.run(1.002, HOLD)
    assert bench.kinds[-1] is Kind.CONFIRM_ASKED
    return bench


def test_a_second_press_confirms() -> None:
    """FD-8."""
    bench = confirmed()
    assert bench.last.phase is Phase.FEEDBACK
    bench.run(0.002, LET_GO)
    bench.run(0.6)
    assert bench.last.phase is Phase.CONFIRM
    bench.run(0.21, HOLD)
    assert bench.last.phase is Phase.SEQUENCE


def test_the_first_press_still_held_is_no_confirmation() -> None:
    """FD-8: and none in time refuses, with its cause."""
    bench = confirmed(handshake__feedback=0.0)
    assert bench.last.phase is Phase.CONFIRM
    bench.run(2.9, HOLD)
    assert bench.last.phase is Phase.CONFIRM
    bench.run(0.12, HOLD)
    assert bench.last.phase is Phase.OFF
    assert bench.kinds[-1] is Kind.REFUSED_UNCONFIRMED


def test_too_short_a_confirmation_is_none_and_a_push_must_let_go() -> None:
    """FD-8, FD-8a."""
    bench = confirmed(signals__push__on=True)
    bench.run(0.002, LET_GO)
    bench.run(0.6)
    bench.run(0.1, force=20.0)
    bench.run(0.5)
    assert bench.last.phase is Phase.CONFIRM
    bench.run(0.4, force=20.0)
    assert bench.last.phase is Phase.LET_GO
    bench.run(0.3)
    assert bench.last.phase is Phase.SEQUENCE


PULLS = {
    "push": ({"force": 20.0}, {"force": 4.0}, {"force": 2.0}),
    "twist": ({"torque": 4.0}, {"torque": 0.8}, {"torque": 0.5}),
    "joints": ({"tau_ext": 9.0, "wrench_valid": False}, {"tau_ext": 3.5, "wrench_valid": False}, {"wrench_valid": False}),
}
"""Of a source: a pull, one that is no signal but still felt, and a hand that is off."""


@pytest.mark.parametrize("name", PULLS)
def test_a_pull_that_weakens_and_comes_back_is_no_confirmation(name: str) -> None:
    """FD-8: a cable that pulls, now more, now less, is the first push, still held. FD-8a: a hand is off below 3 N."""
    pull, less, off = PULLS[name]
    valid = {key: value for key, value in pull.items() if key == "wrench_valid"}
    bench = Bench(valid, handshake__on=True, **{f"signals__{name}__on": True})
    bench.run(1.1, **pull)
    assert bench.kinds[-1] is Kind.CONFIRM_ASKED
    bench.run(0.6, **pull)
    bench.run(0.5, **less)
    bench.run(0.5, **pull)
    assert bench.last.phase is Phase.CONFIRM
    bench.run(0.5, **off)
    bench.run(0.4, **pull)
    assert bench.last.phase is Phase.LET_GO


def test_the_pendant_confirms_while_a_hand_rests_on_the_arm() -> None:
    """FD-8: its button was let go; a push would have to begin off the arm."""
    bench = confirmed(signals__push__on=True)
    bench.run(0.002, LET_GO)
    bench.run(1.0, force=6.0)
    bench.run(0.4, force=20.0)
    assert bench.last.phase is Phase.CONFIRM
    bench.run(0.3, force=6.0)
    bench.run(0.21, HOLD, force=6.0)
    assert bench.last.phase is Phase.SEQUENCE


@pytest.mark.parametrize("phase", [Phase.FEEDBACK, Phase.CONFIRM])
def test_the_deactivation_signal_and_another_mode_end_an_attempt(phase: Phase) -> None:
    """FD-1, FD-17."""
    for inputs, kind in (
        (Inputs(commands=(Command.LEAVE_FREE_DRIVE,)), Kind.DEACTIVATED),
        (Inputs(commands=(Command.NORMAL,)), Kind.REFUSED_MODE),
    ):
        bench = confirmed(handshake__feedback=0.5 if phase is Phase.FEEDBACK else 0.0)
        assert bench.last.phase is phase
        bench.run(0.002, inputs)
        assert bench.last.phase is Phase.OFF
        assert bench.kinds[-1] is kind


def test_a_push_is_told_in_every_mode() -> None:
    """FD-6a."""
    bench = Bench(signals__push__reported=True)
    bench.run(0.5, force=[6.0, -12.0, 12.0])
    assert bench.kinds == [Kind.PUSHED]
    assert bench.events[0].values == {
        "part": "flange",
        "force": pytest.approx(18.0, rel=0.01),
        **{axis: pytest.approx(share / 3.0) for axis, share in (("x", 1.0), ("y", -2.0), ("z", 2.0))},
    }


PROGRAM = Program(steps=(JointMove(q=(0.0,) * 6), JointMove(q=(0.1,) * 6)))
RUNS, PAUSED, ENDED = ProgramState.RUNNING, ProgramState.PAUSED, ProgramState.STOPPED


@pytest.mark.parametrize(
    ("switches", "before", "after"),
    [
        ("", RUNS, RUNS),
        ("resumes", RUNS, RUNS),
        ("pauses", RUNS, PAUSED),
        ("stops", RUNS, ENDED),
        ("pauses stops", RUNS, PAUSED),
        ("", PAUSED, PAUSED),
        ("pauses", PAUSED, PAUSED),
        ("resumes", PAUSED, RUNS),
        ("stops", PAUSED, ENDED),
        ("resumes stops", PAUSED, RUNS),
    ],
)
def test_a_push_does_to_a_program_what_is_set(switches: str, before: ProgramState, after: ProgramState) -> None:
    """FD-6a."""
    bench = Bench(signals__push__reported=True, **{f"signals__push__{name}": True for name in switches.split()})
    bench.run(0.002, Inputs(program=PROGRAM))
    bench.run(0.2, Inputs(commands=(Command.START_PROGRAM,)))
    if before is PAUSED:
        bench.run(0.2, Inputs(commands=(Command.PAUSE_PROGRAM,)))
    assert bench.last.program is before
    bench.run(0.3, force=20.0)
    assert bench.kinds.count(Kind.PUSHED) == 1
    assert bench.last.program is after


def test_joints_that_were_not_valid_feel_no_push_in_what_they_come_back_with() -> None:
    """FD-5e: nobody knows what happened meanwhile."""
    felt, lost = Bench(signals__joints__on=True), Bench(signals__joints__on=True)
    felt.run(0.1)
    lost.run(0.1, joints_valid=False)
    for bench in (felt, lost):
        bench.run(0.5, tau_ext=9.0)
    assert felt.last.phase is Phase.ACTIVATION
    assert lost.last.phase is Phase.OFF
    assert Kind.SIGNAL_SEEN not in lost.kinds


def test_a_force_in_free_drive_makes_another_state() -> None:
    one, other = Bench(), Bench()
    for bench in (one, other):
        assert bench.run(2.5, HOLD).mode is Mode.FREE_DRIVE
    assert one.supervisor.state == other.supervisor.state
    one.run(0.002, HOLD, force=20.0)
    other.run(0.002, HOLD)
    assert one.supervisor.state != other.supervisor.state
