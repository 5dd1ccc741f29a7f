"""Signals by hand, to the tick and to the limit: patterns, steps, taps, turned joints, twists, places of pushes (FD-5, FD-6)."""

import itertools

import numpy as np
import pytest

from pendant.signals.gestures import PatternSignal, PostureSignal, StepSignal, TapSignal, TurnSignal
from pendant.signals.push_signal import PushSignal, TwistSignal
from pendant.signals.settings import ForceStep, PostureSignalUse, PushPattern, PushSettings, TapSettings, Turn, Twist
from pendant.tick.pose import UNTURNED, flat

SHORT, LONG = 40, 140
"""Ticks of the shortest and the longest push, and gap: 0.08 s, 0.28 s."""


def whole_at(*lengths: int) -> list[int]:
    """Ticks, of pushes and gaps of these lengths in turns, in which the pattern is whole. The last one ends in a gap."""
    signal = PatternSignal()
    pushes = itertools.cycle([True, False])
    course = [push for length, push in zip((*lengths, 1), pushes, strict=False) for _ in range(length)]
    return [tick for tick, push in enumerate(course) if signal.step(push, PushPattern())]


@pytest.mark.parametrize("which", [0, 1, 2])
@pytest.mark.parametrize(("length", "good"), [(SHORT - 1, False), (SHORT, True), (LONG, True), (LONG + 1, False), (300, False)])
def test_each_push_and_each_gap_is_within_its_limits(which: int, length: int, good: bool) -> None:
    """FD-5f."""
    lengths = [80, 80, 80]
    lengths[which] = length
    assert whole_at(*lengths) == ([sum(lengths)] if good else [])


@pytest.mark.parametrize("idle", [1, SHORT - 1, SHORT, 80, LONG, LONG + 1, 300])
def test_however_long_nobody_pushed_before_the_first_push_is_the_first(idle: int) -> None:
    """FD-5f."""
    signal = PatternSignal()
    course = [False] * idle + [True] * 80 + [False] * 80 + [True] * 80 + [False]
    assert [tick for tick, push in enumerate(course) if signal.step(push, PushPattern())] == [idle + 240]


def test_a_pattern_that_is_whole_begins_afresh_and_so_does_one_that_is_broken() -> None:
    """FD-5f: two and two more; one that was too short is none of the two."""
    assert whole_at(50, 50, 50, 50, 50, 50, 50) == [150, 350]
    assert whole_at(50, 50, 50, 50, 50) == [150]
    assert whole_at(10, 50, 50, 50, 50) == [210]
    assert whole_at(50, 50, 10, 50, 50) == []


def stepped(forces: list[float], quiet: int = 250) -> list[bool]:
    signal = StepSignal()
    return [signal.step(force, quiet, ForceStep()) for force in forces]


@pytest.mark.parametrize(("rise", "seen"), [(1, True), (50, True), (51, False)])
@pytest.mark.parametrize("low", [3.0, 9.0])
@pytest.mark.parametrize("before", [1, 5])
def test_a_force_step_rises_in_time(rise: int, seen: bool, low: float, before: int) -> None:
    """FD-5h: from 3 N, which is no quiet any more, to beyond 10 N in 0.1 s."""
    assert stepped([0.0] * before + [low] * (rise - 1) + [10.1])[-1] is seen
    assert stepped([2.9] * 100 + [10.1])[-1]


@pytest.mark.parametrize("count", [1, 2, 60])
def test_a_force_that_is_there_from_the_first_tick_has_not_risen(count: int) -> None:
    """FD-5h."""
    signal = StepSignal()
    assert not any(signal.step(10.1, 250, ForceStep()) for _ in range(count))
    assert signal.step(2.9, 250, ForceStep()) is False
    assert signal.step(10.1, 250, ForceStep())


@pytest.mark.parametrize(("force", "quiet", "seen"), [(10.1, 250, True), (10.0, 250, False), (10.1, 249, False)])
def test_a_force_step_is_beyond_its_threshold_after_rest(force: float, quiet: int, seen: bool) -> None:
    """FD-5h: the arm was at rest for 0.5 s before."""
    assert stepped([0.0, force], quiet) == [False, seen]


def test_a_force_step_stays_down_to_three_quarters() -> None:
    assert stepped([0.0, 20.0, 7.6, 7.5, 7.6], 250) == [False, True, True, False, False]
    assert stepped([9.9], 250) == [False], "enough to stay is not enough to come"


def tapped(*lengths: int) -> list[int]:
    """Ticks in which a tap is whole, of accelerations beyond the threshold and none in turns; then none for long."""
    signal = TapSignal()
    hits = itertools.cycle([True, False])
    course = [hit for length, hit in zip(lengths, hits, strict=False) for _ in range(length)] + [False] * 300
    return [tick for tick, hit in enumerate(course) if signal.step(6.1 if hit else 6.0, TapSettings())]


@pytest.mark.parametrize(
    ("lengths", "whole"),
    [
        ((1,), True),
        ((50,), True),  # 0.1 s
        ((51,), False),
        ((200,), False),
        ((1, 20, 1), True),  # it rings: 22 ticks in all
        ((3, 30, 17), True),
        ((3, 30, 18), False),
        ((1, 24, 1, 23, 1), True),
        ((1, 24, 1, 24, 1), False),
    ],
)
def test_a_tap_is_short_from_its_first_to_its_last_and_told_once_when_it_has_been_gone_as_long(
    lengths: tuple[int, ...], whole: bool
) -> None:
    """FD-5i."""
    assert tapped(*lengths) == ([sum(lengths) + 49] if whole else [])


def test_two_taps_are_two() -> None:
    assert tapped(2, 60, 3) == [51, 114]


def test_a_joint_is_turned_from_where_it_is_held() -> None:
    """FD-5g."""
    signal = TurnSignal()
    course = [(0.3, False), (0.3, True), (0.3049, True), (0.3051, True), (0.2949, True), (0.5, False), (0.5, True)]
    assert [signal.step(angle, holding, Turn()) for angle, holding in course] == [False, False, False, True, True, False, False]
    signal = TurnSignal()
    signal.step(0.0, True, Turn())
    assert not signal.step(0.005, True, Turn())


AXES = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, -0.6, 0.8)]


@pytest.mark.parametrize("way", AXES)
@pytest.mark.parametrize(
    ("force", "torques", "present"),
    [
        (0.0, [3.0], False),
        (0.0, [3.01], True),
        (9.9, [3.01], True),
        (10.0, [3.01], False),
        (0.0, [2.5], False),
        (0.0, [3.01, 2.5], True),
        (0.0, [3.01, 2.25], False),
        (0.0, [3.01, 0.0, 2.5], False),
    ],
)
def test_a_twist_is_torque_with_little_force(
    way: tuple[float, float, float], force: float, torques: list[float], present: bool
) -> None:
    """FD-5d: beyond 3 N·m, less than 10 N; once there it stays above three quarters."""
    signal = TwistSignal()
    x, y, z = way
    seen = [signal.step((force * x, force * y, force * z, torque * x, torque * y, torque * z), Twist()) for torque in torques]
    assert seen[-1] is present


def test_a_push_passes_its_place_within_the_radius() -> None:
    """FD-6: a force along a line that passes the place at a distance; its torque about the flange is its arm times itself."""
    rng = np.random.default_rng(5)
    for _ in range(40):
        R_BF = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        place, f = rng.uniform(-0.3, 0.3, 3), rng.normal(size=3)
        f *= 30.0 / np.linalg.norm(f)
        off = np.cross(f, rng.normal(size=3))
        off /= np.linalg.norm(off)
        x, y, z = place.tolist()
        use = PushSettings(radius=0.05, place_x=x, place_y=y, place_z=z, torque_limit=20.0)
        for distance, passes in ((0.0, True), (0.049, True), (0.051, False)):
            point = R_BF @ place + distance * off + rng.normal() * 0.01 * f
            change = [*f.tolist(), *np.cross(point, f).tolist()]
            assert PushSignal().step(change, flat(R_BF), use) is passes
    assert PushSignal().step((20.0, 0.0, 0.0, 0.0, 0.0, 1.0), UNTURNED, PushSettings(radius=0.05)), "the radius itself is within"


def test_before_the_first_tick_no_signal_is_present() -> None:
    assert (StepSignal().present, TurnSignal().present) == (False, False)


REST, FIRST, SECOND, BOTH = (0.0, 0.0), (0.02, 0.0), (0.0, -0.02), (0.02, -0.02)
"""Angles of two joints: neither turned, the first to its side, the second to its, both."""

SERIES = PostureSignalUse(count=2, joint_1=1, angle_1=0.01, joint_2=2, angle_2=-0.01, within=0.2)
POSTURE = PostureSignalUse(together=True, count=2, joint_1=1, angle_1=0.01, joint_2=2, angle_2=-0.01)


def postured(use: PostureSignalUse, *course: tuple[int, tuple[float, ...]], holding: bool = True) -> list[int]:
    """Ticks in which the signal is there; the arm is held in angles of 0 before."""
    signal = PostureSignal()
    angles = [angle for count, angle in ((1, REST), *course) for _ in range(count)]
    return [tick for tick, each in enumerate(angles) if signal.step(each, holding, use)]


@pytest.mark.parametrize(
    ("course", "at"),
    [
        ([(10, FIRST), (10, SECOND)], [11]),
        ([(10, FIRST), (10, BOTH)], [11]),  # the first need not be back
        ([(10, FIRST), (90, REST), (10, SECOND)], [101]),  # 0.2 s are 100 ticks
        ([(10, FIRST), (91, REST), (10, SECOND)], []),
        ([(10, SECOND), (10, FIRST)], []),  # in their order
        ([(10, SECOND), (10, BOTH), (10, SECOND)], []),
        ([(10, BOTH)], []),  # not at once
        ([(10, (0.01, 0.0)), (10, SECOND)], []),  # beyond the angle
        ([(10, (-0.02, 0.0)), (10, SECOND)], []),  # to its side
        ([(10, FIRST), (10, (0.0, 0.02))], []),
        ([(10, FIRST), (10, SECOND), (10, FIRST), (10, SECOND)], [11]),  # it must be back before another one
        ([(10, FIRST), (10, SECOND), (1, REST), (10, FIRST), (10, SECOND)], [11, 32]),
        ([(10, FIRST), (10, SECOND), (1, (0.005, 0.0)), (10, FIRST), (10, SECOND)], [11]),
        ([(10, SECOND), (1, REST), (10, FIRST), (10, SECOND)], [22]),
    ],
)
def test_a_series_of_postures_is_in_its_order_and_in_time(course: list[tuple[int, tuple[float, ...]]], at: list[int]) -> None:
    """FD-5g: whole in the tick in which the last joint is turned."""
    assert postured(SERIES, *course) == at
    assert postured(SERIES, *course, holding=False) == []


def test_a_posture_is_there_while_every_joint_is_turned() -> None:
    """FD-5g."""
    assert postured(POSTURE, (3, FIRST), (2, BOTH), (3, SECOND), (1, BOTH)) == [4, 5, 9]
    assert postured(POSTURE, (3, (0.02, -0.01)), (3, (0.01, -0.02))) == []


def test_a_series_has_as_many_joints_as_it_counts() -> None:
    """FD-5g: three, and one joint may come twice; one of 0 rad is never turned."""
    to_and_fro = PostureSignalUse(count=3, joint_1=1, angle_1=0.01, joint_2=1, angle_2=-0.01, joint_3=2, angle_3=-0.01)
    assert postured(to_and_fro, (5, FIRST), (5, (-0.02, 0.0)), (5, SECOND)) == [11]
    assert postured(PostureSignalUse(count=1, joint_1=1, angle_1=0.01), (5, FIRST)) == [1]
    assert postured(PostureSignalUse(count=1, joint_1=1, angle_1=0.0), (5, FIRST), (5, BOTH)) == []


@pytest.mark.parametrize("count", [1, 2])
def test_an_arm_without_the_joint_gives_no_series(count: int) -> None:
    """FD-5g."""
    use = PostureSignalUse(count=count, joint_1=1, angle_1=0.01, joint_2=3, angle_2=0.01)
    assert postured(use, (5, FIRST), (5, SECOND)) == ([1] if count == 1 else [])


def test_a_hand_is_felt_in_a_joint_that_is_turned_and_what_was_held_is_where_the_hold_began() -> None:
    """FD-8a."""
    signal = PostureSignal()
    seen: list[bool] = []
    for angles, holding in ((REST, True), (FIRST, True), (REST, True), (FIRST, False), (FIRST, True), (REST, True)):
        signal.step(angles, holding, SERIES)
        seen.append(signal.touched)
    assert seen == [False, True, False, False, False, False]
