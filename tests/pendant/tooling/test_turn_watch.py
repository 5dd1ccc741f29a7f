"""What a turning arm may have met."""

import math

import pytest

from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK_RATE
from pendant.tooling.turn_watch import JOLTED, PUSHED, SLOW_ELBOW, SLOW_JOINT, SLOW_TOOL, STRUCK, TurnWatch
from tests.pendant.estimates import estimate

WEIGHT = (0.0, 0.0, -20.0)


def watching() -> TurnWatch:
    watch = TurnWatch()
    watch.begin(estimate(), WEIGHT)
    return watch


def felt(watch: TurnWatch, x: float, value: Estimate | None = None) -> str:
    """A force along x in addition to the weight [N]."""
    return watch.step(value or estimate(), (x, WEIGHT[1], WEIGHT[2]))


@pytest.mark.parametrize(
    ("force", "ends"), [(0.9 * STRUCK, False), (1.1 * STRUCK, True), (-1.1 * STRUCK, True), (math.nan, True)]
)
def test_a_force_that_comes_at_once(force: float, ends: bool) -> None:
    watch = watching()
    assert felt(watch, 0.0) == ""
    said = [felt(watch, force) for _ in range(50)]
    assert (said[0] != "") is ends
    assert any(said) is ends


@pytest.mark.parametrize(("rate", "ends"), [(4.0, False), (30.0, True)])
def test_one_that_comes_slowly_is_followed(rate: float, ends: bool) -> None:
    """Up to 20 N, which a turned zero of the sensor may make."""
    watch = watching()
    steps = round(20.0 / rate * TICK_RATE)
    said = [felt(watch, 20.0 * k / steps) for k in range(steps)]
    assert any(said) is ends


def test_but_no_farther_than_it_may_change_at_all() -> None:
    watch = watching()
    last = next(x / 1000.0 for x in range(0, 40_000, 4) if felt(watch, x / 1000.0))
    assert last == pytest.approx(PUSHED, abs=0.01)
    assert f"at most {PUSHED:g} N" in felt(watch, last)


@pytest.mark.parametrize(
    ("joint", "torque", "ends"),
    [(3, 0.9 * JOLTED, False), (3, -1.1 * JOLTED, True), (5, 1.1 * JOLTED, True), (4, math.nan, True), (2, 5.0 * JOLTED, False)],
)
def test_a_torque_of_a_joint_of_the_wrist_that_comes_at_once(joint: int, torque: float, ends: bool) -> None:
    watch = watching()
    torques = [0.0] * 6
    torques[joint] = torque
    said = [felt(watch, 0.0, estimate(tau_ext=torques)) for _ in range(20)]
    assert any(said) is ends


def test_a_torque_that_was_there_before_is_no_jolt_nor_one_that_comes_slowly() -> None:
    """A joint that bears a load from the beginning, which grows by 10 N·m a second: it is 5 N·m behind."""
    watch = TurnWatch()
    watch.begin(estimate(tau_ext=[30.0] * 6), WEIGHT)
    said = [felt(watch, 0.0, estimate(tau_ext=[30.0 + 10.0 * k / TICK_RATE] * 6)) for k in range(3 * TICK_RATE)]
    assert not any(said)


@pytest.mark.parametrize(
    ("tool", "elbow", "joint", "ends"),
    [
        (SLOW_TOOL, SLOW_ELBOW, SLOW_JOINT, False),
        (1.01 * SLOW_TOOL, 0.0, 0.0, True),
        (0.0, 1.01 * SLOW_ELBOW, 0.0, True),
        (0.0, 0.0, -1.01 * SLOW_JOINT, True),
        (math.nan, 0.0, 0.0, True),
    ],
)
def test_it_is_never_fast(tool: float, elbow: float, joint: float, ends: bool) -> None:
    said = felt(watching(), 0.0, estimate(v_tcp=tool, v_elbow=elbow, qd=[0.0] * 5 + [joint]))
    assert said == ("faster than the wizard may move the arm" if ends else "")


def test_it_begins_anew_with_the_force_that_is_felt_then() -> None:
    watch = watching()
    watch.begin(estimate(), (30.0, 0.0, 0.0))
    assert watch.step(estimate(), (30.0, 0.0, 0.0)) == ""
