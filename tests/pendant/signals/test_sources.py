"""The sources side by side, whatever is switched meanwhile (FD-5, FD-6a); test_signals.py has each of them."""

import math
from typing import Any

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.signals.settings import LetGo
from pendant.signals.sources import ANOTHER_POSTURE, LEVER, NONE, TOLD_AFTER, Presence, Sources
from tests.pendant.estimates import estimate


class Bench:
    """Sources of an arm that is held, one tick at a time."""

    def __init__(self) -> None:
        self.sources = Sources(6)
        self.switched: tuple[str, ...] | None = None
        self.turning = 6  # the joint that is asked whether it is turned

    def run(
        self, count: int, *switches: str, wrench: bool = True, joints: bool = True, holding: bool = True, **felt: Any
    ) -> list[tuple[Presence, bool]]:
        """With these switches of `signals` on: the signal, and whether a push is told, of each tick."""
        use = apply(
            Settings(), {"signals.turn.joint": self.turning, **{f"signals.{switch}": True for switch in switches}}
        ).signals
        if switches != self.switched:
            self.switched = switches
            self.sources.refresh(use)
        value, seen = estimate(wrench_valid=wrench, **felt), []
        for _ in range(count):
            there = self.sources.step(value, use, wrench_ok=wrench, joints_ok=joints, holding=holding, running=False)
            seen.append((there, self.sources.pushed() is not None))
        return seen

    def off(self, count: int, use: LetGo, wrench: bool = True) -> list[bool]:
        """Whether the hand is off, asked in so many ticks."""
        return [self.sources.hand_off(use, wrench) for _ in range(count)]


Course = list[tuple[int, dict[str, Any]]]
"""Ticks, and what the arm feels in them."""

TURNED: dict[str, Any] = {"q": [0.0, 0.0, 0.0, 0.0, 0.0, 0.01]}
COURSES: dict[str, tuple[Course, Presence]] = {
    "push.on": ([(60, {"force": 20.0})], Presence("push", by_hand=True)),
    "twist.on": ([(60, {"torque": 4.0})], Presence("twist", by_hand=True)),
    "joints.on": ([(60, {"tau_ext": 9.0})], Presence("push felt by joints", by_hand=True)),
    "pattern.on": ([(60, {"force": 25.0}), (60, {})] * 2, Presence("pushes in a row", by_hand=True, whole=True)),
    "turn.on": ([(60, TURNED)], Presence("turned joint", by_hand=True)),
    "posture.on": (
        [(60, TURNED), (60, {"q": [0.0] * 4 + [0.01, 0.0]})],
        Presence("series of postures", by_hand=True, whole=True),
    ),
    "force_step.on": ([(60, {"force": 20.0})], Presence("force step", by_hand=True)),
    "tap.on": ([(10, {"acceleration": 8.0}), (60, {})], Presence("tap", by_hand=True, whole=True)),
}
"""By switch: what the source is made of, and the signal that it gives."""


@pytest.mark.parametrize("holding", [True, False])
@pytest.mark.parametrize("on", [True, False])
@pytest.mark.parametrize("switch", COURSES)
def test_a_source_gives_its_signal_where_it_is_on_and_the_arm_is_held(switch: str, on: bool, holding: bool) -> None:
    """FD-5: and what is given completely is given once."""
    course, signal = COURSES[switch]
    bench, switches = Bench(), [switch] * on
    bench.run(300, *switches)
    given = [given for count, felt in course for given, _ in bench.run(count, *switches, holding=holding, **felt)]
    if on and holding:
        assert set(given) == {NONE, signal} if switch != "turn.on" else {signal}
        assert given.count(signal) == 1 or not signal.whole
    else:
        assert set(given) == {NONE}


ORDER = ["push.on", "force_step.on", "joints.on", "turn.on"]


@pytest.mark.parametrize("first", range(len(ORDER)))
def test_of_several_sources_the_first_gives_the_signal(first: int) -> None:
    bench = Bench()
    bench.run(300, *ORDER[first:])
    given = bench.run(60, *ORDER[first:], force=20.0, tau_ext=9.0, **TURNED)
    assert given[-1][0] == COURSES[ORDER[first]][1]


@pytest.mark.parametrize("joint", range(1, 7))
@pytest.mark.parametrize("asked", range(1, 7))
def test_only_the_joint_that_is_asked_counts_as_turned(asked: int, joint: int) -> None:
    """FD-5g."""
    bench = Bench()
    bench.turning = asked
    bench.run(10, "turn.on")
    given = bench.run(1, "turn.on", q=[0.01 if k == joint else 0.0 for k in range(1, 7)])
    assert (given[0][0] is not NONE) is (asked == joint)


@pytest.mark.parametrize("asked", [7, 12])
def test_a_joint_that_the_arm_has_not_is_never_turned(asked: int) -> None:
    """FD-5g."""
    bench = Bench()
    bench.turning = asked
    bench.run(10, "turn.on")
    assert bench.run(1, "turn.on", q=[0.01] * 6) == [(NONE, False)]


def test_a_joint_is_turned_from_where_it_was_first_known_to_be_held() -> None:
    """FD-5g, FD-12: its sensor may be valid later than the arm is held."""
    bench = Bench()
    assert bench.run(10, "turn.on", joints=False, q=[math.nan] * 6)[-1][0] is NONE
    assert bench.run(10, "turn.on")[-1][0] is NONE
    assert bench.run(10, "turn.on", joints=False, **TURNED)[-1][0] is NONE
    assert bench.run(1, "turn.on", **TURNED)[0][0] == COURSES["turn.on"][1]


@pytest.mark.parametrize(("way", "felt"), [(0.0, True), (0.049, True), (ANOTHER_POSTURE, True), (0.051, False), (-0.051, False)])
@pytest.mark.parametrize(("switch", "hand"), [("push.on", {"force": 20.0}), ("joints.on", {"tau_ext": 9.0})])
def test_the_untouched_state_is_that_of_the_posture(switch: str, hand: dict[str, Any], way: float, felt: bool) -> None:
    """What the arm feels when it is held again is a hand's unless it has moved by more than `ANOTHER_POSTURE`."""
    bench, there = Bench(), [0.0, 0.0, way, 0.0, 0.0, 0.0]
    bench.run(100, switch)
    bench.run(10, switch, holding=False, q=there)
    given = bench.run(60, switch, q=there, **hand)
    assert (given[-1][0] is not NONE) is felt


FELT = [-2.0, 3.0, 6.0]  # 7 N or N·m


def test_the_force_is_the_size_of_its_change() -> None:
    bench = Bench()
    bench.run(100, "push.on", force=[5.0, 0.0, -5.0])
    bench.run(60, "push.on", force=np.add(FELT, [5.0, 0.0, -5.0]).tolist())
    assert bench.sources.force() == pytest.approx(7.0, rel=0.01)


@pytest.mark.parametrize("count", [0, 1, 50])
def test_the_hand_is_off_when_none_is_felt_for_its_time_to_the_tick(count: int) -> None:
    """FD-8a."""
    bench = Bench()
    bench.run(100, "push.on")
    bench.run(60, "push.on", force=20.0)
    assert not any(bench.off(100, LetGo(time=0.002 * count)))
    assert bench.sources.touched
    bench.run(60, "push.on")
    assert bench.off(count + 2, LetGo(time=0.002 * count)) == [False] * count + [True] * 2
    assert not bench.sources.touched


@pytest.mark.parametrize(("kind", "lever"), [("force", 1.0), ("torque", LEVER)])
def test_a_hand_is_on_from_its_force_on(kind: str, lever: float) -> None:
    """FD-8a: below it, it is off; a torque is as good a sign as the force on its lever."""
    bench = Bench()
    bench.run(100, "push.on")
    felt: dict[str, Any] = {kind: FELT}
    bench.run(60, "push.on", **felt)
    for share, off in ((0.98, False), (1.02, True)):
        assert bench.off(1, LetGo(force=share * 7.0 * lever, time=0.0)) == [off]


def test_a_hand_with_just_the_force_is_on() -> None:
    """FD-8a."""
    bench = Bench()
    bench.run(100, "push.on")
    bench.run(60, "push.on", force=FELT)
    force = bench.sources.force()
    assert bench.off(1, LetGo(force=force, time=0.0)) == [False]
    assert bench.off(1, LetGo(force=math.nextafter(force, math.inf), time=0.0)) == [True]


@pytest.mark.parametrize("wrench", [True, False])
@pytest.mark.parametrize("switch", ["joints.on", "turn.on"])
def test_a_hand_that_the_flange_does_not_feel_is_on_all_the_same(switch: str, wrench: bool) -> None:
    """FD-8a."""
    bench = Bench()
    bench.run(100, switch, wrench=wrench)
    bench.run(60, switch, wrench=wrench, **COURSES[switch][0][0][1])
    assert not any(bench.off(60, LetGo(), wrench))
    bench.run(60, switch, wrench=wrench)
    assert bench.off(60, LetGo(), wrench)[-1]


@pytest.mark.parametrize("count", [0, 1, 50])
def test_a_hand_that_was_never_on_is_off_as_late(count: int) -> None:
    """FD-8a: until it was asked for, it may have been on."""
    bench = Bench()
    assert bench.sources.touched
    assert bench.off(count + 2, LetGo(time=0.002 * count)) == [False] * count + [True] * 2


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("size", "followed"), [(2.5, True), (2.9, True), (3.5, False), (6.0, False)])
def test_a_force_of_less_than_three_newtons_soon_counts_as_untouched(axis: int, size: float, followed: bool) -> None:
    """FD-5c: a sensor drifts so far; a larger force may be a hand that stays."""
    bench = Bench()
    bench.run(60, "push.on")
    bench.run(600, "push.on", force=[-size if k == axis else 0.0 for k in range(3)])
    assert (bench.sources.force() < 0.5 * size) is followed


@pytest.mark.parametrize(("held", "seen"), [(247, False), (248, False), (249, True), (250, True)])
def test_a_force_step_needs_half_a_second_of_rest_from_the_first_tick_on(held: int, seen: bool) -> None:
    """FD-5h: with its own tick."""
    bench = Bench()
    bench.run(held, "force_step.on")
    assert (bench.run(1, "force_step.on", force=200.0)[0][0] is not NONE) is seen


def test_before_the_arm_was_ever_held_no_joint_is_turned() -> None:
    """FD-5g."""
    assert Bench().run(10, "turn.on", holding=False, **TURNED) == [(NONE, False)] * 10


def test_a_push_is_told_so_many_ticks_after_it_began() -> None:
    """FD-6a."""
    bench = Bench()
    bench.run(100, "push.on", "push.reported")
    seen = bench.run(2 * TOLD_AFTER, "push.on", "push.reported", force=20.0)
    began = [signal.source for signal, _ in seen].index("push")
    assert [told for _, told in seen].index(True) == began + TOLD_AFTER - 1


@pytest.mark.parametrize(("meanwhile", "wrench"), [("joints.on", True), ("twist.on", True), ("push.reported", False)])
def test_a_push_is_told_once_though_it_is_asked_for_no_more_or_the_sensor_is_lost(meanwhile: str, wrench: bool) -> None:
    """FD-6a."""
    bench = Bench()
    bench.run(100, "push.reported")
    assert any(bench.run(1, "push.reported", force=20.0)[0][1] for _ in range(2 * TOLD_AFTER))
    assert not any(told for _, told in bench.run(60, meanwhile, wrench=wrench, force=20.0))


def test_a_push_counts_from_the_tick_in_which_it_is_asked_for() -> None:
    """FD-6a."""
    bench = Bench()
    bench.run(100, "push.on")
    bench.run(200, "push.on", force=20.0)
    told = [told for _, told in bench.run(2 * TOLD_AFTER, "push.reported", force=20.0)]
    assert told == [tick == TOLD_AFTER for tick in range(1, 2 * TOLD_AFTER + 1)]


@pytest.mark.parametrize(
    ("name", "other", "felt"),
    [("push", "twist", {"force": 13.0}), ("twist", "push", {"torque": 2.6}), ("force_step", "push", {"force": 8.5})],
)
def test_what_was_over_with_the_sensor_is_not_back_when_it_is_asked_for_again(
    name: str, other: str, felt: dict[str, Any]
) -> None:
    """FD-5, FD-12: what would be enough to stay is not enough to come."""
    bench = Bench()
    bench.run(100, f"{other}.on")
    bench.run(2, f"{other}.on", wrench=False)
    bench.run(100, f"{other}.on")
    bench.run(100, f"{other}.on", **felt)
    assert not any(signal.source for signal, _ in bench.run(100, f"{name}.on", **felt))
