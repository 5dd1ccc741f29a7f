"""A push that the joints feel (FD-5e): its threshold, a trembling hand, what stays afterwards, what was learned on the way."""

import math
from collections.abc import Callable

import pytest

from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.program.steps import JointMove, Program
from pendant.sensor.hand_model import HALF
from pendant.signals.joint_push import JointPushSignal
from pendant.signals.settings import JointPush
from pendant.tick.modes import Law, Mode, Phase
from pendant.tick.motion_status import MotionStatus
from tests.pendant.signals.test_signals import HOLD, LET_GO, Bench

TICK = 0.002
THRESHOLD = 6.0  # [N·m], as shipped


def felt(torque: Callable[[float], float], seconds: float, use: JointPush | None = None, joint: int = 1) -> list[bool]:
    """Whether a push is there, tick by tick, of a joint that has been untouched for half a second."""
    signal, chosen = JointPushSignal(6), use or JointPush(on=True)
    for _ in range(250):
        signal.step([0.0] * 6, chosen)
    values = [[torque(TICK * k) if i == joint else 0.0 for i in range(6)] for k in range(round(seconds / TICK))]
    return [signal.step(each, chosen) for each in values]


@pytest.mark.parametrize(("size", "there"), [(5.0, False), (5.9, False), (6.2, True), (-5.9, False), (-6.2, True), (30.0, True)])
def test_a_change_beyond_the_threshold_is_a_push(size: float, there: bool) -> None:
    assert any(felt(lambda _: size, 0.3)) is there


@pytest.mark.parametrize(("joint", "there"), [(0, False), (1, True), (3, True), (4, False)])
def test_only_the_joints_that_are_asked(joint: int, there: bool) -> None:
    assert any(felt(lambda _: 20.0, 0.3, JointPush(on=True, first=2, last=4), joint)) is there


@pytest.mark.parametrize(("first", "last"), [(4, 2), (7, 12), (12, 1)])
def test_where_no_joint_of_the_arm_is_asked_no_hand_is_felt(first: int, last: int) -> None:
    signal, use = JointPushSignal(6), JointPush(on=True, threshold=1.0, first=first, last=last)
    for tick in range(100):
        assert not signal.step([20.0 * (tick > 60)] * 6, use)
        assert not signal.touched


@pytest.mark.parametrize(("what", "share"), [("present", 1.0), ("touched", HALF)])
def test_a_change_of_just_its_threshold_is_none_yet(what: str, share: float) -> None:
    """A push goes beyond it, a hand beyond a third of it."""

    def pushed(threshold: float) -> JointPushSignal:
        """A push, of which the last tick alone is judged by this threshold."""
        signal = JointPushSignal(6)
        for tick in range(100):
            signal.step([0.0, -9.0 * (tick > 60), 0.0, 0.0, 0.0, 0.0], JointPush(threshold=100.0 if tick < 99 else threshold))
        return signal

    change = -pushed(100.0)._torques.change[1]
    assert getattr(pushed(change / share), what) is False
    assert getattr(pushed(0.999 * change / share), what) is True


def test_what_was_felt_is_over_when_it_is_learned_afresh() -> None:
    signal, use = JointPushSignal(6), JointPush(on=True)
    assert (signal.present, signal.touched) == (False, False), "before anything was felt"
    for tick in range(60):
        signal.step([20.0 * (tick > 52)] * 6, use)
    assert signal.present
    assert signal.touched
    signal.restart()
    assert (signal.present, signal.touched) == (False, False)


@pytest.mark.parametrize("frequency", [6.0, 7.5, 9.0, 10.5, 12.0])
@pytest.mark.parametrize("share", [1.2, 2.0, 3.0])
def test_a_trembling_hand_pushes_without_a_break(frequency: float, share: float) -> None:
    """A tenth of it, root mean square: present within 50 ms of passing the threshold for good, and for 2 s."""

    def torque(time: float) -> float:
        tremor = 0.1 * math.sqrt(2.0) * math.sin(2.0 * math.pi * frequency * time)
        return share * THRESHOLD * (1.0 + tremor) * min(time / 0.1, 1.0)

    present = felt(torque, 2.1)
    first = present.index(True)
    assert TICK * first < 0.15
    assert all(present[first:])


@pytest.mark.parametrize(("left", "ends"), [(0.0, True), (1.4, True), (4.0, True), (4.3, True), (4.9, False), (5.5, False)])
def test_what_stays_after_a_push_is_none_below_three_quarters_of_the_threshold(left: float, ends: bool) -> None:
    """FD-5e: friction keeps 1.4 N·m of a push at most; a change beyond three quarters of the threshold may be a hand."""
    present = felt(lambda time: 15.0 if time < 0.9 else left, 1.4)
    assert present[449]
    assert present[-1] is not ends


@pytest.mark.parametrize(("size", "over"), [(1.8, True), (1.9, True), (2.5, False), (4.0, False)])
@pytest.mark.parametrize("joint", range(6))
def test_a_change_of_less_than_two_newton_metres_soon_counts_as_untouched(joint: int, size: float, over: bool) -> None:
    """FD-5e: within 2 s in any joint; a larger one may be a hand that stays."""
    signal, use = JointPushSignal(6), JointPush(threshold=3.0)
    for tick in range(1060):
        signal.step([size * (tick > 60) if k == joint else 0.0 for k in range(6)], use)
        assert signal.touched or not 100 < tick < 120
    assert signal.touched is not over


def run_a_program(bench: Bench, **felt: float) -> None:
    """A program of one short move, in the course of which the arm begins to feel something that stays."""
    bench.run(0.002, Inputs(program=Program(steps=(JointMove(q=(0.03,) * 6),))))
    bench.run(0.002, Inputs(commands=(Command.START_PROGRAM,)))
    bench.run(0.3, qd=0.2)
    bench.run(0.2, qd=0.2, **felt)
    assert bench.last.law is Law.FOLLOW
    bench.run(0.002, status=MotionStatus(1), **felt)
    assert bench.kinds == [Kind.PROGRAM_LOADED, Kind.PROGRAM_STARTED, Kind.PROGRAM_FINISHED]
    bench.run(0.5, **felt)


@pytest.mark.parametrize(
    ("way", "back", "afresh"),
    [
        (0.0, 0.0, False),
        (0.045, 0.045, False),
        (0.049, 0.0, False),
        (-0.049, 0.0, False),
        (0.051, 0.0, True),
        (-0.051, 0.0, True),
        (0.3, 0.0, True),
        (0.3, 0.3, True),
        (0.051, 0.051, True),
    ],
)
def test_where_the_arm_has_been_elsewhere_the_joints_learn_their_untouched_state_afresh(
    way: float, back: float, afresh: bool
) -> None:
    """FD-5e: on the way the gears' errors may have been learned; what the joints feel then, in whatever posture, is nobody."""
    bench = Bench(signals__joints__on=True, free_drive__cool_down=0.0)
    bench.run(2.2, HOLD)
    assert bench.last.mode is Mode.FREE_DRIVE
    there, end = [0.0, way, 0.0, 0.0, 0.0, 0.0], [0.0, back, 0.0, 0.0, 0.0, 0.0]
    bench.run(0.3, HOLD, q=there)
    bench.run(0.3, LET_GO, q=end, tau_ext=9.0)
    bench.run(0.002, Inputs(commands=(Command.LEAVE_FREE_DRIVE,)), q=end, tau_ext=9.0)
    bench.run(0.5, q=end, tau_ext=9.0)
    bench.kinds.clear()
    bench.run(0.5, q=end)  # a change from what has been learned afresh; back to the untouched state otherwise
    assert (Kind.SIGNAL_SEEN in bench.kinds) is afresh


def test_after_a_program_the_joints_learn_their_untouched_state_afresh() -> None:
    """FD-5e: what a program has moved knows its gears better, and that is nobody's push; what comes afterwards is one."""
    bench = Bench(signals__joints__on=True)
    run_a_program(bench, tau_ext=9.0)
    assert bench.kinds[-1] is Kind.PROGRAM_FINISHED
    bench.run(0.5, tau_ext=18.0)
    assert bench.kinds[-1] is Kind.SIGNAL_SEEN
    assert bench.last.phase is Phase.ACTIVATION


def test_the_flange_keeps_its_untouched_state_where_the_posture_is_the_old_one() -> None:
    """FD-5c: a motion teaches nothing of the flange's sensor; a hand that pushes when it ends is felt."""
    bench = Bench(signals__push__on=True)
    run_a_program(bench, force=20.0)
    assert bench.kinds[-1] is Kind.SIGNAL_SEEN
