"""Sources that are switched off and on again: what they felt is over (FD-5, FD-8a)."""

from typing import Any

import pytest

from pendant.signals.settings import LetGo
from pendant.signals.sources import NONE
from tests.pendant.signals.test_sources import COURSES, Bench, Course


@pytest.mark.parametrize("meanwhile", [[], ["joints.on"], ["tap.on"]])
@pytest.mark.parametrize("switch", COURSES)
def test_a_source_that_is_switched_on_again_learns_afresh(switch: str, meanwhile: list[str]) -> None:
    """FD-5: what stays as it was while nobody looked is no signal."""
    bench, others, felt = Bench(), [other for other in meanwhile if other != switch], COURSES[switch][0][0][1]
    bench.run(300, switch)
    bench.run(60, switch, **felt)
    bench.run(5, *others, **felt)
    assert COURSES[switch][1] not in [given for given, _ in bench.run(300, switch, *others, **felt)]


PUSHED: dict[str, Any] = {"force": 25.0}
HALVES: dict[str, tuple[Course, Course]] = {
    "pattern.on": ([(60, PUSHED), (40, {})], [(60, PUSHED), (60, {})]),
    "tap.on": ([(10, {"acceleration": 8.0})], [(60, {})]),
}
"""The beginning of a signal, and what completes it."""


@pytest.mark.parametrize("switched", [True, False])
@pytest.mark.parametrize("switch", HALVES)
def test_a_signal_is_not_completed_where_it_was_switched_off_within(switch: str, switched: bool) -> None:
    """FD-5f, FD-5i; meanwhile a source is on that looks at the same sensor."""
    first, second = HALVES[switch]
    bench = Bench()
    bench.run(300, switch, "push.on")
    for count, felt in first:
        bench.run(count, switch, "push.on", **felt)
    bench.run(5, "push.on", *[switch] * (not switched))
    given = [given for count, felt in second for given, _ in bench.run(count, "push.on", switch, **felt)]
    assert (COURSES[switch][1] in given) is not switched


def test_a_force_that_was_there_when_it_was_switched_on_is_no_step() -> None:
    """FD-5h."""
    bench = Bench()
    bench.run(300, "push.on")
    bench.run(20, "push.on", **PUSHED)
    bench.run(60, "twist.on", **PUSHED)
    assert {given for given, _ in bench.run(60, "twist.on", "force_step.on", **PUSHED)} == {NONE}


def test_in_which_posture_the_arm_was_held_is_not_known_while_no_source_is_on() -> None:
    bench, there = Bench(), [0.3] * 6
    bench.run(100, "push.on")
    bench.run(0)
    bench.run(100, "push.on", q=there, force=12.0)
    bench.run(5, "push.on", holding=False)
    assert {given for given, _ in bench.run(100, "push.on", force=40.0)} == {NONE}


@pytest.mark.parametrize("stays", [True, False])
@pytest.mark.parametrize(
    ("switch", "other", "felt"),
    [
        ("push.on", "force_step.on", {"force": 13.0}),
        ("twist.on", "force_step.on", {"torque": 2.6}),
        ("force_step.on", "twist.on", {"force": 8.5}),
    ],
)
def test_a_push_that_was_switched_off_has_to_come_again(switch: str, other: str, felt: dict[str, Any], stays: bool) -> None:
    """FD-5: what would be enough to stay is not enough to come; to other sources nothing happens."""
    bench = Bench()
    bench.run(300, switch, other)
    assert bench.run(40, switch, other, **COURSES[switch][0][0][1])[-1][0] == COURSES[switch][1]
    bench.run(60, switch if stays else other, **felt)
    given = [given for given, _ in bench.run(60, switch, other, **felt)]
    assert (given.count(COURSES[switch][1]) > 0) is stays


def test_another_joint_that_is_asked_begins_where_it_is() -> None:
    """FD-5g."""
    bench, posture = Bench(), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    bench.run(100, "turn.on", q=posture)
    bench.turning = 5
    assert {given for given, _ in bench.run(100, "turn.on", q=posture)} == {NONE}
    posture[4] = 0.52
    assert bench.run(1, "turn.on", q=posture)[-1][0] == COURSES["turn.on"][1]


@pytest.mark.parametrize(("held", "seen"), [(247, False), (248, False), (249, True), (250, True)])
def test_for_how_long_the_arm_was_held_is_not_known_while_no_source_is_on(held: int, seen: bool) -> None:
    """FD-5h."""
    bench = Bench()
    bench.run(1000, "force_step.on")
    bench.run(0)
    bench.run(held, "force_step.on")
    assert (bench.run(1, "force_step.on", force=200.0)[0][0] is not NONE) is seen


@pytest.mark.parametrize("switch", ["turn.on", "tap.on", "joints.on"])
def test_it_is_known_while_any_is(switch: str) -> None:
    """Also where another setting is changed."""
    bench = Bench()
    bench.run(250, switch)
    bench.switched = None
    bench.run(100, switch)
    bench.run(100, "force_step.on")
    assert bench.run(1, "force_step.on", force=200.0)[0][0] is not NONE


@pytest.mark.parametrize("elsewhere", [0.02, -0.3])
def test_a_joint_that_a_program_turned_while_nobody_looked_is_not_turned_by_hand(elsewhere: float) -> None:
    """FD-5g."""
    bench, there = Bench(), [0.0] * 5 + [elsewhere]
    bench.run(10, "turn.on")
    bench.run(100, holding=False, q=there)
    bench.run(100, q=there)
    assert {given for given, _ in bench.run(100, "turn.on", q=there)} == {NONE}


@pytest.mark.parametrize("switch", ["push.on", "twist.on", "joints.on", "turn.on", "force_step.on", "pattern.on"])
def test_a_hand_is_off_where_no_source_feels_it_any_more(switch: str) -> None:
    """FD-8a: it stayed on for ever where its source was switched off under it."""
    bench = Bench()
    bench.run(300, switch)
    bench.run(60, switch, **COURSES[switch][0][0][1])
    assert not any(bench.off(60, LetGo(time=0.1)))
    bench.run(1, "tap.on", **COURSES[switch][0][0][1])
    assert bench.off(60, LetGo(time=0.1))[-1]
